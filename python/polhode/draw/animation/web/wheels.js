// Wheels in the body: discs on its outside, not to scale, that turn by their angle relative to it.

import { plain } from "./clock.js";
import { PICTURES, RINGS, SPOKE, SPOKES, TURN } from "./shared.js";
import { colors } from "./theme.js";
import { cross, dot, length, rotate, scaled, sum } from "./vectors.js";

const RING = 48;

/** The factor 1, 2, 5, 10, ... by which a turning is drawn slower, so that from picture to picture it is no wider than an eye follows: by half a turn a wheel would seem to stand still. */
export function slowed(turn) {
  if (!(turn > TURN * (1 + 1e-9))) return 1;
  const decade = 10 ** Math.floor(Math.log10(turn / TURN));
  return [1, 2, 5, 10].map((step) => step * decade).find((factor) => factor * TURN >= turn * (1 - 1e-9));
}

export class Wheel {
  /** What the page was given of it, its numbers unpacked, and the frames of the motion. */
  constructor(given, frames) {
    Object.assign(this, given, { frames });
    const k = this.axis.map(Math.abs).indexOf(Math.min(...this.axis.map(Math.abs))), other = [0, 0, 0];
    other[k] = 1;
    const u = cross(this.axis, other);
    this.across = scaled(u, 1 / length(u));
    this.beside = cross(this.axis, this.across); // counterclockwise about the axis
    this.fastest = this.constant === null ? this.rate ? this.rate.reduce((most, x) => Math.max(most, Math.abs(x)), 0) : null : Math.abs(this.constant);
  }

  /** Its speed and angle at a time; null where the momentum alone is known. */
  at(t) {
    if (this.fastest === null) return null;
    if (this.constant !== null) return { rate: this.constant, angle: this.constant * (t - this.frames.t[0]) };
    const [low, high, span, s] = this.frames.place(t), { angle, rate } = this, r = 1 - s;
    return { // a cubic with these speeds at its ends
      rate: r * rate[low] + s * rate[high],
      angle: angle[low] + (angle[high] - angle[low]) * s * s * (3 - 2 * s) + span * r * s * (r * rate[low] - s * rate[high]),
    };
  }

  /** How many times slower its turning is drawn, at so many units of time a second on the screen. */
  factor(speed) { return this.fastest === null ? 1 : slowed(this.fastest * Math.abs(speed) / PICTURES); }

  /** Writes its name beside it, unless it is behind the body, and where there is room how much slower it is drawn. */
  label(view, { q }, size, speed) {
    if (dot(rotate(q, this.axis), view.toward) < -0.35) return;
    const middle = scaled(rotate(q, this.middle), size), side = this.isNear(view, q) ? this.half : -this.half;
    const rim = this.ring(this.radius, side).map((p) => scaled(rotate(q, p), size));
    const away = (p) => { const [x, y] = view.place(p); return Math.hypot(x - view.width / 2, y - view.height / 2); };
    const factor = this.factor(speed), name = factor > 1 ? `${this.name}, slowed ${plain(factor)}\u00d7` : this.name;
    view.label(rim.reduce((a, b) => (away(b) > away(a) ? b : a)), colors.inside, name, middle, this.name);
  }

  /** Its speed, in words. */
  words(now, unit, speed) {
    const known = this.at(now), factor = this.factor(speed);
    if (!known) return "speed not known, its momentum alone";
    return `${(known.rate + 0).toPrecision(4)} rad/${unit}${factor > 1 ? `, drawn ${plain(factor)}\u00d7 slower` : ""}`;
  }

  /** Whether it is on the near side of the body: a plane normal to its axis parts the two. */
  isNear(view, q) { return dot(rotate(q, this.axis), view.toward) >= 0; }

  /** A point in the body at an angle about its axis, so far from it, and so far along it from the middle. */
  point(angle, radius, height) {
    const around = sum(scaled(this.across, radius * Math.cos(angle)), scaled(this.beside, radius * Math.sin(angle)));
    return sum(sum(this.middle, scaled(this.axis, height)), around);
  }

  ring(radius, height, from = 0, to = 2 * Math.PI, count = RING) {
    return Array.from({ length: count + 1 }, (_, k) => this.point(from + (to - from) * k / count, radius, height));
  }

  /** Draws it at an attitude, so many times its size. */
  draw(view, now, size, speed) {
    const { q } = now, put = (v) => scaled(rotate(q, v), size), known = this.at(now.t);
    const side = this.isNear(view, q) ? this.half : -this.half;
    const point = (angle, radius, height) => put(this.point(angle, radius, height));
    const ring = (...part) => this.ring(...part).map(put);
    const edge = Math.atan2(dot(cross(rotate(q, this.axis), view.toward), rotate(q, this.beside)), dot(cross(rotate(q, this.axis), view.toward), rotate(q, this.across)));
    const r = this.radius, rim = { fill: colors.rim };
    view.path(ring(r, -side), colors.inside, 1, rim);
    view.path([point(edge, r, -side), point(edge, r, side), point(edge + Math.PI, r, side), point(edge + Math.PI, r, -side)], colors.inside, 0, rim);
    for (const angle of [edge, edge + Math.PI]) view.path([point(angle, r, -side), point(angle, r, side)], colors.inside, 1);
    view.path(ring(r, side), colors.inside, 1.4, { fill: colors.disc });
    if (known) {
      const turned = known.angle / this.factor(speed);
      view.path([point(0, 0, side), ...ring(SPOKE * r, side, turned, turned + 2 * Math.PI / SPOKES, 8), point(0, 0, side)], colors.inside, 0, { fill: colors.inside }); // its mark
      for (let k = 2; k < SPOKES; k++) view.path([point(0, 0, side), point(turned + 2 * Math.PI * k / SPOKES, SPOKE * r, side)], colors.inside, 1.6);
    } else for (const part of RINGS) view.path(ring(part * r, side), colors.inside, 1);
  }
}
