// The states between the frames of a motion: smooth turns through the attitudes, with the angular velocities there.

import { conjugate, length, scaled, sum, times, turnBy, unit, vectorOf } from "./vectors.js";

/** An array of numbers from the text that holds its bytes. */
export function numbers(text, Kind) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Kind(bytes.buffer);
}

export class Frames {
  /** t, and at each the attitude, ω and, where there is one, the momentum h of what the body carries, row by row. */
  constructor(t, quaternion, omega, inside) {
    Object.assign(this, { t, quaternion, omega, inside, count: t.length });
  }

  row(array, k, width) {
    return Array.from(array.subarray(width * k, width * k + width));
  }

  /** Between which frames a time is, and how far from one to the other. */
  place(t) {
    let low = 0, high = this.count - 1;
    const forward = this.t[high] >= this.t[0];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (forward ? this.t[middle] <= t : this.t[middle] >= t) low = middle; else high = middle;
    }
    const span = this.t[high] - this.t[low];
    return [low, high, span, span ? Math.min(1, Math.max(0, (t - this.t[low]) / span)) : 0];
  }

  /** The frame that is nearest to a time. */
  nearest(t) {
    const [low, high, , s] = this.place(t);
    return s < 0.5 ? low : high;
  }

  at(t) {
    const [low, high, span, s] = this.place(t);
    const [a, b] = [low, high].map((k) => this.row(this.quaternion, k, 4)), [u, v] = [low, high].map((k) => this.row(this.omega, k, 3));
    return {
      t,
      q: turnedBetween(a, b, scaled(u, span), scaled(v, span), s),
      omega: this.smooth(this.omega, low, high, span, s),
      inside: this.inside && this.smooth(this.inside, low, high, span, s),
    };
  }

  /** A cubic through rows of vectors, with the slopes of the parabolas through neighbours. */
  smooth(array, low, high, span, s) {
    const from = this.row(array, low, 3), to = this.row(array, high, 3);
    if (!span) return from;
    const chord = sum(to, scaled(from, -1));
    const before = this.slope(array, low, chord, span, -1), after = this.slope(array, high, chord, span, 1);
    return from.map((x, i) => x + s * chord[i] + s * (1 - s) * ((1 - s) * (before[i] - chord[i]) - s * (after[i] - chord[i])));
  }

  /** The slope at a frame, for a step of a span, from the chords on both of its sides. */
  slope(array, k, chord, span, side) {
    const other = k + side;
    if (other < 0 || other >= this.count) return chord;
    const step = (this.t[other] - this.t[k]) * side;
    if (!step) return chord;
    const here = this.row(array, k, 3), there = this.row(array, other, 3);
    const weight = step / (step + span), next = scaled(sum(there, scaled(here, -1)), side * span / step);
    return chord.map((x, i) => weight * x + (1 - weight) * next[i]);
  }
}

/** From one attitude to the next along a cubic on the sphere of turns, with ω's turns u and v at its ends (body components). */
export function turnedBetween(a, b, u, v, s) {
  const first = scaled(u, 1 / 3), last = scaled(v, 1 / 3);
  const middle = vectorOf(times(times(conjugate(turnBy(first)), times(conjugate(a), b)), conjugate(turnBy(last))));
  const r = 1 - s, weights = [1 - r * r * r, s * s * (3 - 2 * s), s * s * s];
  const turn = (vector, weight) => turnBy(scaled(vector, weight));
  const q = times(times(times(a, turn(first, weights[0])), turn(middle, weights[1])), turn(last, weights[2]));
  return length(middle) < 3.1 ? unit(q) : unit(a.map((x, i) => (s < 0.5 ? x : b[i])));
}
