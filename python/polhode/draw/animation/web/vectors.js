// Vectors, and quaternions (x, y, z, w) that take body components to space components.

/** Whether three ascending moments differ beyond rounding: then there is an intermediate axis, and a separatrix. */
export const areThree = ([i1, i2, i3]) => i2 - i1 > 1e-12 * i3 && i3 - i2 > 1e-12 * i3;

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const scaled = (a, s) => a.map((x) => x * s);
export const sum = (a, b) => a.map((x, i) => x + b[i]);
export const difference = (a, b) => a.map((x, i) => x - b[i]);
export const length = (a) => Math.hypot(...a);
export const mixed = (a, b, s) => a.map((x, i) => x + (b[i] - x) * s);

export function rotate(q, v) {
  const u = [q[0], q[1], q[2]], t = scaled(cross(u, v), 2);
  return sum(sum(v, scaled(t, q[3])), cross(u, t));
}

export const conjugate = (q) => [-q[0], -q[1], -q[2], q[3]];

/** First b, then a. */
export function times(a, b) {
  const [x, y, z, w] = a, [p, q, r, s] = b;
  return [
    w * p + x * s + y * r - z * q,
    w * q - x * r + y * s + z * p,
    w * r + x * q - y * p + z * s,
    w * s - x * p - y * q - z * r,
  ];
}

/** The turn by a vector: its axis, and its length in radians. */
export function turnBy(v) {
  const angle = length(v), s = angle < 1e-8 ? 0.5 : Math.sin(angle / 2) / angle;
  return [v[0] * s, v[1] * s, v[2] * s, Math.cos(angle / 2)];
}

/** The vector of the shorter turn that a quaternion is. */
export function vectorOf(q) {
  const sign = q[3] < 0 ? -1 : 1, sine = Math.hypot(q[0], q[1], q[2]);
  const s = sine < 1e-12 ? 2 : 2 * Math.atan2(sine, sign * q[3]) / sine;
  return [q[0] * s * sign, q[1] * s * sign, q[2] * s * sign];
}

export function unit(q) {
  return scaled(q, 1 / Math.hypot(...q));
}
