// The energy in the readouts: of motion, T; of position, V, where what acts has a potential; and their sum with its drift.

const SIX = (x) => x.toPrecision(6);

/** Rows of names and words; `known` is what the page was given, its numbers unpacked, and k the frame, or null where T is computed. */
export function energyRows(known, k, computed) {
  if (k === null || !known.kinetic) return [["T", SIX(computed + known.travel)]];
  const kinetic = known.kinetic[k];
  if (!known.potential) return [["T", SIX(kinetic)], ...(known.why ? [["V", known.why]] : [])];
  const potential = known.potential[k], drift = kinetic - known.kinetic[0] + (potential - known.potential[0]);
  return [["T", SIX(kinetic)], ["V", SIX(potential)], ["T + V", SIX(kinetic + potential) + (known.size ? `, drift ${(drift / known.size).toExponential(1)}` : "")]];
}
