// Designs as points: the first objective to the right, the second upwards; what is better stands low and left.

import { figure, h, s, unitText, words } from "./dom.js";

const SMALL = innerWidth < 620; // letters keep their size on a phone
const WIDE = SMALL ? 360 : 720, HIGH = SMALL ? 300 : 360, LEFT = 70, RIGHT = 22, TOP = 18, BOTTOM = 48, TICKS = SMALL ? 4 : 5;

/**
 * Return round numbers that cover a range.
 * @param {number} low
 * @param {number} high
 */
export function ticks(low, high, most = TICKS) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough) ?? NaN; // no range, no ticks
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) found.push(Number((k * step).toPrecision(12)));
  return found;
}

/** @param {number[]} values */
export function span(values) {
  const low = Math.min(...values), high = Math.max(...values);
  const room = high > low ? 0.07 * (high - low) : Math.abs(low) * 0.1 || 1;
  return [low - room, high + room];
}

/**
 * Return a name beside a point, on the side where there is room.
 * @param {string} note
 * @param {number} x
 * @param {number} y
 */
function named(note, x, y) {
  const left = x > 0.62 * WIDE;
  return s("text", { class: "name", x: left ? x - 11 : x + 11, y: y - 8, "text-anchor": left ? "end" : "start" }, words(note));
}

/**
 * Draw designs.
 * @template {{values: number[], note?: string, rank?: number}} D
 * @param {{name: string, unit: string | null}[]} columns objectives
 * @param {D[]} designs
 * @param {{label: string, choose?: (design: D) => void}} how
 */
export function plotOf(columns, designs, { label, choose }) {
  const one = columns.length === 1;
  const first = designs.map((design) => design.values[0]), second = designs.map((design) => (one ? 0 : design.values[1]));
  const [x0, x1] = span(first), [y0, y1] = one ? [-1, 1] : span(second);
  const high = one ? 120 : HIGH;
  /** @param {number} value */
  const x = (value) => LEFT + ((value - x0) / (x1 - x0)) * (WIDE - LEFT - RIGHT);
  /** @param {number} value */
  const y = (value) => high - BOTTOM - ((value - y0) / (y1 - y0)) * (high - TOP - BOTTOM);
  /** @param {{name: string, unit: string | null}} column */
  const title = ({ name, unit }) => `${words(name)}${unitText(unit) ? ` in ${unitText(unit)}` : ""}`;
  const drawing = s("svg", { viewBox: `0 0 ${WIDE} ${high}`, class: "plot", role: choose ? "group" : "img", "aria-label": `${label}: ${designs.length} points` },
    ticks(x0, x1).map((value) => [s("line", { class: "grid", x1: x(value), x2: x(value), y1: TOP, y2: high - BOTTOM }), s("text", { x: x(value), y: high - BOTTOM + 18, "text-anchor": "middle" }, figure(value))]),
    one ? [] : ticks(y0, y1).map((value) => [s("line", { class: "grid", x1: LEFT, x2: WIDE - RIGHT, y1: y(value), y2: y(value) }), s("text", { x: LEFT - 9, y: y(value) + 4, "text-anchor": "end" }, figure(value))]),
    s("text", { class: "axis", x: (LEFT + WIDE - RIGHT) / 2, y: high - 8, "text-anchor": "middle" }, title(columns[0])),
    one ? null : s("text", { class: "axis", x: 0, y: 0, "text-anchor": "middle", transform: `translate(15 ${(TOP + high - BOTTOM) / 2}) rotate(-90)` }, title(columns[1])),
    designs.map((design) => {
      const told = `${design.rank ? `design ${design.rank}: ` : ""}${columns.map(({ name, unit }, k) => `${words(name)} ${figure(design.values[k])} ${unitText(unit)}`.trim()).join(", ")}${design.note ? `, ${words(design.note)}` : ""}`;
      const own = choose ? { tabindex: "0", role: "button", "aria-label": told, onclick: () => choose(design), onkeydown: (/** @type {KeyboardEvent} */ event) => { if (["Enter", " "].includes(event.key)) { event.preventDefault(); choose(design); } } } : {};
      const at = { class: design.note ? "point named" : "point", cx: x(design.values[0]), cy: y(one ? 0 : design.values[1]), r: design.note ? 7 : 5 };
      return s("circle", { ...at, ...own }, s("title", {}, told));
    }),
    designs.map((design) => (design.note ? named(design.note, x(design.values[0]), y(one ? 0 : design.values[1])) : null)));
  return h("figure", { class: "card" }, h("figcaption", { class: "note" }, label, columns.length > 2 ? `; ${columns.slice(2).map((column) => words(column.name)).join(", ")} not shown` : ""), drawing);
}
