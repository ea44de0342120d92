// What a study has found along a track: where nothing fits, and where other parts are best.

import { figure, h, s, unitText, words } from "./dom.js";

const LETTER = 6.4; // pixels
const APART = 10; // pixels between two labels

/**
 * @typedef {object} Mark
 * @property {number} value
 * @property {string} objective that has another best design there; empty where it ends
 * @property {boolean} ends whether nothing fits on one of its sides
 * @property {string} label
 * @property {string} text
 */

/**
 * Return what is worth a tick.
 * @param {import("./records.js").Study} study of one thing that varies
 * @returns {{marks: Mark[], barren: [number, number][]}}
 */
export function marksOf(study) {
  const { unit } = study.varied[0];
  /** @param {number} value */
  const told = (value) => `${figure(value)} ${unitText(unit)}`.trim();
  const seen = new Set();
  /** @type {Mark[]} */
  const marks = [];
  /** @type {[number, number][]} */
  const barren = [];
  for (const found of study.breaks) {
    const ends = found.kind === "feasible";
    const here = told(found.value);
    const label = ends ? `fits ${found.before ? "up to" : "from"} ${here}` : figure(found.value);
    if (ends && seen.has(Boolean(found.before))) continue; // one objective after the other tells it
    if (ends) seen.add(Boolean(found.before));
    const what = words(found.change).replaceAll("->", "→");
    const text = ends ? `It ${label}: ${found.before ? "beyond" : "below"} nothing meets all limits` : `From ${here} on the ${study.objectives[found.objective] === "max" ? "largest" : "smallest"} ${words(found.objective)} has ${what}`;
    marks.push({ value: found.value, objective: ends ? "" : found.objective, ends, label, text: found.proven ? text : `${text} (not proven)` });
  }
  /** @type {[value: number, fits: boolean][]} */
  const steps = study.steps.map((step) => [Number(step.values[0]), Boolean(step.front?.designs.length)]);
  steps.sort((a, b) => a[0] - b[0]);
  /**
   * @param {number} a
   * @param {number} b
   */
  const edge = (a, b) => marks.find((mark) => mark.ends && mark.value >= a && mark.value <= b)?.value ?? (a + b) / 2;
  let from = -Infinity; // where nothing fits
  for (let k = 1; k < steps.length; k += 1) {
    if (steps[k - 1][1] === steps[k][1]) continue;
    const at = edge(steps[k - 1][0], steps[k][0]);
    if (steps[k][1]) barren.push([from, at]);
    else from = at;
  }
  if (steps.length && !steps.at(-1)?.[1]) barren.push([from, Infinity]);
  if (!steps.some(([, fits]) => fits)) return { marks, barren: steps.length ? [[-Infinity, Infinity]] : [] };
  return { marks: marks.sort((a, b) => a.value - b.value), barren };
}

/**
 * Draw what was found below a slider.
 * @param {SVGSVGElement} drawing
 * @param {(number | null)[]} values along the track
 * @param {ReturnType<typeof marksOf>} found
 */
export function drawTrack(drawing, values, { marks, barren }) {
  const known = values.filter((value) => value !== null);
  const first = values[0] === null ? 1 : 0;
  /** @param {number} value */
  const share = (value) => {
    const k = known.findIndex((other) => other >= value);
    const at = k < 0 ? known.length - 1 : k === 0 ? 0 : k - (known[k] - value) / (known[k] - known[k - 1]);
    return (at + first) / Math.max(1, values.length - 1);
  };
  const wide = drawing.clientWidth || 300;
  const end = known.at(-1) ?? Infinity;
  /** @param {number} value */
  const inside = (value) => value >= known[0] && value <= end;
  const bars = barren.map(([from, to]) => {
    const [a, b] = [share(Math.max(from, known[0])), share(Math.min(to, end))];
    return b > a ? s("rect", { class: "barren", x: `${100 * a}%`, width: `${100 * (b - a)}%`, y: 0, height: 4, rx: 2 }) : null;
  });
  /** @type {[left: number, right: number][]} */
  const taken = [];
  const order = [...marks].filter((mark) => inside(mark.value)).sort((a, b) => Number(b.ends) - Number(a.ends));
  const nodes = order.map((mark) => {
    const x = share(mark.value), width = LETTER * mark.label.length;
    const left = Math.min(Math.max(0, x * wide - width / 2), wide - width);
    const free = taken.every(([a, b]) => left + width + APART < a || left > b + APART);
    if (free) taken.push([left, left + width]);
    return s("g", { class: mark.ends ? "ends" : "" }, s("title", {}, mark.text), s("line", { x1: `${100 * x}%`, x2: `${100 * x}%`, y1: 0, y2: 9 }),
      free ? s("text", { x: left + width / 2, y: 22, "text-anchor": "middle" }, mark.label) : null);
  });
  drawing.replaceChildren(...bars.filter((bar) => bar !== null), ...nodes);
}

/**
 * Return the same for whoever does not see it.
 * @param {Mark[]} marks
 */
export const markList = (marks) => h("ul", {}, marks.map((mark) => h("li", {}, mark.text)));
