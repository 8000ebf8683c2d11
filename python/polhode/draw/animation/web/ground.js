// A body that rolls: the plane below it, the camera that follows it, and the traces of the contact on the plane and on the body.

import { DASHES, E_NAMES, colors, key } from "./theme.js";
import { conjugate, cross, difference, dot, length, rotate, scaled, sum } from "./vectors.js";

const ROLLER = 0.48; // of the view, in space; in the body it is BESIDE
const BESIDE = 0.95;
const BELOW = 0.35; // the plane, under the middle of the view
const PATCH = 1.7;
const CELL = 0.42;
const TOUCHES = 1e-9; // height over the plane, relative to the distance of the centre of mass

/** A plane and its places in space; `center` and `contact` are rows of three at each frame. */
export class Ground {
  constructor(given, frames) {
    const n = given.normal, k = n.map(Math.abs).indexOf(Math.min(...n.map(Math.abs))), e = [0, 0, 0];
    e[k] = 1;
    const first = difference(e, scaled(n, n[k]));
    Object.assign(this, { ...given, frames, along: scaled(first, 1 / length(first)) });
    this.across = cross(n, this.along);
  }

  /** Places at a time: of the centre of mass, and of the contact in space and, from the centre, in the body. In flight the contact is the lowest point, and touches nothing. */
  at(t, q) {
    const [low, high, span, s] = this.frames.place(t);
    const center = this.frames.smooth(this.center, low, high, span, s), contact = this.frames.smooth(this.contact, low, high, span, s);
    const touches = Math.abs(dot(this.normal, difference(contact, this.middle))) <= TOUCHES * length(difference(contact, center));
    return { center, contact, touches, inBody: rotate(conjugate(q), difference(contact, center)), outward: rotate(conjugate(q), scaled(this.normal, -1)) };
  }

  /** The lines of a grid that is fixed in the plane, around a point of it, within a distance. */
  lines(t, around, reach, cell) {
    const angle = this.turntable * t, c = Math.cos(angle), s = Math.sin(angle);
    const u = sum(scaled(this.along, c), scaled(this.across, s)), v = sum(scaled(this.across, c), scaled(this.along, -s));
    const from = difference(around, this.middle), found = [];
    for (const [a, b] of [[u, v], [v, u]]) {
      const here = dot(from, a);
      for (let k = Math.ceil((here - reach) / cell); k * cell <= here + reach; k++) {
        const off = k * cell - here, half = Math.sqrt(Math.max(0, reach * reach - off * off));
        found.push([sum(around, sum(scaled(a, off), scaled(b, -half))), sum(around, sum(scaled(a, off), scaled(b, half)))]);
      }
    }
    return found;
  }

  /** A circle in the plane. */
  edge(around, reach) {
    return Array.from({ length: 73 }, (_, k) => sum(around, sum(scaled(this.along, reach * Math.cos(k * Math.PI / 36)), scaled(this.across, reach * Math.sin(k * Math.PI / 36)))));
  }
}

/** Draws the trace on a body, what is on its far side more faintly. */
function traceOn(view, trail, q, put, width) {
  const isNear = (one) => dot(rotate(q, one.outward), view.toward) >= 0;
  let run = [];
  trail.forEach((one, i) => {
    if (!one.touches) {
      run = [];
      return;
    }
    run.push(put(one.inBody));
    const last = i === trail.length - 1, near = isNear(one);
    if (last || !trail[i + 1].touches || isNear(trail[i + 1]) !== near) {
      if (run.length > 1) view.path(run, colors.contact, width, { alpha: near ? 1 : 0.3 });
      run = [put(one.inBody)];
    }
  });
}

/** The body on its plane, \u03c9 and L, and the traces of the contact; the view follows the body. */
export function drawOnGround(view, now, motion, shown) {
  if (!view.begin()) return;
  const { q, omega, momentum, place } = now, { ground, solid } = motion, n = ground.normal;
  const size = ROLLER / solid.reach, below = difference(place.center, scaled(n, dot(n, difference(place.center, ground.middle))));
  const put = (x) => sum(scaled(difference(x, below), size), scaled(n, -BELOW)), center = put(place.center);
  const trail = shown.traces ? [...motion.trail.upTo(now.since).contact, place] : [];
  const plane = () => {
    view.path(ground.edge(below, PATCH / size).map(put), colors.shade, 0.8, { fill: colors.rule, alpha: 0.4 });
    for (const line of ground.lines(now.t, below, PATCH / size, CELL / size)) view.path(line.map(put), colors.grey, 1, { alpha: 0.8 });
    let run = []; // what is farther is outside of the plane that is drawn
    trail.forEach((one, i) => {
      const inside = one.touches && length(difference(one.contact, below)) * size < PATCH;
      if (inside) run.push(put(one.contact));
      if (run.length > 1 && (!inside || i === trail.length - 1)) view.path(run, colors.contact, 2);
      if (!inside) run = [];
    });
  };
  const body = () => {
    const middle = view.middle;
    view.middle = view.place(center);
    solid.draw(view, q, size);
    view.middle = middle;
    traceOn(view, trail, q, (p) => sum(center, scaled(rotate(q, p), size)), 2.4);
  };
  const parts = dot(n, view.toward) >= 0 ? [plane, body] : [body, plane];
  for (const draw of parts) draw();
  if (place.touches) view.dot(put(place.contact), colors.contact, 4);
  if (shown.axes) {
    motion.axes.forEach((axis, i) => {
      const tip = scaled(rotate(q, axis), 1.25 * ROLLER);
      view.path([difference(center, tip), sum(center, tip)], colors.axes[i], 1.4, { alpha: 0.85, dash: DASHES[i] });
    });
  }
  view.arrow(sum(center, scaled(momentum, 0.85 / motion.strongest)), colors.momentum, "L", center);
  view.arrow(sum(center, scaled(rotate(q, omega), 0.85 / motion.fastest)), colors.omega, "\u03c9", center);
  if (place.touches) view.label(put(place.contact), colors.contact, "P", center);
  if (shown.axes) motion.axes.forEach((axis, i) => view.label(sum(center, scaled(rotate(q, axis), 1.25 * ROLLER)), colors.axes[i], E_NAMES[i], center));
  view.end(colors.ground);
}

/** The body at rest, with the trace of the contact on it. */
export function drawOnBody(view, now, motion, shown) {
  if (!view.begin()) return;
  const { solid } = motion, size = BESIDE / solid.reach, still = [0, 0, 0, 1], put = (p) => scaled(p, size);
  solid.draw(view, still, size);
  if (shown.traces) traceOn(view, [...motion.trail.upTo(now.since).contact, now.place], still, put, 2.4);
  if (shown.axes) motion.axes.forEach((axis, i) => view.path([scaled(axis, -1.1), scaled(axis, 1.1)], colors.axes[i], 1.4, { alpha: 0.85, dash: DASHES[i] }));
  if (now.place.touches) view.dot(put(now.place.inBody), colors.contact, 5);
  view.arrow(scaled(now.omega, 1.05 / motion.fastest), colors.omega, "\u03c9");
  if (now.place.touches) view.label(put(now.place.inBody), colors.contact, "P");
  if (shown.axes) motion.axes.forEach((axis, i) => view.label(scaled(axis, 1.1), colors.axes[i], E_NAMES[i]));
  view.end(colors.ground);
}

/** Words for both views. */
export function captionsOf(ground, shows) {
  const omega = key("omega", "\u03c9"), P = key("contact", "P");
  const arrows = [...(shows.omega ? [omega] : []), ...(shows.momentum ? [key("momentum", "L")] : [])];
  const traces = `${key("contact", "lines")}: traces of the contact ${P} ${ground.turntable ? "in space" : "on the plane"} and on the body (faint: on its far side)`;
  return [`In space: ${["the body on its plane", ...arrows].join(", ")}${ground.turntable ? "; the plane turns" : ""}; ${traces}`, `In the body: its surface with the trace of the contact ${P}${shows.omega ? `, and ${omega}` : ""}`];
}
