// The page: what it was given, what it shows now, and what its controls do.

import { Camera } from "./camera.js";
import { asked, speedWords, speeds, timeText } from "./clock.js";
import { energyRows } from "./energy.js";
import { Frames, numbers } from "./frames.js";
import { FreeBody, quaternionOf } from "./free.js";
import { buildSliders } from "./live.js";
import { Ground, captionsOf, drawOnBody, drawOnGround } from "./ground.js";
import { Solid, boxOf } from "./solid.js";
import { Ellipsoid, captionOf, drawnWith } from "./surface.js";
import { colors, key, readColors } from "./theme.js";
import { Trail } from "./trail.js";
import { areThree, conjugate, dot, length, rotate, scaled, sum, times } from "./vectors.js";
import { drawBody, drawPoinsot, drawSpace } from "./views.js";
import { Wheel, slowed } from "./wheels.js";

const PATHS = { steady: "at rest", regular: "a circle", cusp: "with cusps", loop: "with loops", wave: "in waves", crossing: "through the vertical", planar: "in a plane", asymptotic: "asymptotic to the vertical" }; // of a top's axis
const element = (id) => document.getElementById(id);
const given = JSON.parse(element("motion").textContent);
const unpack = (text, Kind) => (text === null ? null : numbers(text, Kind));
const rowsOf = (array) => Array.from({ length: array.length / 3 }, (_, k) => Array.from(array.subarray(3 * k, 3 * k + 3)));
const inUnits = (array, unit) => (array === null || unit === 1 ? array : Float64Array.from(array, (x) => x * unit));
const frames = new Frames(unpack(given.t, Float64Array), unpack(given.quaternion, Float32Array), inUnits(unpack(given.omega, Float32Array), given.omega_unit), inUnits(unpack(given.inside, Float32Array), given.inside_unit));
const solid = new Solid(unpack(given.vertices, Float32Array), unpack(given.faces, Uint32Array), unpack(given.colors, Uint8Array));
const start = frames.t[0], end = frames.t[frames.count - 1], span = end - start;
const toBodyAxes = quaternionOf(given.axes);
if (given.free) given.free.attitude = times(given.free.quaternion, toBodyAxes);
const wanted = asked(location.hash, start, end);

// The motion that is shown: the given one, or that of another start.
const surface = { ...given.surface, marks: given.surface.marks.map((mark) => ({ ...mark, curve: mark.curve && rowsOf(unpack(mark.curve, Float32Array)) })) };
const toward = surface.momentum && scaled(surface.momentum, 1 / length(surface.momentum));
const conserved = surface.kind === "torque-free" ? surface.momentum ?? [0, 0, 0] : surface.momentum; // L in space, in all digits
const floor = given.ground && new Ground({ ...given.ground, center: unpack(given.ground.center, Float64Array), contact: unpack(given.ground.contact, Float64Array), friction: unpack(given.ground.friction, Float32Array) }, frames);
const motion = { axes: given.axes, top: given.top, ground: floor, surface, onSphere: (q) => rotate(conjugate(q), toward), wheels: given.wheels.map((one) => new Wheel({ ...one, rate: unpack(one.rate, Float32Array), angle: unpack(one.angle, Float64Array) }, frames)) };
const energy = { ...given.energy, kinetic: unpack(given.energy.kinetic, Float64Array), potential: unpack(given.energy.potential, Float64Array) };
function follow(another) {
  const begin = another ?? given.free, body = begin && new FreeBody(begin.moments, begin.omega, given.free.attitude);
  const closed = (since) => {
    const { omega, attitude } = body.at(since);
    return { q: times(attitude, conjugate(toBodyAxes)), omega: rotate(toBodyAxes, omega), inside: null };
  };
  const stateAt = body ? closed : (since) => frames.at(start + since);
  motion.moments = begin ? begin.moments : given.moments;
  const isOther = another && another.moments.some((m, i) => Math.abs(m / given.free.moments[i] - 1) > 1e-9);
  motion.solid = isOther ? boxOf(another.moments, given.axes) : solid;
  motion.body = body;
  const samples = another ? Array.from({ length: 48 }, (_, k) => closed(Math.min(2 * body.halfPeriod, Math.abs(span) || 1) * k / 48))
    : Array.from({ length: frames.count }, (_, k) => ({ omega: frames.row(frames.omega, k, 3), inside: frames.inside && frames.row(frames.inside, k, 3) }));
  const along = (w) => given.axes.map((axis) => dot(axis, w));
  const spin = (w) => along(w).reduce((v, x, i) => sum(v, given.axes[i].map((a) => a * x * motion.moments[i])), [0, 0, 0]);
  const momentum = ({ omega, inside }) => sum(spin(omega), inside ?? [0, 0, 0]);
  const most = (values) => values.reduce((a, b) => Math.max(a, b), 0) || 1;
  motion.fastest = most(samples.map(({ omega }) => length(omega)));
  const sizes = samples.map((s) => [length(s.omega), length(conserved ?? momentum(s)), s.inside ? length(s.inside) : 0]);
  motion.strongest = most(sizes.map(([, total, inside]) => Math.max(total, inside)));
  const [omega, total, inside] = [0, 1, 2].map((k) => sizes.some((one) => one[k] > 0));
  motion.shows = { omega, momentum: total, inside };
  motion.ellipsoid = new Ellipsoid(motion.moments, along(samples[0].omega), motion.fastest);
  const widest = { ellipsoid: () => motion.ellipsoid.longest, sphere: () => 1.4 * motion.fastest, path: () => motion.fastest };
  motion.scale = 1.05 / (widest[drawnWith(surface, motion.ellipsoid)]() || 1);
  const apart = body || frames.count < 2 ? Infinity : Math.abs(span) / (frames.count - 1); // else the way would be coarser than what is known
  motion.trail = new Trail(stateAt, motion.fastest, span, { axis: given.top && given.top.axis, onSphere: toward && motion.onSphere, apart, placeAt: floor && ((since, q) => floor.at(start + since, q)) });
  motion.at = (t) => {
    const state = stateAt(t - start);
    return { ...state, t, since: t - start, place: floor && floor.at(t, state.q), along: along(state.omega), momentum: conserved ?? rotate(state.q, momentum(state)) };
  };
}

readColors();
follow(null);
let now = wanted.t ?? start, playing = wanted.t === null && !matchMedia("(prefers-reduced-motion: reduce)").matches, last = null, waiting = false;
const rolls = () => surface.kind === "free" && motion.moments[0] > 0 && motion.ellipsoid.doubled > 0;
let second = wanted.view === "poinsot" && rolls() ? "poinsot" : "body", view = wanted.view ?? "space";
const views = { space: new Camera(element("space"), 0.9, 0.35, later), second: new Camera(element("second"), 0.9, 0.4, later) };
if (given.top) { views.space.center = given.top.down.map((x) => -0.3 * x); views.space.reach = 1.35; }
if (floor) { // from above the plane; in the body from where it touches
  const outward = Array.from({ length: frames.count }, (_, k) => -rotate(conjugate(frames.row(frames.quaternion, k, 4)), floor.normal)[2]);
  views.space.home[1] = 0.5;
  views.second.home[1] = outward.reduce((a, b) => a + b, 0) < -0.2 * frames.count ? -0.4 : 0.4;
  for (const one of Object.values(views)) one.reset();
}
const rate = (Math.abs(span) || 1) / given.duration;
let speed = rate;

/** The numbers of a state: the energy, |L|, |ω| and when the body turns over next; those of the nearest frame where no more is known. */
function readouts(now) {
  const state = motion.body ? now : motion.at(frames.t[frames.nearest(now.t)]);
  const kinetic = 0.5 * state.along.reduce((total, w, i) => total + motion.moments[i] * w * w, 0);
  const rows = energyRows(energy, motion.body ? null : frames.nearest(now.t), kinetic);
  rows.push(["|L|", length(state.momentum).toPrecision(6)], ["|\u03c9|", `${length(state.omega).toPrecision(5)} rad/${given.time_unit}`]);
  if (motion.body && span >= 0 && areThree(motion.moments)) { // else there is no intermediate axis
    const flip = motion.body.turnsOver ? motion.body.nextFlip(state.since) : Infinity;
    rows.push(["next flip", Number.isFinite(flip) ? `in ${flip.toPrecision(4)} ${given.time_unit}` : "never"]);
  }
  if (floor) rows.push(["friction needed", now.place.touches ? floor.friction[frames.nearest(now.t)].toPrecision(3) : "none, in flight"]);
  for (const wheel of motion.wheels) rows.push([wheel.name, wheel.words(now.t, given.time_unit, speed)]);
  return rows;
}
const clockText = (t) => `${timeText(t, start, end)} ${given.time_unit}`;
const cells = new Map();

function draw() {
  const state = motion.at(now), shown = { traces: element("traces").checked, axes: element("axes").checked };
  (floor ? drawOnGround : drawSpace)(views.space, state, motion, shown, speed);
  (floor ? drawOnBody : second === "poinsot" ? drawPoinsot : drawBody)(views.second, state, motion, shown);
  element("slider").value = span ? (now - start) / span : 0;
  element("slider").setAttribute("aria-valuetext", clockText(now));
  element("clock").textContent = `t = ${clockText(now)}`;
  for (const [name, text] of readouts(state)) {
    if (!cells.has(name)) {
      const row = document.createElement("div"), term = document.createElement("dt"), cell = document.createElement("dd");
      term.textContent = name; row.append(term, cell); element("readouts").append(row); cells.set(name, cell);
    }
    cells.get(name).textContent = text;
  }
}
function later() {
  if (waiting || playing) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}
function tick(clock) {
  if (playing) {
    if (last !== null && span) {
      now += Math.sign(span) * speed * Math.min(0.25, (clock - last) / 1000);
      if ((now - end) * span > 0) now = start;
    }
    draw();
    requestAnimationFrame(tick);
  }
  last = playing ? clock : null;
}
function play(on) {
  const was = playing;
  playing = on; element("play").textContent = on ? "Pause" : "Play";
  if (on && !was) requestAnimationFrame(tick);
}
function show(t) { play(false); now = t; draw(); }

/** Chooses what is seen: on a narrow screen one view, on a wide one what stands beside space. */
function choose(name) {
  view = name === "poinsot" && !rolls() ? "body" : name;
  if (view !== "space") second = view;
  document.body.dataset.view = view;
  for (const button of element("tabs").children) button.setAttribute("aria-pressed", String(button.dataset.view === (matchMedia("(max-width: 640px)").matches ? view : second)));
  describe();
  for (const one of Object.values(views)) one.fit();
  draw();
}
/** Says in words what both views show; what is drawn can change with another start. */
function describe() {
  const { omega, momentum, inside } = motion.shows;
  const arrows = [...(omega ? [key("omega", "\u03c9")] : []), ...(momentum ? [key("momentum", "L")] : [])];
  const carried = inside ? ` (with ${key("inside", "h")}, which the body carries along)` : "", still = arrows.length ? "" : " at rest";
  const path = given.top ? `, and the path of its axis${given.top.path ? ` (${PATHS[given.top.path] ?? given.top.path})` : ""}` : "";
  const discs = motion.wheels.length ? `; ${key("inside", "discs")}: its wheels, not to scale, turning relative to it` : "";
  element("space-caption").innerHTML = `In space: ${["the body", ...arrows].join(", ")}${still}${carried}${path}${discs}`;
  element("second-caption").innerHTML = captionOf(motion, second === "poinsot");
  if (floor) ["space", "second"].forEach((name, i) => { element(`${name}-caption`).innerHTML = captionsOf(floor, motion.shows)[i]; });
  for (const name of ["space", "second"]) element(name).setAttribute("aria-label", `${element(`${name}-caption`).textContent}. Arrow keys turn the view, plus and minus bring it nearer.`);
}

document.title = element("title").textContent = given.title;
document.body.classList.toggle("is-embedded", wanted.isEmbedded);
for (const one of speeds(rate, given.time_unit)) element("speed").append(new Option(speedWords(one, given.time_unit, motion.fastest), String(one), false, one === rate));
element("speed").addEventListener("change", (event) => { speed = Number(event.target.value); });
element("play").addEventListener("click", () => play(!playing));
element("slider").addEventListener("input", (event) => show(start + span * event.target.value));
element("reset").addEventListener("click", () => { for (const one of Object.values(views)) one.reset(); later(); });
element("full").addEventListener("click", () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.()));
element("full").hidden = !document.fullscreenEnabled;
for (const id of ["traces", "axes"]) element(id).addEventListener("change", later);
for (const button of element("tabs").children) button.addEventListener("click", () => choose(button.dataset.view));
element("tabs").lastElementChild.hidden = !rolls();
document.addEventListener("keydown", (event) => {
  if (event.key !== " " || event.target.closest("button, input, select, textarea, summary")) return;
  event.preventDefault();
  play(!playing);
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readColors(); later(); });
addEventListener("hashchange", () => { const word = asked(location.hash, start, end); if (word.t !== null) show(word.t); if (word.view) choose(word.view); });
element("share").hidden = location.protocol === "about:"; // in a notebook there is no file
const file = decodeURIComponent(location.pathname.split("/").pop() || "motion.html").replace(/["&<>]/g, "");
element("frame").value = `<iframe src="${file}#embed" title="${given.title.replace(/["&<>]/g, "")}" width="640" height="420" loading="lazy" allowfullscreen style="border:0"></iframe>`;
element("copy").addEventListener("click", () => { element("frame").select(); navigator.clipboard?.writeText(element("frame").value).catch(() => document.execCommand("copy")); });
if (given.free) {
  element("live").hidden = false;
  buildSliders(element("sliders"), given.free, given.time_unit, element("given"), element("mode"), (begin) => { follow(begin); describe(); draw(); });
}
play(playing);
choose(view);
if (playing) requestAnimationFrame(tick);
globalThis.polhode = { Ellipsoid, FreeBody, captionOf, drawnWith, slowed, frames, motion, views, show, play, draw, colors, stateAt: (t) => motion.at(t), get now() { return now; }, get playing() { return playing; } };
