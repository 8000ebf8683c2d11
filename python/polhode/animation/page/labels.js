// Places for names, so that none is written over another, and where there is room none over another's arrow.

const HEIGHT = 18;
const GAP = 4; // between names on one line
const AROUND = [0, 45, -45, 90, -90, 135, -135, 180].map((degrees) => degrees * Math.PI / 180);

const overlap = (a, b) => Math.abs(a.at[0] - b.at[0]) < (a.width + b.width) / 2 + GAP && Math.abs(a.at[1] - b.at[1]) < HEIGHT;
const NEAR_TIP = 60; // of an arrow, pixels that names keep off

/** Whether a name stands on the end of another's arrow. */
function covers(at, width, { x, y, ux, uy, size }) {
  const back = Math.min(Math.min(size, NEAR_TIP), Math.max(0, (x - at[0]) * ux + (y - at[1]) * uy));
  return Math.abs(at[0] - x + back * ux) < width / 2 + 2 && Math.abs(at[1] - y + back * uy) < HEIGHT / 2;
}

/** For names at (x, y), pointing outward along (ux, uy): each beyond its point, or where there is room nearby. */
export function placed(names, width, height) {
  const done = [];
  for (const one of names) {
    let best = null, least = Infinity;
    for (const far of [14, 26, 40]) {
      for (const turn of AROUND) {
        const c = Math.cos(turn), s = Math.sin(turn), size = far + Math.abs(c * one.ux - s * one.uy) * one.width / 2;
        const at = [
          Math.min(width - one.width / 2 - 2, Math.max(one.width / 2 + 2, one.x + size * (c * one.ux - s * one.uy))),
          Math.min(height - HEIGHT / 2, Math.max(HEIGHT / 2, one.y + size * (s * one.ux + c * one.uy))),
        ];
        const others = names.filter((other) => other !== one && covers(at, one.width, other)).length;
        const cost = 2 * names.length * done.filter((other) => overlap({ ...one, at }, other)).length + others;
        if (cost < least) { least = cost; best = at; }
        if (!cost) break;
      }
      if (!least) break;
    }
    done.push({ ...one, at: best });
  }
  return done;
}
