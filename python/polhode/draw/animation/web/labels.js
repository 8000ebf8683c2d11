// Places for names, so that none is written over another, and where there is room none over another's arrow.

const HEIGHT = 18;
const GAP = 4; // between names on one line
const FAR = [14, 26, 40]; // pixels from its point
const AROUND = [0, 45, -45, 90, -90, 135, -135, 180].map((degrees) => degrees * Math.PI / 180);

const overlap = (a, b) => Math.abs(a.at[0] - b.at[0]) < (a.width + b.width) / 2 + GAP && Math.abs(a.at[1] - b.at[1]) < HEIGHT;
const NEAR_TIP = 60; // of an arrow, pixels that names keep off

/** Whether a name stands on the end of another's arrow. */
function covers(at, width, { x, y, ux, uy, size }) {
  const back = Math.min(Math.min(size, NEAR_TIP), Math.max(0, (x - at[0]) * ux + (y - at[1]) * uy));
  return Math.abs(at[0] - x + back * ux) < width / 2 + 2 && Math.abs(at[1] - y + back * uy) < HEIGHT / 2;
}

/** A text of at most a width: its beginning and its end, which tells names of one kind apart. */
export function shortened(text, width, widthOf) {
  const letters = [...text];
  for (let left = letters.length; left > 2; left--) {
    const end = Math.floor(left / 3), kept = left === letters.length ? text : `${letters.slice(0, left - end).join("").trimEnd()}\u2026${letters.slice(letters.length - end).join("").trimStart()}`;
    if (widthOf(kept) <= width) return kept;
  }
  return letters.slice(0, 2).join("");
}

/** For names at (x, y), pointing outward along (ux, uy): each beyond its point, or where there is room nearby, in the longest of its texts that does not meet another; left out where none fits. */
export function placed(names, width, height) {
  const done = [];
  for (const one of names) {
    const others = names.filter((other) => other !== one), found = one.choices.map((text) => spot({ ...one, ...text }, done, others, width, height)).find((at) => at);
    if (found) done.push(found);
  }
  return done;
}

/** The best place for a name: on no other name, and on as few arrows of others as can be; null where there is none. */
function spot(one, done, others, width, height) {
  let best = null, least = Infinity;
  for (const far of FAR) {
    for (const turn of AROUND) {
      const c = Math.cos(turn), s = Math.sin(turn), size = far + Math.abs(c * one.ux - s * one.uy) * one.width / 2;
      const at = [
        Math.min(width - one.width / 2 - 2, Math.max(one.width / 2 + 2, one.x + size * (c * one.ux - s * one.uy))),
        Math.min(height - HEIGHT / 2, Math.max(HEIGHT / 2, one.y + size * (s * one.ux + c * one.uy))),
      ];
      if (done.some((other) => overlap({ ...one, at }, other))) continue;
      const cost = others.filter((other) => covers(at, one.width, other)).length;
      if (cost < least) { least = cost; best = { ...one, at }; }
      if (!cost) return best;
    }
  }
  return best;
}
