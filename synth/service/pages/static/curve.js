// Curves over a value that varies: points joined by lines, ticks where something changes, and where nothing fits.

import { figure, h, s, unitText, words } from "./dom.js";
import { span, ticks } from "./plot.js";

const SMALL = innerWidth < 620; // letters keep their size on a phone
const WIDE = SMALL ? 340 : 560, HIGH = SMALL ? 210 : 250, LEFT = 62, RIGHT = 18, TOP = 16, BOTTOM = 46;

/**
 * Draw curves.
 * @param {{name: string, unit: string, whole?: boolean}} across whole: ticks at whole numbers alone
 * @param {{name: string, unit: string, note?: string}} up
 * @param {{label?: string, points: [number, number | null][]}[]} series points with null are gaps
 * @param {{marks?: {value: number, text: string, ends: boolean}[], barren?: [number, number][], zero?: boolean}} [more]
 */
export function curveOf(across, up, series, { marks = [], barren = [], zero = false } = {}) {
  const all = series.flatMap(({ points }) => points), known = all.flatMap(([x, y]) => (y === null ? [] : [[x, y]]));
  const [x0, x1] = [Math.min(...all.map(([x]) => x)), Math.max(...all.map(([x]) => x))];
  const [low, high] = span(known.map(([, y]) => y).concat(zero ? [0] : []));
  const [y0, y1] = [zero && low < 0 ? 0 : low, high];
  /** @param {number} value */
  const x = (value) => LEFT + ((value - x0) / (x1 - x0 || 1)) * (WIDE - LEFT - RIGHT);
  /** @param {number} value */
  const y = (value) => HIGH - BOTTOM - ((value - y0) / (y1 - y0)) * (HIGH - TOP - BOTTOM);
  /** @param {{name: string, unit: string}} column */
  const title = ({ name, unit }) => `${words(name)}${unitText(unit) ? `, ${unitText(unit)}` : ""}`;
  /** @param {number} value */
  const inside = (value) => Math.min(x1, Math.max(x0, value));
  const bands = barren.map(([from, to]) => s("g", { class: "barren" }, s("rect", { x: x(inside(from)), width: Math.max(0, x(inside(to)) - x(inside(from))), y: TOP, height: HIGH - TOP - BOTTOM }),
    x(inside(to)) - x(inside(from)) > 90 ? s("text", { x: (x(inside(from)) + x(inside(to))) / 2, y: TOP + 18, "text-anchor": "middle" }, "nothing fits") : null));
  const lines = series.map(({ points, label }, k) => {
    let path = "", pen = "M";
    for (const [px, py] of points) {
      if (py === null) pen = "M";
      else {
        path += `${pen}${x(px).toFixed(1)} ${y(py).toFixed(1)}`;
        pen = "L";
      }
    }
    const [endX, endY] = points.findLast(([, py]) => py !== null) ?? [0, null];
    return s("g", { class: `series s${k % 6}` }, s("path", { d: path || "M0 0" }),
      points.map(([px, py]) => py === null ? null : s("circle", { cx: x(px), cy: y(py), r: 4 }, s("title", {}, `${label ? `${label}: ` : ""}${figure(px)} ${unitText(across.unit)}: ${words(up.name)} ${figure(py)} ${unitText(up.unit)}`.trim()))),
      series.length > 1 && endY !== null ? s("text", { x: x(endX) - 8, y: y(endY) - 8, "text-anchor": "end" }, label) : null);
  });
  const drawing = s("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, class: "plot curve", role: "img", "aria-label": `${title(up)} over ${title(across)}: ${known.length} points` }, bands,
    ticks(x0, x1, SMALL ? 3 : 5).filter((value) => value >= x0 && value <= x1 && (!across.whole || Number.isInteger(value))).map((value) => [s("line", { class: "grid", x1: x(value), x2: x(value), y1: TOP, y2: HIGH - BOTTOM }), s("text", { x: x(value), y: HIGH - BOTTOM + 18, "text-anchor": "middle" }, figure(value))]),
    ticks(y0, y1).filter((value) => value >= y0 && value <= y1).map((value) => [s("line", { class: "grid", x1: LEFT, x2: WIDE - RIGHT, y1: y(value), y2: y(value) }), s("text", { x: LEFT - 9, y: y(value) + 4, "text-anchor": "end" }, figure(value))]),
    marks.filter(({ value }) => value >= x0 && value <= x1).map((mark) => s("g", { class: mark.ends ? "mark ends" : "mark" }, s("title", {}, mark.text), s("line", { x1: x(mark.value), x2: x(mark.value), y1: TOP, y2: HIGH - BOTTOM }), s("path", { d: `M${(x(mark.value) - 4).toFixed(1)} ${HIGH - BOTTOM}h8l-4 -6z` }))),
    lines, s("text", { class: "axis", x: WIDE - RIGHT, y: HIGH - 8, "text-anchor": "end" }, title(across)));
  return h("figure", { class: "curved" }, h("figcaption", {}, h("b", {}, title(up)), up.note ? h("span", { class: "note" }, ` ${up.note}`) : null), drawing);
}
