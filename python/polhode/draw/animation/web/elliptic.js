// Elliptic integrals and functions, with the complementary modulus k' as their argument: no digits are lost near the separatrix.

import { PI, add, divide, multiply, root, twofold } from "./double.js";

/**
 * Bulirsch's complete integral to twice the precision, for p > 0 and a, b >= 0 (Numer. Math. 13 (1969) 305):
 * the integral from 0 to pi/2 of (a cos^2 + b sin^2) / ((cos^2 + p sin^2) sqrt(cos^2 + k'^2 sin^2)).
 */
export function complete(kPrime, p, a, b) {
  let k = kPrime, e = kPrime, m = twofold(1), r = root(p), u = a, v = divide(b, r);
  for (let step = 0; step < 40; step++) {
    const f = u, g = divide(e, r), last = m;
    u = add(u, divide(v, r));
    v = multiply(twofold(2), add(multiply(f, g), v));
    r = add(r, g);
    m = add(m, k);
    if (Math.abs(last[0] - k[0]) <= 1e-17 * last[0]) break;
    k = multiply(twofold(2), root(e));
    e = multiply(k, m);
  }
  const half = [PI[0] / 2, PI[1] / 2];
  return divide(multiply(half, add(multiply(u, m), v)), multiply(m, add(m, r)));
}

/** Jacobi's sn, cn and dn of 0 <= u <= K, each with all its digits (Bulirsch, Numer. Math. 7 (1965) 78). */
export function jacobi(u, kPrime) {
  if (u === 0) return [0, 1, 1];
  let a = 1, m = kPrime * kPrime, c = 1, dn = 1;
  const means = [], roots = [];
  for (let step = 0; step < 40; step++) {
    means.push(a);
    const g = Math.sqrt(m);
    roots.push(g);
    c = 0.5 * (a + g);
    if (Math.abs(a - g) <= 1e-9 * a) break;
    m = g * a;
    a = c;
  }
  const sine = Math.sin(c * u), cosine = Math.cos(c * u);
  let quotient = cosine / sine;
  c *= quotient;
  for (let step = means.length - 1; step >= 0; step--) {
    const b = means[step];
    quotient *= c;
    c *= dn;
    dn = (roots[step] + quotient) / (b + quotient);
    quotient = c / b;
  }
  const sn = 1 / Math.sqrt(c * c + 1);
  return [sn, c * sn, dn];
}

/** Carlson's R_F (Numer. Algorithms 10 (1995) 13). */
export function carlsonRF(x, y, z) {
  for (let step = 0; step < 100; step++) {
    const mean = (x + y + z) / 3, dx = (mean - x) / mean, dy = (mean - y) / mean, dz = -dx - dy;
    if (Math.max(Math.abs(dx), Math.abs(dy), Math.abs(dz)) < 2e-3) {
      const e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
      const series = 1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44 - 5 * e2 ** 3 / 208 + 3 * e3 * e3 / 104 + e2 * e2 * e3 / 16;
      return series / Math.sqrt(mean);
    }
    const shift = Math.sqrt(x * y) + Math.sqrt(y * z) + Math.sqrt(z * x);
    x = (x + shift) / 4; y = (y + shift) / 4; z = (z + shift) / 4;
  }
  return NaN;
}

/** R_C(1, 1 + e), for e > -1. */
function rcOne(e) {
  if (Math.abs(e) < 1e-3) return 1 - e / 3 + e * e / 5 - e ** 3 / 7 + e ** 4 / 9 - e ** 5 / 11;
  return e > 0 ? Math.atan(Math.sqrt(e)) / Math.sqrt(e) : Math.atanh(Math.sqrt(-e)) / Math.sqrt(-e);
}

/** Carlson's R_J, for p > 0. */
export function carlsonRJ(x, y, z, p) {
  let sum = 0, power = 1;
  for (let step = 0; step < 100; step++) {
    const mean = (x + y + z + 2 * p) / 5;
    const dx = (mean - x) / mean, dy = (mean - y) / mean, dz = (mean - z) / mean, dp = (-dx - dy - dz) / 2;
    if (Math.max(Math.abs(dx), Math.abs(dy), Math.abs(dz), Math.abs(dp)) < 2e-3) {
      const xyz = dx * dy * dz, e2 = dx * dy + dx * dz + dy * dz - 3 * dp * dp;
      const e3 = xyz + 2 * e2 * dp + 4 * dp ** 3, e4 = (2 * xyz + e2 * dp + 3 * dp ** 3) * dp, e5 = xyz * dp * dp;
      const series = 1 - 3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 + 3 * e5 / 26 - e2 ** 3 / 16
        + 3 * e3 * e3 / 40 + 3 * e2 * e4 / 20;
      return 6 * sum + power * series / (mean * Math.sqrt(mean));
    }
    const [rx, ry, rz, rp] = [x, y, z, p].map(Math.sqrt), shift = rx * ry + ry * rz + rz * rx;
    const d = (rp + rx) * (rp + ry) * (rp + rz);
    const e = ((x - p) / d) * ((y - p) / d) * (z - p);
    sum += power / d * rcOne(-e);
    power /= 4;
    x = (x + shift) / 4; y = (y + shift) / 4; z = (z + shift) / 4; p = (p + shift) / 4;
  }
  return NaN;
}
