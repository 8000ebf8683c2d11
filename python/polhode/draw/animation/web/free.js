// The motion of a free body in closed form, from its principal moments and its start.
//
// ω circles the principal axis f3 of the moment C, the least or the greatest; A is the other extreme, B the intermediate moment:
// x = X cn u, y = ±Y sn u, z = Z dn u with u = λt + u0. From a start the addition theorem gives ω without u0, which near the
// separatrix would have lost digits. The precession φ about L is an integral of the third kind:
//   dφ/dt = L (A x² + B y²)/(A² x² + B² y²) = L/B + L (B − A)/(A B) · cos²/(cos² + p sin²),   p = (B Y/A X)².

import { PI, add, divide, exactProduct, multiply, root, subtract, twofold } from "./double.js";
import { carlsonRF, carlsonRJ, complete, jacobi } from "./elliptic.js";
import { conjugate, times, turnBy } from "./vectors.js";

const product = (...numbers) => numbers.reduce((all, x) => multiply(all, typeof x === "number" ? twofold(x) : x), twofold(1));
const gap = (a, b) => subtract(twofold(a), twofold(b));
const square = (x) => exactProduct(x, x);

/** How far a start is from the separatrix, (L² − 2T I2)/L²: positive where ω circles axis 3, negative where axis 1. */
export function separation([i1, i2, i3], [x, y, z]) {
  const excess = subtract(product(i3, gap(i3, i2), square(z)), product(i1, gap(i2, i1), square(x)));
  return excess[0] / ((i1 * x) ** 2 + (i2 * y) ** 2 + (i3 * z) ** 2);
}

export class FreeBody {
  /** moments: ascending; omega: along the principal axes; attitude: of the principal axes in space, (x, y, z, w). */
  constructor(moments, omega, attitude) {
    Object.assign(this, { moments, omega: [...omega], attitude });
    const [i1, i2, i3] = moments, [x, y, z] = omega;
    const drive = [(i2 - i3) * y * z, (i3 - i1) * z * x, (i1 - i2) * x * y];
    this.isSteady = drive.every((d) => d === 0);
    this.halfPeriod = Infinity;
    if (!this.isSteady) this.begin();
  }

  begin() {
    const [i1, i2, i3] = this.moments, [x, y, z] = this.omega;
    const circlesThird = separation(this.moments, this.omega) > 0;
    // Right-handed f1, f2, f3 with ω·f3 > 0.
    const frame = circlesThird ? [[0, 1], [1, 1], [2, 1]] : [[2, 1], [1, -1], [0, 1]];
    if ((circlesThird ? z : x) < 0) { frame[1][1] *= -1; frame[2][1] *= -1; }
    this.frame = frame;
    const w = frame.map(([k, sign]) => sign * this.omega[k]);
    const [A, B, C] = circlesThird ? [i1, i2, i3] : [i3, i2, i1];
    Object.assign(this, { w, A, B, C });
    const N1 = add(product(A, gap(C, A), square(w[0])), product(B, gap(C, B), square(w[1]))); // 2TC − L²
    const N2 = add(product(B, gap(B, A), square(w[1])), product(C, gap(C, A), square(w[2]))); // L² − 2TA
    const D = subtract(product(C, gap(C, B), square(w[2])), product(A, gap(B, A), square(w[0]))); // L² − 2TB
    const pace = root(divide(product(gap(C, B), N2), product(A, B, C)));
    let k2 = divide(product(gap(C, A), D), product(gap(C, B), N2));
    if (!(k2[0] > 1e-280)) k2 = twofold(1e-280); // on the separatrix: never there
    this.kPrime = root(k2);
    this.pace = pace[0];
    this.X = Math.sqrt(N1[0] / (A * (C - A)));
    this.Y = Math.sqrt(N1[0] / (B * (C - B)));
    const p = divide(product(B, gap(C, A)), product(A, gap(C, B)));
    this.p = p[0];
    const one = twofold(1), none = twofold(0);
    const K = complete(this.kPrime, one, one, one);
    this.quarter = divide(K, pace);
    this.half = multiply(twofold(2), this.quarter);
    this.halfPeriod = this.half[0];
    this.L = Math.hypot(A * w[0], B * w[1], C * w[2]);
    const L = root(add(add(product(square(A), square(w[0])), product(square(B), square(w[1]))), product(square(C), square(w[2]))));
    this.base = divide(L, twofold(B));
    const share = divide(product(L, gap(B, A)), product(A, B, pace));
    this.share = share[0];
    this.perHalf = product(2, share, complete(this.kPrime, p, one, none)); // of φ beyond the base
    this.sense = C > B ? 1 : -1;
    this.phase0 = this.amplitude(w);
    this.outer = times(this.attitude, conjugate(this.turned(w, 0)));
  }

  /** The angle whose sine and cosine are sn and cn. */
  amplitude(w) {
    return Math.atan2(this.sense * w[1] / this.Y, w[0] / this.X);
  }

  /** The integral of cos²/(cos² + p sin²)/Δ from 0 to an angle of at most a quarter turn. */
  beyond(angle) {
    const s = Math.sin(angle), c = Math.cos(angle), m1 = this.kPrime[0] ** 2, delta = c * c + m1 * s * s;
    const far = c * c + this.p * s * s;
    return s * (carlsonRF(c * c, delta, 1) - this.p / 3 * s * s * carlsonRJ(c * c, delta, 1, far));
  }

  /** ω along f1, f2, f3 after a time of at most a quarter of a period. */
  near(t, [x, y, z]) {
    const { A, B, C, pace } = this, after = Math.abs(t), v = this.quarter[0] - after + this.quarter[1];
    let sn, cn, dn;
    const kp = this.kPrime[0];
    if (after <= 0.5 * this.quarter[0]) {
      [sn, cn, dn] = jacobi(pace * after, kp);
    } else { // from the other end
      const [s, c, d] = jacobi(pace * Math.max(0, v), kp);
      [sn, cn, dn] = [c / d, kp * s / d, kp / d];
    }
    // With p >= q in the sense of the clock: c belongs to f1, d to f3.
    const s = Math.sign(t) * sn / pace;
    const a1 = (B - C) / A, a2 = (C - A) / B, a3 = (A - B) / C;
    const below = cn * cn - a1 * a2 * z * z * s * s;
    return [(x * cn + a1 * y * z * s * dn) / below, (y * cn * dn + a2 * z * x * s) / below, (z * dn + a3 * x * y * s * cn) / below];
  }

  turned(w, phi) {
    const [x, y, z] = [this.A * w[0], this.B * w[1], this.C * w[2]];
    const theta = Math.atan2(Math.hypot(x, y), z), psi = Math.atan2(x, y);
    const about = (k, angle) => [k === 0 ? Math.sin(angle / 2) : 0, 0, k === 2 ? Math.sin(angle / 2) : 0, Math.cos(angle / 2)];
    return times(times(about(2, phi), times(about(0, theta), about(2, psi))), this.fromPrincipal());
  }

  /** The turn that takes components along the principal axes to those along f1, f2, f3. */
  fromPrincipal() {
    const columns = this.frame.map(([k, sign]) => [0, 1, 2].map((i) => (i === k ? sign : 0)));
    return conjugate(quaternionOf(columns));
  }

  /** The state at a time: ω along the principal axes and the attitude of these axes. */
  at(t) {
    if (this.isSteady) {
      const turn = turnBy(this.omega.map((x) => x * t));
      return { omega: [...this.omega], attitude: times(this.attitude, turn) };
    }
    const halves = Math.round(t / this.half[0]);
    const rest = subtract(twofold(t), multiply(this.half, twofold(halves)));
    const sign = halves % 2 ? -1 : 1;
    const w = this.near(rest[0] + rest[1], [sign * this.w[0], sign * this.w[1], this.w[2]]);
    // φ: whole half periods to twice the precision, the rest between amplitudes.
    const phase = this.amplitude(w);
    const within = (angle) => { const m = Math.round(angle / Math.PI); return [m, this.beyond(angle - m * Math.PI)]; };
    const [m0, g0] = within(this.phase0), [m1, g1] = within(phase);
    let turns = m1 - m0;
    // The amplitude rises by half a turn in half a period, to less than half a turn: of the angles that fit, the nearest to that.
    const expected = t / this.halfPeriod;
    turns += 2 * Math.round((expected - (turns + (phase - m1 * Math.PI - this.phase0 + m0 * Math.PI) / Math.PI)) / 2);
    const whole = add(multiply(this.base, twofold(t)), multiply(this.perHalf, twofold(turns)));
    const circles = Math.round(whole[0] / (2 * Math.PI));
    const remainder = subtract(whole, multiply(PI, twofold(2 * circles)));
    const phi = remainder[0] + remainder[1] + this.share * (g1 - g0);
    const omega = [0, 0, 0];
    this.frame.forEach(([k, s], i) => { omega[k] = s * w[i]; });
    return { omega, attitude: times(this.outer, this.turned(w, phi)) };
  }

  /** Whether the intermediate axis turns over: it is nearest to L, now along it and then against it, within 45° both times. */
  get turnsOver() {
    return !this.isSteady && this.B * this.Y > Math.SQRT1_2 * this.L;
  }

  /** From a time to the next at which the body turns over: ω passes through zero along the intermediate axis. */
  nextFlip(t) {
    if (this.isSteady) return Infinity;
    const halves = Math.round(t / this.half[0]), rest = t - halves * this.half[0];
    const sign = halves % 2 ? -1 : 1;
    const w = this.near(rest, [sign * this.w[0], sign * this.w[1], this.w[2]]);
    const angle = this.amplitude(w), m = Math.round(angle / Math.PI), r = angle - m * Math.PI;
    const s = Math.sin(r), c = Math.cos(r), m1 = this.kPrime[0] ** 2;
    const since = s * carlsonRF(c * c, c * c + m1 * s * s, 1) / this.pace; // from the last or to the next flip
    return since < 0 ? -since : this.half[0] - since;
  }
}

/** The quaternion of a rotation whose matrix has these columns. */
export function quaternionOf([[a, d, g], [b, e, h], [c, f, i]]) {
  const four = [1 + a - e - i, 1 - a + e - i, 1 - a - e + i, 1 + a + e + i];
  const k = four.indexOf(Math.max(...four)), s = 2 * Math.sqrt(four[k]);
  return [
    [s / 4, (b + d) / s, (c + g) / s, (h - f) / s],
    [(b + d) / s, s / 4, (f + h) / s, (c - g) / s],
    [(c + g) / s, (f + h) / s, s / 4, (d - b) / s],
    [(h - f) / s, (c - g) / s, (d - b) / s, s / 4],
  ][k];
}
