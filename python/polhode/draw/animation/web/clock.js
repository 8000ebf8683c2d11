// Time on the screen: how fast it runs beside real time, and in which words that is said.

import { PICTURES, SECONDS } from "./shared.js";

const STEPS = [1 / 100, 1 / 10, 1 / 4, 1 / 2, 1, 2, 4, 10, 100];

/** Seconds in a unit of time; null for one that is not known. */
export const secondsIn = (unit) => SECONDS[unit] ?? null;

export const plain = (x) => (x >= 1e6 ? x.toExponential(0).replace("e+", "e") : x >= 100 ? Math.round(x).toLocaleString("en") : String(Number(x.toPrecision(3))));

/** A speed in words: units of time a second on the screen. */
export function speedName(rate, unit) {
  const seconds = secondsIn(unit);
  if (seconds === null) return `${plain(rate)} ${unit} a second`;
  const factor = rate * seconds;
  if (Math.abs(factor - 1) < 1e-6) return "real time";
  return factor < 1 ? `slow motion 1/${plain(1 / factor)}` : `${plain(factor)} \u00d7 real time`;
}

/** A speed in words, and whether a body of this fastest ω would seem to turn backward at it. */
export const speedWords = (rate, unit, fastest) => `${speedName(rate, unit)}${fastest * rate / PICTURES < Math.PI ? "" : ", too fast to follow"}`;

/** The speeds that are offered, with the one that was chosen for the motion, and real time where that is not far from it. */
export function speeds(rate, unit) {
  const seconds = secondsIn(unit), offered = STEPS.slice(1, -1).map((step) => rate * step);
  if (seconds !== null && rate * seconds !== 1 && Math.abs(Math.log10(rate * seconds)) <= 3) offered.push(1 / seconds);
  const sorted = offered.sort((a, b) => a - b);
  return sorted.filter((x, i) => i === 0 || x / sorted[i - 1] > 1 + 1e-6);
}

/** A time of a motion in words, to a thousandth of its length; very long and very short ones as a power of ten. */
export function timeText(t, start, end) {
  const length = Math.abs(end - start) || Math.max(Math.abs(start), Math.abs(end)) || 1, most = Math.max(Math.abs(start), Math.abs(end)) || 1;
  const place = Math.floor(Math.log10(length)) - 3;
  if (most >= 1e-3 && (most < 1e6 || place < 0)) return t.toFixed(Math.max(0, Math.min(15, -place)));
  const power = Math.floor(Math.log10(most));
  return `${(t / 10 ** power).toFixed(Math.max(0, Math.min(15, power - place)))}e${power}`;
}

/** What the address asks for after its #: a time, a view, an embedded page. What makes no sense is left out. */
export function asked(hash, start, end) {
  const words = new URLSearchParams(hash.replace(/^#/, "")), text = words.get("t"), t = text === null || text.trim() === "" ? NaN : Number(text);
  const [low, high] = start < end ? [start, end] : [end, start];
  const view = words.get("view");
  return {
    t: Number.isFinite(t) ? Math.min(high, Math.max(low, t)) : null,
    view: ["space", "body", "poinsot"].includes(view) ? view : null,
    isEmbedded: words.has("embed"),
  };
}
