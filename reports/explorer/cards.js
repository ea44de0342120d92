// The cards that the explorer is laid out in, and its head.

import { h, localAddress } from "./dom.js";
import { saveTable } from "./files.js";
import { amount } from "./numbers.js";

const FIRST_CHIPS = 8;

/**
 * @typedef {import("./explorer.js").Explorer} Explorer
 * @typedef {import("./record.js").Asked} Asked
 * @typedef {import("./record.js").Family} Family
 */

/**
 * Return the title, what is said about the front, and a corner for the page.
 * @param {Explorer} x
 */
export function heading(x) {
  const { record } = x.model;
  const actions = h("div", { class: "actions" });
  x.options.actions?.(actions, x.handle);
  const facts =
    record.facts.length > 0 &&
    h(
      "p",
      { class: "facts" },
      record.facts.map(([label, text]) => h("span", null, `${label} `, h("b", null, text))),
    );
  const kind = record.title === record.family ? record.program : `${record.family}, ${record.program}`;
  return h(
    "header",
    { class: "head" },
    h("div", null, h("p", { class: "kind" }, kind), h("h1", null, record.title), facts),
    actions,
  );
}

/**
 * Return what was asked, and on request what was assumed.
 * @param {Explorer} x
 */
export function chips(x) {
  const { asked, assumed } = x.model.record;
  const told = (/** @type {Asked} */ entry) => entry.words ?? amount(entry.value, entry.unit);
  const before = x.other && [...x.other.record.asked, ...x.other.record.assumed];
  const chip = (/** @type {Asked} */ entry) => {
    const earlier = before?.find((other) => other.label === entry.label);
    const differs = before && (!earlier || told(earlier) !== told(entry));
    return h(
      "li",
      { class: differs ? "chip differs" : "chip", title: entry.text || null },
      `${entry.label} `,
      h("b", null, told(entry)),
      differs ? h("span", { class: "note" }, earlier ? ` in place of ${told(earlier)}` : " not asked before") : null,
    );
  };
  const row = (/** @type {Asked} */ entry) =>
    h(
      "tr",
      { title: entry.text || null },
      h("th", { scope: "row" }, entry.label),
      h("td", null, told(entry)),
    );
  const rest = [...asked.slice(FIRST_CHIPS), ...assumed];
  const more =
    rest.length > 0 &&
    h(
      "details",
      { class: "assumed" },
      h(
        "summary",
        null,
        asked.length > FIRST_CHIPS ? `${rest.length} more, stated or assumed` : `${rest.length} values assumed`,
      ),
      h("table", { class: "values" }, h("tbody", null, rest.map(row))),
    );
  return h(
    "div",
    { class: "asked" },
    h("ul", { class: "chips", "aria-label": "What was asked" }, asked.slice(0, FIRST_CHIPS).map(chip)),
    more,
  );
}

/**
 * Return the card of the scatter: axes to choose, legend, filters, a strip for what-if.
 * @param {Explorer} x
 * @param {{node: HTMLElement}} scatter
 * @param {{node: HTMLElement}} legend
 */
export function frontCard(x, scatter, legend) {
  const { model, state } = x;
  /**
   * @param {"x" | "y" | "by"} name
   * @param {string} label
   * @param {import("./record.js").Column[]} columns
   * @param {string} [none]
   */
  const choose = (name, label, columns, none) =>
    h(
      "label",
      null,
      label,
      h(
        "select",
        {
          "data-field": name,
          onchange: (/** @type {import("./elements.js").EventOf<HTMLSelectElement>} */ event) => {
            state[name] = event.target.value;
            x.cache = null;
            x.draw();
          },
        },
        none ? h("option", { value: "" }, none) : null,
        columns.map((c) => h("option", { value: c.key, selected: c.key === state[name] }, c.label)),
      ),
    );
  x.count = h("p", { class: "count", role: "status" });
  x.filters = h("div", { class: "filters" });
  return h(
    "section",
    { class: "card front", "aria-labelledby": `${x.id}-front` },
    h(
      "header",
      null,
      h("h2", { id: `${x.id}-front` }, "Front"),
      h(
        "div",
        { class: "row controls" },
        choose("x", "across", model.axes),
        choose("y", "up", model.axes),
        model.groupable.length ? choose("by", "colour", model.groupable, "none") : null,
      ),
      h("span", { class: "grow" }),
      x.count,
    ),
    scatter.node,
    legend.node,
    x.filters,
    x.strip,
  );
}

/** Return the place for fields to type ranges into. */
export const rangeFields = () => h("details", { class: "ranges" }, h("summary", null, "Ranges by number"));

/**
 * Return the card of all attributes.
 * @param {Explorer} x
 * @param {{node: HTMLElement, same: () => string[]}} parallel
 * @param {HTMLElement} fields
 */
export function parallelCard(x, parallel, fields) {
  const same = parallel.same();
  return h(
    "section",
    { class: "card parallels", "aria-labelledby": `${x.id}-all` },
    h(
      "header",
      null,
      h("h2", { id: `${x.id}-all` }, "All attributes"),
      h("p", { class: "note pointer" }, "drag along an axis to keep a range, press it to drop the range"),
    ),
    parallel.node,
    same.length ? h("p", { class: "note same" }, `The same in all: ${same.join("; ")}.`) : null,
    fields,
  );
}

/**
 * Return the card of the table.
 * @param {Explorer} x
 * @param {{node: HTMLElement, chooser: HTMLElement}} table
 */
export function tableCard(x, table) {
  return h(
    "section",
    { class: "card table", "aria-labelledby": `${x.id}-table` },
    h(
      "header",
      null,
      h("h2", { id: `${x.id}-table` }, "Designs"),
      h("p", { class: "note pointer" }, x.model.count > 1 ? "arrow keys move, space compares" : ""),
      h("span", { class: "grow" }),
      h("button", { type: "button", class: "small", onclick: () => saveTable(x) }, "CSV"),
      h("details", { class: "columns-menu" }, h("summary", { class: "button small" }, "Columns"), table.chooser),
    ),
    table.node,
  );
}

/** @type {Record<string, string>} */
const TONES = { listed: "good", beaten: "", infeasible: "bad", not_found: "bad", stopped: "open" };

/**
 * Return the card of the families that were asked the same.
 * @param {Explorer} x
 */
export function familiesCard(x) {
  const row = (/** @type {Family} */ family) => {
    const file = localAddress(family.file);
    return h(
      "tr",
      null,
      h("th", { scope: "row" }, file ? h("a", { href: file }, family.title) : family.title),
      h("td", null, h("span", { class: `badge ${TONES[family.outcome] ?? ""}` }, family.outcome)),
      h("td", { class: "words" }, family.why),
    );
  };
  const order = Object.keys(TONES);
  const rank = (/** @type {Family} */ { outcome }) => (order.includes(outcome) ? order.indexOf(outcome) : order.length);
  return h(
    "section",
    { class: "card outcomes", "aria-labelledby": `${x.id}-families` },
    h("header", null, h("h2", { id: `${x.id}-families` }, "Families"), h("p", { class: "note" }, "what became of each")),
    h(
      "table",
      null,
      h("tbody", null, [...(x.model.record.families ?? [])].sort((a, b) => rank(a) - rank(b)).map(row)),
    ),
  );
}
