// Numbers of twice the precision, [high, low]: for constants that long times multiply.

export const twofold = (x) => [x, 0];

/** The sum of two floats without rounding. */
export function exactSum(a, b) {
  const high = a + b, part = high - a;
  return [high, (a - (high - part)) + (b - part)];
}

/** The product of two floats without rounding. */
export function exactProduct(a, b) {
  const high = a * b, [a1, a0] = halves(a), [b1, b0] = halves(b);
  return [high, ((a1 * b1 - high) + a1 * b0 + a0 * b1) + a0 * b0];
}

function halves(a) {
  const c = 134217729 * a, high = c - (c - a);
  return [high, a - high];
}

function tidy(high, low) {
  const sum = high + low;
  return [sum, low - (sum - high)];
}

export function add(a, b) {
  const [high, low] = exactSum(a[0], b[0]), [rest, least] = exactSum(a[1], b[1]);
  const [h, l] = tidy(high, low + rest);
  return tidy(h, l + least);
}

export const negative = (a) => [-a[0], -a[1]];
export const subtract = (a, b) => add(a, negative(b));

export function multiply(a, b) {
  const [high, low] = exactProduct(a[0], b[0]);
  return tidy(high, low + (a[0] * b[1] + a[1] * b[0]));
}

export function divide(a, b) {
  const first = a[0] / b[0], rest = subtract(a, multiply(b, [first, 0]));
  const second = rest[0] / b[0], least = subtract(rest, multiply(b, [second, 0]));
  const [high, low] = tidy(first, second);
  return add([high, low], [least[0] / b[0], 0]);
}

export function root(a) {
  if (!(a[0] > 0)) return [0, 0];
  const x = Math.sqrt(a[0]), rest = subtract(a, exactProduct(x, x));
  return tidy(x, rest[0] / (2 * x));
}

export const PI = [3.141592653589793, 1.2246467991473532e-16];
