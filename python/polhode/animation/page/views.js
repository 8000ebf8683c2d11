// What the two canvases show: the body in space; ω on the ellipsoid of inertia, in the body or rolling in space.

import { circle } from "./camera.js";
import { DASHES, E_NAMES, colors } from "./theme.js";
import { areThree, cross, dot, length, rotate, scaled, sum, unit } from "./vectors.js";

const BODY = 0.85;
const LONGEST = 2.5; // of a semi-axis without end, in lengths of the longest ω

/** The body, L, ω and their ways in space; of a top its pivot and the path of its axis. */
export function drawSpace(view, now, motion, shown, speed) {
  if (!view.begin()) return;
  const { q, omega, momentum, inside } = now, trail = motion.trail.upTo(now.since), fixed = [];
  for (const [axis, name] of [[[1, 0, 0], "x"], [[0, 1, 0], "y"], [[0, 0, 1], "z"]]) {
    view.path([[0, 0, 0], scaled(axis, 1.15)], colors.grey, 1);
    fixed.push([scaled(axis, 1.15), name]);
  }
  const top = motion.top, rate = 1 / motion.fastest;
  if (top) ground(view, top);
  if (shown.traces) {
    view.path(trail.space.map((w) => scaled(w, rate)).concat([scaled(rotate(q, omega), rate)]), colors.omega, 1.5, { alpha: 0.55 });
  }
  const way = top && shown.traces ? trail.axis.concat([rotate(q, top.axis)]) : [];
  const pathOf = (isNear) => { // before the body or behind it
    let run = [];
    way.forEach((point, i) => {
      if ((dot(point, view.toward) >= 0) === isNear) run.push(point);
      if (run.length && ((dot(point, view.toward) >= 0) !== isNear || i === way.length - 1)) {
        view.path(run, colors.axes[nearest(motion.axes, top.axis)], 2, { alpha: isNear ? 1 : 0.5 });
        run = [];
      }
    });
  };
  pathOf(false);
  const size = BODY / motion.solid.reach, depth = (wheel) => dot(rotate(q, wheel.middle), view.toward);
  const wheels = [...motion.wheels].sort((a, b) => depth(a) - depth(b));
  for (const wheel of wheels) if (!wheel.isNear(view, q)) wheel.draw(view, now, size, speed);
  motion.solid.draw(view, q, size);
  for (const wheel of wheels) if (wheel.isNear(view, q)) wheel.draw(view, now, size, speed);
  pathOf(true);
  if (shown.axes) {
    motion.axes.forEach((axis, i) => {
      const tip = scaled(rotate(q, axis), 1.05);
      view.path([top ? [0, 0, 0] : scaled(tip, -1), tip], colors.axes[i], 1.6, { alpha: 0.85, dash: DASHES[i] });
    });
  }
  if (inside) view.arrow(scaled(rotate(q, inside), 1.15 / motion.strongest), colors.inside, length(inside) ? "h" : "");
  view.arrow(scaled(momentum, 1.15 / motion.strongest), colors.momentum, "L");
  view.arrow(scaled(rotate(q, omega), rate), colors.omega, "\u03c9");
  if (shown.axes) motion.axes.forEach((axis, i) => view.label(scaled(rotate(q, axis), 1.05), colors.axes[i], E_NAMES[i]));
  for (const [at, name] of fixed) view.label(at, colors.quiet, name);
  view.end(colors.ground);
}

/** Which of the principal axes a direction is nearest to. */
function nearest(axes, direction) {
  const along = axes.map((axis) => Math.abs(dot(axis, direction)));
  return along.indexOf(Math.max(...along));
}

/** The pivot of a top on its ground, and the circles between which its axis nods. */
function ground(view, top) {
  const down = top.down;
  view.path(circle(down, 0, 0.16), colors.shade, 1.2, { fill: colors.rule, alpha: 0.9 });
  view.dot([0, 0, 0], colors.ink, 4);
  for (const angle of top.limits) view.path(circle(down, -Math.cos(angle), Math.sin(angle)), colors.shade, 1, { dash: [4, 4], alpha: 0.8 });
  view.path([scaled(down, 0.55), scaled(down, 0.8)], colors.gravity, 1.5);
  view.label(scaled(down, 0.8), colors.gravity, "g");
}

/** Semi-axes of ω·Iω = 2T along the principal axes, drawn so that the largest of the motion fits. */
function semiAxes(motion, along) {
  const doubled = along.reduce((total, w, i) => total + motion.moments[i] * w * w, 0);
  return motion.moments.map((m) => Math.min(LONGEST * motion.fastest, Math.sqrt(doubled / m) || 0));
}

const toBody = (motion, p) => motion.axes.reduce((v, axis, i) => sum(v, scaled(axis, p[i])), [0, 0, 0]);

/** The curves through the intermediate axis that part the two ways of circling; none of a symmetric body. */
function separatrix([i1, i2, i3], radii) {
  const r = Math.sqrt(i1 * (i2 - i1) / (i3 * (i3 - i2)));
  if (!areThree([i1, i2, i3]) || !(r > 0 && Number.isFinite(r))) return [];
  const size = 1 / Math.hypot(1 / radii[0], r / radii[2]);
  return [1, -1].map((sign) => Array.from({ length: 73 }, (_, k) => {
    const a = k * Math.PI / 36;
    return [size * Math.cos(a), radii[1] * Math.sin(a), sign * r * size * Math.cos(a)];
  }));
}

/** The ellipsoid with its rings, the separatrix and the way of ω on it; `put` takes body components to the view's space. */
function ellipsoid(view, motion, radii, size, put, way) {
  const turn = (p) => put(toBody(motion, p.map((x, i) => x * radii[i] * size)));
  const to = [0, 1, 2].map((i) => { const unit = [0, 0, 0]; unit[i] = 1; return dot(put(toBody(motion, unit)), view.toward) / (radii[i] || 1); });
  if (length(to)) view.path(circle(to, 0, 1).map(turn), colors.shade, 1.2, { fill: colors.rule, alpha: 0.35 });
  const near = (p) => dot(p, to) >= 0;
  const halves = (points, color, width, faint, strong) => { // far parts fainter
    let run = [points[0]];
    for (let k = 1; k < points.length; k++) {
      const same = near(points[k]) === near(points[k - 1]);
      run.push(points[k]);
      if (!same || k === points.length - 1) { view.path(run.map(turn), color, width, { alpha: near(points[k - 1]) ? strong : faint }); run = [points[k]]; }
    }
  };
  for (const axis of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) for (const h of axis[2] ? [-0.5, 0, 0.5] : [0]) halves(circle(axis, h, Math.sqrt(1 - h * h)), colors.shade, 0.8, 0.2, 0.7);
  for (const curve of separatrix(motion.moments, radii)) halves(curve.map((p) => p.map((x, i) => x / radii[i])), colors.ink, 1.4, 0.25, 0.9);
  if (way.length > 1) view.path(way.map((w) => put(scaled(w, size))), colors.omega, 2.4);
}

/** In the body: the polhode. */
export function drawBody(view, now, motion, shown) {
  if (!view.begin()) return;
  const radii = semiAxes(motion, now.along), size = motion.scale;
  const way = shown.traces ? motion.trail.upTo(now.since).body.concat([now.omega]) : [];
  ellipsoid(view, motion, radii, size, (v) => v, way);
  view.arrow(scaled(now.omega, size), colors.omega, "\u03c9");
  motion.axes.forEach((axis, i) => {
    const tip = scaled(axis, Math.min(1.35, radii[i] * size + 0.18));
    view.path([scaled(axis, radii[i] * size), tip], colors.axes[i], 2, { dash: DASHES[i] });
    view.label(tip, colors.axes[i], E_NAMES[i]);
  });
  view.end(colors.ground);
}

/** Poinsot: the ellipsoid rolls, without slipping, on the invariable plane, which L is normal to and which lies below. */
export function drawPoinsot(view, now, motion, shown) {
  if (!view.begin()) return;
  const up = scaled(now.momentum, 1 / (length(now.momentum) || 1)), turn = toBelow(up);
  const put = (v) => rotate(turn, rotate(now.q, v)), radii = semiAxes(motion, now.along), size = motion.scale;
  const contact = put(scaled(now.omega, size)), trail = motion.trail.upTo(now.since), height = contact[2];
  const reach = 1.25 * Math.max(...radii) * size, plane = [[1, 1], [1, -1], [-1, -1], [-1, 1], [1, 1]].map(([x, y]) => [x * reach, y * reach, height]);
  view.path(plane, colors.shade, 1, { fill: colors.rule, alpha: 0.5 });
  if (shown.traces) view.path(trail.space.map((w) => rotate(turn, scaled(w, size))).concat([contact]), colors.omega, 1.6, { alpha: 0.8 });
  ellipsoid(view, motion, radii, size, put, shown.traces ? trail.body.concat([now.omega]) : []);
  view.path([[0, 0, 0], [0, 0, height]], colors.momentum, 1.2, { dash: [4, 4] });
  view.arrow(contact, colors.omega, "\u03c9");
  view.dot(contact, colors.omega, 5);
  view.label([0, 0, height], colors.momentum, "L");
  motion.axes.forEach((axis, i) => {
    const tip = put(scaled(axis, radii[i] * size + 0.12));
    view.path([put(scaled(axis, radii[i] * size)), tip], colors.axes[i], 2, { dash: DASHES[i] });
    view.label(tip, colors.axes[i], E_NAMES[i]);
  });
  view.end(colors.ground);
}

/** The turn that takes a direction to straight down. */
function toBelow(n) {
  const w = 1 - n[2];
  return w < 1e-9 ? [1, 0, 0, 0] : unit([...cross(n, [0, 0, -1]), w]);
}
