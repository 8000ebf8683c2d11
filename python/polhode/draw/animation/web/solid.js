// The body: triangles with a colour each, the far ones first. Few calls of the pen: those of one shade in a row are one path.

import { TINTS } from "./shared.js";
import { rotate } from "./vectors.js";

const SHADES = 24;
const BUCKETS = 2048;
const PIECES = 16; // of the size of a body: triangles are cut to that
const MOST = 2500;

export class Solid {
  /** vertices and faces as flat arrays, three numbers each; colors: red, green, blue of each face. */
  constructor(...surface) {
    const { vertices, faces, colors } = cut(...surface), count = faces.length / 3;
    Object.assign(this, { vertices, faces, count, normals: new Float32Array(3 * count), palette: [], tint: new Uint16Array(count) });
    this.seen = new Float32Array(vertices.length);
    this.depth = new Uint16Array(count); this.order = new Uint32Array(count); this.starts = new Uint32Array(BUCKETS + 1);
    this.shade = new Uint8Array(count);
    const known = new Map();
    let reach = 0;
    for (let i = 0; i < vertices.length; i += 3) reach = Math.max(reach, Math.hypot(vertices[i], vertices[i + 1], vertices[i + 2]));
    this.reach = reach || 1;
    for (let i = 0; i < count; i++) {
      const [a, b, c] = [0, 1, 2].map((k) => { const v = 3 * faces[3 * i + k]; return vertices.subarray(v, v + 3); });
      const n = [0, 1, 2].map((k) => { const p = (k + 1) % 3, r = (k + 2) % 3; return (b[p] - a[p]) * (c[r] - a[r]) - (b[r] - a[r]) * (c[p] - a[p]); });
      const size = Math.hypot(...n) || 1;
      n.forEach((x, k) => { this.normals[3 * i + k] = x / size; });
      const name = `${colors[3 * i]},${colors[3 * i + 1]},${colors[3 * i + 2]}`;
      if (!known.has(name)) { known.set(name, this.palette.length); this.palette.push(shades(colors.slice(3 * i, 3 * i + 3))); }
      this.tint[i] = known.get(name);
    }
  }

  /** Draws it at an attitude, so many times its size. */
  draw(view, q, size) {
    const { seen, vertices, faces, normals, depth, order, starts, shade, count } = this;
    const columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => rotate(q, axis));
    const [r, u, t] = [view.right, view.up, view.toward].map((d) => columns.map((c) => c[0] * d[0] + c[1] * d[1] + c[2] * d[2]));
    const s = size * view.unit, [x0, y0] = view.middle, near = BUCKETS / (6 * this.reach);
    for (let i = 0; i < vertices.length; i += 3) {
      const x = vertices[i], y = vertices[i + 1], z = vertices[i + 2];
      seen[i] = x0 + s * (x * r[0] + y * r[1] + z * r[2]);
      seen[i + 1] = y0 - s * (x * u[0] + y * u[1] + z * u[2]);
      seen[i + 2] = x * t[0] + y * t[1] + z * t[2];
    }
    starts.fill(0);
    for (let i = 0; i < count; i++) {
      const facing = normals[3 * i] * t[0] + normals[3 * i + 1] * t[1] + normals[3 * i + 2] * t[2];
      if (facing <= 0) { depth[i] = BUCKETS; continue; }
      shade[i] = facing * (SHADES - 1);
      const far = seen[3 * faces[3 * i] + 2] + seen[3 * faces[3 * i + 1] + 2] + seen[3 * faces[3 * i + 2] + 2];
      depth[i] = Math.min(BUCKETS - 1, Math.max(0, BUCKETS / 2 + far * near));
      starts[depth[i] + 1]++;
    }
    for (let k = 0; k < BUCKETS; k++) starts[k + 1] += starts[k];
    const total = starts[BUCKETS];
    for (let i = 0; i < count; i++) if (depth[i] < BUCKETS) order[starts[depth[i]]++] = i;
    const pen = view.pen;
    pen.lineWidth = 1;
    let style = "";
    for (let k = 0; k < total; k++) {
      const i = order[k], next = this.palette[this.tint[i]][shade[i]];
      if (next !== style) {
        if (style) { pen.fill(); pen.stroke(); }
        style = pen.fillStyle = pen.strokeStyle = next;
        pen.beginPath();
      }
      const a = 3 * faces[3 * i], b = 3 * faces[3 * i + 1], c = 3 * faces[3 * i + 2];
      pen.moveTo(seen[a], seen[a + 1]); pen.lineTo(seen[b], seen[b + 1]); pen.lineTo(seen[c], seen[c + 1]); pen.closePath();
    }
    if (style) { pen.fill(); pen.stroke(); }
  }
}

/** Halves long triangles, which by the depth of their middles would come in a wrong order; as far as there are few enough. */
function cut(vertices, faces, colors) {
  const low = [0, 1, 2].map((k) => least(vertices, k, 1)), high = [0, 1, 2].map((k) => -least(vertices, k, -1));
  let limit = Math.max(...high.map((x, k) => x - low[k])) / PIECES;
  for (;; limit *= 1.4) {
    const points = Array.from(vertices), pieces = [], tints = [], middles = new Map();
    const middle = (a, b) => {
      const name = a < b ? `${a} ${b}` : `${b} ${a}`;
      if (!middles.has(name)) {
        middles.set(name, points.length / 3);
        for (let k = 0; k < 3; k++) points.push((points[3 * a + k] + points[3 * b + k]) / 2);
      }
      return middles.get(name);
    };
    const far = (a, b) => Math.hypot(points[3 * a] - points[3 * b], points[3 * a + 1] - points[3 * b + 1], points[3 * a + 2] - points[3 * b + 2]);
    const most = Math.max(MOST, faces.length / 3);
    for (let i = 0; i < faces.length && pieces.length <= 3 * most; i += 3) {
      const open = [[faces[i], faces[i + 1], faces[i + 2]]];
      while (open.length && pieces.length <= 3 * most) {
        const [a, b, c] = open.pop(), sides = [far(a, b), far(b, c), far(c, a)], longest = Math.max(...sides), k = sides.indexOf(longest);
        if (longest <= limit) { pieces.push(a, b, c); tints.push(colors[i], colors[i + 1], colors[i + 2]); continue; }
        const [p, q, r] = [[a, b, c], [b, c, a], [c, a, b]][k], m = middle(p, q);
        open.push([p, m, r], [m, q, r]);
      }
    }
    if (pieces.length <= 3 * most) return { vertices: new Float32Array(points), faces: new Uint32Array(pieces), colors: new Uint8Array(tints) };
  }
}

function least(vertices, k, sign) {
  let found = Infinity;
  for (let i = k; i < vertices.length; i += 3) found = Math.min(found, sign * vertices[i]);
  return found;
}

const shades = (color) => Array.from({ length: SHADES }, (_, k) => `rgb(${Array.from(color, (part) => Math.round(part * (0.6 + 0.4 * k / (SHADES - 1)))).join(",")})`);

/** The uniform box that has these moments, along axes given as rows, its longest half side 1. */
export function boxOf(moments, axes) {
  const total = moments[0] + moments[1] + moments[2];
  const squares = moments.map((m) => Math.max(0, total - 2 * m)), longest = Math.sqrt(Math.max(...squares)) || 1;
  const half = squares.map((x) => Math.max(0.01, Math.sqrt(x) / longest));
  const vertices = [], faces = [], colors = [];
  for (let axis = 0; axis < 3; axis++) {
    for (const sense of [1, -1]) {
      const first = vertices.length / 3;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const p = [0, 0, 0];
        p[axis] = sense * half[axis]; p[(axis + 1) % 3] = sense * a * half[(axis + 1) % 3]; p[(axis + 2) % 3] = b * half[(axis + 2) % 3];
        for (let k = 0; k < 3; k++) vertices.push(axes[0][k] * p[0] + axes[1][k] * p[1] + axes[2][k] * p[2]);
      }
      faces.push(first, first + 1, first + 2, first, first + 2, first + 3);
      for (let k = 0; k < 2; k++) colors.push(...TINTS[2 * axis + (sense > 0 ? 0 : 1)]);
    }
  }
  return new Solid(new Float32Array(vertices), new Uint32Array(faces), new Uint8Array(colors));
}
