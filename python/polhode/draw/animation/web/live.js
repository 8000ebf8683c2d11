// Another start of a free body: sliders, and the motion that follows.

import { FreeBody, separation } from "./free.js";
import { length } from "./vectors.js";

const AXES = ["e\u2081", "e\u2082", "e\u2083"];

/** What the sliders hold of a start: size of ω, its tilt from the nearest axis, the direction of the tilt, and the moments. */
export function valuesOf({ moments, omega }) {
  const size = length(omega), near = omega.map(Math.abs).indexOf(Math.max(...omega.map(Math.abs)));
  const [a, b] = [omega[(near + 1) % 3], omega[(near + 2) % 3]];
  return {
    near, sign: omega[near] < 0 ? -1 : 1, size, tilt: Math.atan2(Math.hypot(a, b), Math.abs(omega[near])) * 180 / Math.PI,
    toward: Math.atan2(b, a) * 180 / Math.PI, first: moments[0] / moments[2], second: moments[1] / moments[2], third: moments[2],
  };
}

/** The start that such values mean; moments that no body has are brought to the nearest that one may have. */
export function startOf(values) {
  const { near, sign, size, third } = values, tilt = values.tilt * Math.PI / 180, toward = values.toward * Math.PI / 180;
  const omega = [0, 0, 0];
  omega[near] = sign * size * Math.cos(tilt);
  omega[(near + 1) % 3] = size * Math.sin(tilt) * Math.cos(toward);
  omega[(near + 2) % 3] = size * Math.sin(tilt) * Math.sin(toward);
  const second = Math.min(1, Math.max(0.5, values.second)), first = Math.min(second, Math.max(1 - second, values.first, 1e-3));
  return { omega, moments: [first * third, second * third, third] };
}

/** How ω moves in the body, in words. */
export function modeOf(moments, omega) {
  const apart = separation(moments, omega);
  if (new FreeBody(moments, omega, [0, 0, 0, 1]).isSteady) return "a steady spin";
  if (Math.abs(apart) < 1e-9) return "on the separatrix";
  return apart > 0 ? `\u03c9 circles ${AXES[2]}, the axis of the greatest moment` : `\u03c9 circles ${AXES[0]}, the axis of the least moment`;
}

/** Builds the sliders; `changed` is told the start, or null for the one that was given. */
export function buildSliders(place, given, unit, button, mode, changed) {
  const first = valuesOf(given), near = AXES[first.near];
  const ranges = [
    ["size", `|\u03c9| in rad/${unit}`, first.size / 5, first.size * 5, (x) => x.toPrecision(3)],
    ["tilt", `tilt from ${near}`, 0, 90, (x) => `${x.toFixed(1)}\u00b0`],
    ["toward", `around ${near} from ${AXES[(first.near + 1) % 3]}`, -180, 180, (x) => `${x.toFixed(0)}\u00b0`],
    ["first", "I\u2081/I\u2083", 0.001, 1, (x) => x.toFixed(3)],
    ["second", "I\u2082/I\u2083", 0.5, 1, (x) => x.toFixed(3)],
  ];
  let values = { ...first };
  const rows = ranges.map(([name, word, low, high, text]) => {
    const label = document.createElement("label"), input = document.createElement("input"), output = document.createElement("output");
    Object.assign(input, { type: "range", min: low, max: high, step: "any", id: `start-${name}` });
    label.htmlFor = output.htmlFor = input.id; label.textContent = word;
    place.append(label, input, output);
    input.addEventListener("input", () => {
      values[name] = Number(input.value);
      const start = startOf(values);
      values = { ...values, first: start.moments[0] / values.third, second: start.moments[1] / values.third };
      show(start);
      button.disabled = false;
      changed(start);
    });
    return { name, input, output, text };
  });
  function show({ moments, omega }) {
    for (const { name, input, output, text } of rows) { input.value = values[name]; output.textContent = text(values[name]); }
    mode.textContent = modeOf(moments, omega);
  }
  button.addEventListener("click", () => { values = { ...first }; show(given); button.disabled = true; changed(null); });
  show(given);
}
