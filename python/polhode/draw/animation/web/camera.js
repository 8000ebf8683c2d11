// A view: an orthographic camera that turns with pointers and keys, and the pen that draws in it.

import { placed, shortened } from "./labels.js";
import { dot, scaled, sum, length } from "./vectors.js";

const NAME_PART = 0.4; // of the width of a view, that a name takes at most

export class Camera {
  constructor(canvas, azimuth, elevation, redraw) {
    Object.assign(this, { canvas, redraw, home: [azimuth, elevation], center: [0, 0, 0], reach: 1.35, pen: canvas.getContext("2d"), names: [] });
    this.reset();
    this.fingers = new Map();
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); this.fingers.set(event.pointerId, [event.clientX, event.clientY]); });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.fingers.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    canvas.addEventListener("keydown", (event) => this.pressed(event));
    canvas.addEventListener("wheel", (event) => { // with Ctrl, as for pages: else it scrolls
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.nearer(Math.exp(-event.deltaY * 0.005));
    }, { passive: false });
    new ResizeObserver(() => { this.fit(); redraw(); }).observe(canvas);
    this.fit();
  }
  reset() { [this.azimuth, this.elevation] = this.home; this.zoom = 1; }
  fit() {
    const box = this.canvas.getBoundingClientRect(), ratio = Math.min(3, globalThis.devicePixelRatio || 1);
    Object.assign(this, { width: box.width, height: box.height, ratio });
    this.canvas.width = Math.round(box.width * ratio); this.canvas.height = Math.round(box.height * ratio);
  }
  moved(event) {
    const held = this.fingers.get(event.pointerId);
    if (!held) return;
    const now = [event.clientX, event.clientY];
    if (this.fingers.size === 2) { // two fingers: nearer as they part, and up and down with both
      const other = [...this.fingers].find(([id]) => id !== event.pointerId)[1];
      const [before, after] = [held, now].map((p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1);
      this.fingers.set(event.pointerId, now);
      this.turn(0, (now[1] - held[1]) * 0.005);
      this.nearer(after / before);
      return;
    }
    this.fingers.set(event.pointerId, now);
    const scrolls = event.pointerType === "touch"; // up and down, the page does
    this.turn((now[0] - held[0]) * 0.01, scrolls ? 0 : (now[1] - held[1]) * 0.01);
  }
  turn(across, up) {
    this.azimuth -= across;
    this.elevation = Math.min(1.55, Math.max(-1.55, this.elevation + up));
    this.redraw();
  }
  nearer(factor) { this.zoom = Math.min(8, Math.max(0.3, this.zoom * factor)); this.redraw(); }
  pressed(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (turns) this.turn(...turns);
    else if (event.key === "+" || event.key === "=") this.nearer(1.15);
    else if (event.key === "-") this.nearer(1 / 1.15);
    else if (event.key === "0" || event.key === "Home") { this.reset(); this.redraw(); } else return;
    event.preventDefault();
  }
  /** Begins a drawing; false where nothing is to be seen. */
  begin() {
    if (!(this.width > 0 && this.height > 0)) return false;
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    this.right = [-sa, ca, 0]; this.up = [-se * ca, -se * sa, ce]; this.toward = [ce * ca, ce * sa, se];
    this.unit = Math.min(this.width, this.height) / 2 / this.reach * this.zoom;
    this.pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    this.pen.clearRect(0, 0, this.width, this.height);
    this.pen.lineJoin = this.pen.lineCap = "round";
    this.names = [];
    this.middle = [this.width / 2 - this.unit * dot(this.center, this.right), this.height / 2 + this.unit * dot(this.center, this.up)];
    return true;
  }
  place(v) { return [this.middle[0] + this.unit * dot(v, this.right), this.middle[1] - this.unit * dot(v, this.up)]; }
  path(points, color, width, { alpha = 1, dash = [], fill = null } = {}) {
    const pen = this.pen;
    pen.globalAlpha = alpha; pen.strokeStyle = color; pen.lineWidth = width; pen.setLineDash(dash); pen.beginPath();
    points.forEach((point, i) => { const [x, y] = this.place(point); if (i) pen.lineTo(x, y); else pen.moveTo(x, y); });
    if (fill) { pen.fillStyle = fill; pen.fill(); }
    if (width) pen.stroke();
    pen.setLineDash([]); pen.globalAlpha = 1;
  }
  dot(at, color, radius = 4) {
    const [x, y] = this.place(at);
    this.pen.fillStyle = color; this.pen.beginPath(); this.pen.arc(x, y, radius, 0, 2 * Math.PI); this.pen.fill();
  }
  /** A mark of a kind of equilibrium, by its form: a disc, a triangle, a cross or a diamond. */
  mark(at, kind, color, alpha) {
    const pen = this.pen, [x, y] = this.place(at), r = 5.5;
    pen.globalAlpha = alpha; pen.fillStyle = pen.strokeStyle = color; pen.lineWidth = 2.2; pen.beginPath();
    if (kind === "minimum") pen.arc(x, y, 4.5, 0, 2 * Math.PI);
    else if (kind === "saddle") { pen.moveTo(x - r, y - r); pen.lineTo(x + r, y + r); pen.moveTo(x - r, y + r); pen.lineTo(x + r, y - r); }
    else if (kind === "maximum") { pen.moveTo(x, y - r); pen.lineTo(x + r, y + r); pen.lineTo(x - r, y + r); }
    else { pen.moveTo(x, y - r); pen.lineTo(x + r, y); pen.lineTo(x, y + r); pen.lineTo(x - r, y); }
    if (kind === "saddle") pen.stroke(); else pen.fill();
    pen.globalAlpha = 1;
  }
  arrow(tip, color, name, from = [0, 0, 0]) {
    const pen = this.pen, [x0, y0] = this.place(from), [x, y] = this.place(tip), size = Math.hypot(x - x0, y - y0);
    this.path([from, tip], color, 2.6);
    if (size > 8) {
      const [ux, uy] = [(x - x0) / size, (y - y0) / size];
      pen.fillStyle = color; pen.beginPath(); pen.moveTo(x + 4 * ux, y + 4 * uy);
      pen.lineTo(x - 8 * ux - 5 * uy, y - 8 * uy + 5 * ux); pen.lineTo(x - 8 * ux + 5 * uy, y - 8 * uy - 5 * ux); pen.fill();
    }
    if (size > 0) this.label(tip, color, name, from); // a zero vector has no direction to name
  }
  /** A name beyond a tip, or a shorter one where there is less room; those that are asked for first keep their place. */
  label(at, color, name, from = [0, 0, 0], shorter = name) {
    const [x, y] = this.place(at), [x0, y0] = this.place(from), size = Math.hypot(x - x0, y - y0) || 1;
    this.names.push({ x, y, ux: (x - x0) / size, uy: (y - y0) / size, size, color, texts: [name, shorter] });
  }
  /** Writes the names, none over another; one without room is left out. */
  end(ground) {
    const pen = this.pen;
    pen.font = "600 16px system-ui, sans-serif"; pen.textAlign = "center"; pen.textBaseline = "middle";
    pen.strokeStyle = ground; pen.lineWidth = 4;
    const widthOf = (text) => pen.measureText(text).width;
    const most = NAME_PART * this.width, choices = ([name, shorter]) => [name, shorter, shortened(shorter, most, widthOf)].map((text) => ({ name: text, width: widthOf(text) })).filter(({ width }) => width <= most);
    this.written = placed(this.names.map((one) => ({ ...one, choices: choices(one.texts) })), this.width, this.height);
    for (const { at, color, name } of this.written) {
      pen.globalAlpha = 0.75; pen.strokeText(name, ...at); pen.globalAlpha = 1;
      pen.fillStyle = color; pen.fillText(name, ...at);
    }
  }
}

/** A circle about the origin: points at a distance along a direction, of a radius. */
export function circle(direction, height, radius, count = 72) {
  const size = length(direction), n = scaled(direction, 1 / size), k = n.map(Math.abs).indexOf(Math.min(...n.map(Math.abs)));
  const other = [0, 0, 0]; other[k] = 1;
  const u0 = sum(other, scaled(n, -n[k])), u = scaled(u0, 1 / length(u0));
  const v = [n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]];
  return Array.from({ length: count + 1 }, (_, i) => {
    const a = 2 * Math.PI * i / count;
    return n.map((x, j) => height * x + radius * (Math.cos(a) * u[j] + Math.sin(a) * v[j]));
  });
}
