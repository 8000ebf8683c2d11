// What the second view draws: the surface on which a motion keeps its path, the curves and marks on it, and the words for all of them.

import { key } from "./theme.js";
import { areThree } from "./vectors.js";

const LONGEST = 2.5; // of a semi-axis, in lengths of the longest ω: beyond that the ellipsoid is cut
const MARKS = { minimum: "\u25cf stable (least energy)", maximum: "\u25b2 stable (most energy)", saddle: "\u00d7 unstable", degenerate: "\u25c6 where some meet" };

/** The ellipsoid ω·Iω = 2T of a free body, along its principal axes; a cylinder where the least moment is zero. */
export class Ellipsoid {
  constructor(moments, along, fastest) {
    const doubled = moments.reduce((total, m, i) => total + m * along[i] * along[i], 0);
    const radii = moments.map((m) => Math.sqrt(doubled / m)), end = LONGEST * fastest;
    Object.assign(this, { moments, doubled, radii, isCut: radii[0] > end });
    this.ends = [Math.min(radii[0], end), radii[1], radii[2]];
    this.longest = Math.max(...this.ends);
    this.isSteady = [0, 1, 2].every((i) => (moments[(i + 1) % 3] - moments[i]) * along[i] * along[(i + 1) % 3] === 0);
  }

  /** How far out a point is: 1 on the surface. */
  level(p) { return this.moments.reduce((total, m, i) => total + m * p[i] * p[i], 0) / this.doubled; }

  /** A point at a part of the way along the first axis, -1 to 1, and an angle about it. */
  point(part, angle) {
    const widest = Math.asin(this.ends[0] / this.radii[0]) || 0, u = widest * part; // 0 of a cylinder
    const ring = Math.cos(u);
    return [this.ends[0] * (widest ? Math.sin(u) / Math.sin(widest) : part), this.radii[1] * ring * Math.cos(angle), this.radii[2] * ring * Math.sin(angle)];
  }

  /** Whether the surface faces a direction at a point. */
  faces(p, toward) { return this.moments.reduce((total, m, i) => total + m * p[i] * toward[i], 0) >= 0; }

  /** The two curves through the intermediate axis that part the two ways of circling; none of a symmetric body. */
  separatrix() {
    const [i1, i2, i3] = this.moments, r = Math.sqrt(i1 * (i2 - i1) / (i3 * (i3 - i2)));
    if (!areThree(this.moments) || !(r > 0 && Number.isFinite(r))) return [];
    const size = 1 / Math.hypot(1 / this.radii[0], r / this.radii[2]);
    return [1, -1].map((sign) => Array.from({ length: 145 }, (_, k) => {
      const a = k * Math.PI / 72;
      return [size * Math.cos(a), this.radii[1] * Math.sin(a), sign * r * size * Math.cos(a)];
    }));
  }
}

/** What a kind of motion is drawn with: "ellipsoid", "sphere" of L, or the "path" of ω alone. */
export function drawnWith({ kind, momentum }, ellipsoid) {
  if (kind === "free") return ellipsoid.doubled > 0 ? "ellipsoid" : "path";
  return momentum ? "sphere" : "path";
}

/** Words for what stands beside space, in the colours of the lines that they name. */
export function captionOf({ surface, ellipsoid, shows }, isRolling) {
  const omega = key("omega", "\u03c9"), L = key("momentum", "L"), drawn = drawnWith(surface, ellipsoid);
  if (drawn === "ellipsoid") {
    const name = ellipsoid.moments[0] > 0 ? "the ellipsoid of inertia" : "the cylinder that is the ellipsoid of inertia of a rod";
    const ends = ellipsoid.isCut ? ` (cut off at both ends along ${key("e1", "e\u2081")})` : "";
    const between = ellipsoid.separatrix().length ? `; ${key("e2", "thin curves")}: the separatrix` : "";
    if (isRolling) return `Poinsot: ${name}${ends} rolls on the plane that ${L} is normal to; the tip of ${omega} is where they touch${between}`;
    return `In the body: ${omega} on ${name}${ends}; ${ellipsoid.isSteady ? "its polhode is a point" : "its path is the polhode"}${between}`;
  }
  if (drawn === "sphere" && surface.kind === "gyrostat") {
    const kinds = Object.keys(MARKS).filter((kind) => surface.marks.some((mark) => mark.kind === kind)).map((kind) => MARKS[kind]);
    const between = surface.marks.some((mark) => mark.curve) ? `; ${key("e2", "thin curves")}: separatrices` : "";
    const rings = surface.marks.some((mark) => mark.circle) ? "; a ring: each of its points" : "";
    return `In the body: ${L} on the sphere of constant |L|, along a curve of constant \u00bd \u03c9\u00b7I\u03c9${surface.is_reduced ? " (I without the free wheels)" : ""}; steady spins: ${kinds.join(", ")}${rings}${between}`;
  }
  if (drawn === "sphere") return `In the body: ${L} on the sphere of constant |L|; no torque acts from outside, but the energy may change`;
  if (!shows.omega) return `In the body: \u03c9 is zero`;
  if (surface.kind === "loaded") return `In the body: ${omega} and its path; a torque may change T and |L|, so it need not stay on any ellipsoid`;
  if (surface.kind === "free") return `In the body: ${omega}, which stays where it is; T is zero, so there is no ellipsoid`;
  return `In the body: ${omega} and its path; no torque acts from outside, and L is zero`;
}
