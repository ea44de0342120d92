// What a change of a requirement or limit costs in the objectives of a design.

import { h, s } from "./dom.js";
import { amount, signed } from "./numbers.js";

/**
 * @typedef {import("./explorer.js").Explorer} Explorer
 * @typedef {import("./record.js").Design} Design
 */

const changed = (/** @type {number} */ value, /** @type {string} */ unit) =>
  `${value < 0 ? "−" : "+"}${amount(Math.abs(value), unit, 2)}`;

/**
 * Return what tells how much 1 % of a requirement or limit is; nothing of what has no unit.
 * @param {Explorer} x
 * @param {Design} d
 */
function stepsOf(x, d) {
  const { record } = x.model;
  /** @type {Map<string, {value?: number | null, unit: string}>} */
  const known = new Map(record.limits.map((limit, k) => [limit.label, { value: d.sides[k][1], unit: limit.unit }]));
  for (const row of [...record.asked, ...record.assumed]) known.set(row.label, row);
  return (/** @type {string} */ name) => {
    const { value, unit } = known.get(name) ?? {};
    return typeof value === "number" && value && unit ? changed(Math.abs(value) / 100, unit) : "";
  };
}

/**
 * Return a title and what is told below it; null where nothing is known.
 * @param {Explorer} x
 * @param {Design} d
 * @returns {[title: string, ...nodes: HTMLElement[]] | null}
 */
export function pricesOf(x, d) {
  if (d.prices)
    return [
      "What a change costs",
      h(
        "ul",
        { class: "remarks" },
        d.prices.slice(0, 12).map((text) => h("li", null, text)),
      ),
    ];
  if (!d.slopes) return null;
  const { objectives } = x.model;
  const most = Math.max(...d.slopes.flatMap(([, row]) => row.map((v) => Math.abs(v ?? 0))));
  const step = stepsOf(x, d);
  const cell = (/** @type {number | null} */ v, /** @type {number} */ k) => {
    if (v === null || Math.abs(v) < 1e-3) return h("td", { class: "soft" }, "–");
    const { key, unit, values } = objectives[k];
    const value = values[x.state.selected];
    const worse = v > 0 === (x.model.record.objectives[key] === "min");
    const width = Math.max(1.5, (34 * Math.abs(v)) / most);
    return h(
      "td",
      null,
      s(
        "svg",
        {
          class: `slope ${worse ? "worse" : "gain"}`,
          width: 36,
          height: 8,
          viewBox: "0 0 36 8",
          "aria-hidden": "true",
        },
        s("rect", { x: (35 - width).toFixed(1), y: 0, width: width.toFixed(1), height: 8, rx: 1 }),
      ),
      h("span", null, `${signed(v, 2)}\u00a0%`),
      value === null || !unit ? null : h("small", { class: "soft" }, changed((v * value) / 100, unit)),
    );
  };
  const table = h(
    "table",
    { class: "prices" },
    h(
      "thead",
      null,
      h(
        "tr",
        null,
        h("td"),
        objectives.map((c) => h("th", { scope: "col" }, c.label)),
      ),
    ),
    h(
      "tbody",
      null,
      d.slopes.map(([name, row]) => {
        const told = step(name) ? h("small", { class: "soft" }, step(name)) : null;
        return h("tr", null, h("th", { scope: "row" }, name, told), row.map(cell));
      }),
    ),
  );
  return ["What 1 % more changes", table, h("p", { class: "note" }, "Slopes with these parts, good for a few per cent.")];
}
