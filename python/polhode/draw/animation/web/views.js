// What the two canvases show: the body in space; and its path in the body, on the surface that its kind of motion has, or an ellipsoid that rolls in space.

import { circle } from "./camera.js";
import { drawnWith } from "./surface.js";
import { DASHES, E_NAMES, colors } from "./theme.js";
import { conjugate, cross, dot, length, rotate, scaled, sum, unit } from "./vectors.js";

const BODY = 0.85;
const SPHERE = 1.05;
const PARTS = 12; // along a cut ellipsoid
const SIDES = 72;

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
  if (inside) view.arrow(scaled(rotate(q, inside), 1.15 / motion.strongest), colors.inside, "h");
  view.arrow(scaled(momentum, 1.15 / motion.strongest), colors.momentum, "L");
  view.arrow(scaled(rotate(q, omega), rate), colors.omega, "\u03c9");
  if (shown.axes) motion.axes.forEach((axis, i) => view.label(scaled(rotate(q, axis), 1.05), colors.axes[i], E_NAMES[i]));
  for (const wheel of [...wheels].reverse()) wheel.label(view, now, size, speed); // the nearest first
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

const toBody = (motion, p) => motion.axes.reduce((v, axis, i) => sum(v, scaled(axis, p[i])), [0, 0, 0]);
const angleOf = (k) => 2 * Math.PI * k / SIDES;

/** Draws a curve on a surface, what is on the far side more faintly; `put` takes its points to the view's space. */
function curveOn(view, points, isNear, put, color, width, faint, strong) {
  let run = [points[0]];
  for (let k = 1; k < points.length; k++) {
    const same = isNear(points[k]) === isNear(points[k - 1]);
    run.push(points[k]);
    if (!same || k === points.length - 1) { view.path(run.map(put), color, width, { alpha: isNear(points[k - 1]) ? strong : faint }); run = [points[k]]; }
  }
}

/** Parts of a curve along the principal axes that are not beyond a cut end. */
function withinEnds(points, end) {
  const runs = [[]];
  for (const p of points) {
    if (Math.abs(p[0]) <= end * (1 + 1e-9)) runs.at(-1).push(p);
    else if (runs.at(-1).length) runs.push([]);
  }
  return runs.filter((run) => run.length > 1);
}

/** The points of a set that are its outline as a view sees it. */
function outline(view, points) {
  const seen = points.map((p) => [...view.place(p), p]).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const side = (row) => {
    const hull = [];
    for (const p of row) {
      while (hull.length > 1) {
        const [a, b] = hull.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        hull.pop();
      }
      hull.push(p);
    }
    return hull;
  };
  return [...side(seen), ...side(seen.reverse())].map((one) => one[2]);
}

/** The ellipsoid with its rings, the separatrix and the way of ω on it; `put` takes body components to the view's space. */
function drawEllipsoid(view, motion, put, way) {
  const { ellipsoid, scale } = motion, { radii, ends } = ellipsoid;
  const turn = (p) => put(toBody(motion, p.map((x) => x * scale)));
  const toward = [0, 1, 2].map((i) => { const unit = [0, 0, 0]; unit[i] = 1; return dot(put(toBody(motion, unit)), view.toward); });
  const ring = (part) => Array.from({ length: SIDES + 1 }, (_, k) => ellipsoid.point(part, angleOf(k)));
  const parts = Array.from({ length: 2 * PARTS + 1 }, (_, k) => k / PARTS - 1);
  const edge = ellipsoid.isCut ? outline(view, parts.flatMap(ring).map(turn))
    : circle(toward.map((x, i) => x / radii[i]), 0, 1).map((u) => turn(u.map((x, i) => x * radii[i])));
  view.path(edge, colors.shade, 1.2, { fill: colors.rule, alpha: 0.35 });
  const isNear = (p) => ellipsoid.faces(p, toward);
  const lines = [-0.5, 0, 0.5, ...(ellipsoid.isCut ? [-1, 1] : [])].map(ring);
  for (const k of [0, SIDES / 4, SIDES / 2, 3 * SIDES / 4]) lines.push(parts.map((part) => ellipsoid.point(part, angleOf(k))));
  for (const line of lines) curveOn(view, line, isNear, turn, colors.shade, 0.8, 0.2, 0.7);
  for (const curve of ellipsoid.separatrix()) for (const run of withinEnds(curve, ends[0])) curveOn(view, run, isNear, turn, colors.e2, 1.4, 0.35, 1);
  if (way.length > 1) view.path(way.map((w) => put(scaled(w, scale))), colors.omega, 2.4);
}

/** The sphere of L in the body, with the steady spins and the separatrices of a gyrostat, and the way of L on it. */
function drawSphere(view, motion, way) {
  const { marks } = motion.surface, isNear = (n) => dot(n, view.toward) >= 0, put = (n) => scaled(n, SPHERE);
  view.path(circle(view.toward, 0, SPHERE), colors.shade, 1.2, { fill: colors.rule, alpha: 0.35 });
  for (const axis of motion.axes) curveOn(view, circle(axis, 0, 1), isNear, put, colors.shade, 0.8, 0.2, 0.7);
  for (const { curve, direction, circle: axis } of marks) {
    if (curve) curveOn(view, curve, isNear, put, colors.e2, 1.4, 0.35, 1);
    if (!axis) continue;
    const height = dot(direction, axis);
    curveOn(view, circle(axis, height, Math.sqrt(Math.max(0, 1 - height * height))), isNear, put, colors.ink, 1.4, 0.35, 1);
  }
  if (way.length > 1) curveOn(view, way, isNear, put, colors.momentum, 2.6, 0.4, 1);
  for (const { kind, direction } of marks) view.mark(put(direction), kind, colors.ink, isNear(direction) ? 1 : 0.4);
}

/** In the body: the path, on the surface on which it stays where there is one. */
export function drawBody(view, now, motion, shown) {
  if (!view.begin()) return;
  const drawn = drawnWith(motion.surface, motion.ellipsoid), trail = shown.traces ? motion.trail.upTo(now.since) : null;
  let ends = [0, 1, 2].map(() => 0);
  if (drawn === "ellipsoid") {
    ends = motion.ellipsoid.ends.map((x) => x * motion.scale);
    drawEllipsoid(view, motion, (v) => v, trail ? trail.body.concat([now.omega]) : []);
  } else if (drawn === "sphere") {
    ends = [SPHERE, SPHERE, SPHERE];
    drawSphere(view, motion, trail ? trail.sphere.concat([motion.onSphere(now.q)]) : []);
  } else if (trail) view.path(trail.body.concat([now.omega]).map((w) => scaled(w, motion.scale)), colors.omega, 2.4);
  motion.axes.forEach((axis, i) => {
    const tip = scaled(axis, drawn === "path" ? 1.15 : Math.min(1.35, ends[i] + 0.18));
    view.path([scaled(axis, ends[i]), tip], colors.axes[i], 2, { dash: DASHES[i] });
  });
  if (drawn === "sphere") view.arrow(scaled(motion.onSphere(now.q), SPHERE), colors.momentum, "L");
  view.arrow(scaled(now.omega, motion.scale), colors.omega, "\u03c9");
  motion.axes.forEach((axis, i) => view.label(scaled(axis, drawn === "path" ? 1.15 : Math.min(1.35, ends[i] + 0.18)), colors.axes[i], E_NAMES[i]));
  view.end(colors.ground);
}

/** Poinsot: the ellipsoid rolls, without slipping, on the invariable plane, which L is normal to and which lies below. */
export function drawPoinsot(view, now, motion, shown) {
  if (!view.begin()) return;
  const up = scaled(now.momentum, 1 / (length(now.momentum) || 1)), turn = toBelow(up);
  const put = (v) => rotate(turn, rotate(now.q, v)), { ends, longest } = motion.ellipsoid, size = motion.scale;
  const contact = put(scaled(now.omega, size)), trail = motion.trail.upTo(now.since), height = contact[2];
  const reach = 1.25 * longest * size, plane = [[1, 1], [1, -1], [-1, -1], [-1, 1], [1, 1]].map(([x, y]) => [x * reach, y * reach, height]);
  view.path(plane, colors.shade, 1, { fill: colors.rule, alpha: 0.5 });
  if (shown.traces) view.path(trail.space.map((w) => rotate(turn, scaled(w, size))).concat([contact]), colors.omega, 1.6, { alpha: 0.8 });
  drawEllipsoid(view, motion, put, shown.traces ? trail.body.concat([now.omega]) : []);
  view.path([[0, 0, 0], [0, 0, height]], colors.momentum, 1.2, { dash: [4, 4] });
  view.arrow(contact, colors.omega, "\u03c9");
  view.dot(contact, colors.omega, 5);
  view.label([0, 0, height], colors.momentum, "L");
  motion.axes.forEach((axis, i) => {
    const tip = put(scaled(axis, ends[i] * size + 0.12));
    view.path([put(scaled(axis, ends[i] * size)), tip], colors.axes[i], 2, { dash: DASHES[i] });
    view.label(tip, colors.axes[i], E_NAMES[i]);
  });
  view.end(colors.ground);
}

/** The turn that takes a direction to straight down. */
function toBelow(n) {
  const w = 1 - n[2];
  return w < 1e-9 ? [1, 0, 0, 0] : unit([...cross(n, [0, 0, -1]), w]);
}
