// The colours, which the style sheet knows for light and dark.

export const DASHES = [[8, 5], [], [2, 5]];
export const E_NAMES = ["e\u2081", "e\u2082", "e\u2083"];
export const colors = {};

export function readColors() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ground", "ink", "quiet", "rule", "shade", "grey", "e1", "e2", "e3", "omega", "momentum", "inside", "disc", "rim", "gravity", "contact"]) {
    colors[name] = style.getPropertyValue(`--${name}`).trim();
  }
  colors.axes = [colors.e1, colors.e2, colors.e3];
}

/** A word in the colour of what it names. */
export const key = (name, word) => `<span class="key" style="color:var(--${name})">${word}</span>`;
