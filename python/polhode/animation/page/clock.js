// Time on the screen: how fast it runs beside real time, and in which words that is said.

const SECONDS = { ns: 1e-9, "\u00b5s": 1e-6, us: 1e-6, ms: 1e-3, s: 1, min: 60, h: 3600, d: 86400, day: 86400, days: 86400, yr: 31557600 };
const STEPS = [1 / 100, 1 / 10, 1 / 4, 1 / 2, 1, 2, 4, 10, 100];

/** Seconds in a unit of time; null for one that is not known. */
export const secondsIn = (unit) => SECONDS[unit] ?? null;

const plain = (x) => (x >= 100 ? Math.round(x).toLocaleString("en") : String(Number(x.toPrecision(3))));

/** A speed in words: units of time a second on the screen. */
export function speedName(rate, unit) {
  const seconds = secondsIn(unit);
  if (seconds === null) return `${plain(rate)} ${unit} a second`;
  const factor = rate * seconds;
  if (Math.abs(factor - 1) < 1e-6) return "real time";
  return factor < 1 ? `slow motion 1/${plain(1 / factor)}` : `${plain(factor)} \u00d7 real time`;
}

/** The speeds that are offered, with the one that was chosen for the motion and real time. */
export function speeds(rate, unit) {
  const seconds = secondsIn(unit), offered = STEPS.slice(1, -1).map((step) => rate * step);
  if (seconds !== null && rate * seconds !== 1) offered.push(1 / seconds);
  const sorted = offered.sort((a, b) => a - b);
  return sorted.filter((x, i) => i === 0 || x / sorted[i - 1] > 1 + 1e-6);
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
