// Up to four designs side by side, differences marked.

import { focusOn, h, hidden } from "./dom.js";
import { amount, number, usedShare } from "./numbers.js";

export const MOST_PINS = 4;

/** @typedef {{label: string, kind: string, told: string[], best: boolean[] | null}} Row */

/**
 * Make the comparison.
 * @param {import("./explorer.js").Explorer} x
 */
export function compareView(x) {
  const node = h("section", { class: "tray", "aria-label": "Comparison", hidden: true });
  let every = false;
  let folded = false;

  function draw() {
    const { pins } = x.state;
    node.hidden = !pins.length;
    if (!pins.length) return;
    const head = h(
      "div",
      { class: "row" },
      h("h2", null, pins.length > 1 ? `Compare ${pins.length} designs` : "Compare"),
      h(
        "span",
        { class: "note" },
        pins.length < MOST_PINS ? "Space, or Compare in the panel, adds one; four at most." : "",
      ),
      h("span", { class: "grow" }),
      pins.length > 1
        ? h(
            "button",
            {
              type: "button",
              class: "small fold",
              "aria-expanded": String(!folded),
              onclick: () => {
                folded = !folded;
                draw();
                focusOn(node, ".fold");
              },
            },
            folded ? "Unfold" : "Fold",
          )
        : null,
      pins.length > 1 && !folded
        ? h(
            "label",
            { class: "check" },
            h("input", {
              type: "checkbox",
              checked: every,
              onchange: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ e) => {
                every = e.target.checked;
                draw();
                focusOn(node, "input");
              },
            }),
            "all rows",
          )
        : null,
      h("button", { type: "button", class: "small", onclick: () => x.unpin() }, "Close"),
    );
    if (pins.length < 2) {
      const d = x.model.record.designs[pins[0]];
      node.replaceChildren(
        head,
        h("p", { class: "note" }, `Design ${d.rank} is kept. Choose another one to see both side by side.`),
      );
      return;
    }
    if (folded) node.replaceChildren(head);
    else
      node.replaceChildren(
        head,
        h(
          "div",
          { class: "scroll", tabindex: 0, role: "region", "aria-label": "Table of compared designs" },
          table(pins),
        ),
      );
  }

  /** @param {number[]} pins */
  function table(pins) {
    const { model } = x;
    /** @type {Row[]} */
    const rows = model.columns.map((c) => ({
      label: c.label,
      kind: c.kind,
      told: pins.map((i) => (c.kind === "word" ? c.values[i] : amount(c.values[i], c.unit))),
      best: best(c, pins),
    }));
    /** @type {Row[]} */
    const used = model.record.limits
      .map((limit, k) => ({ limit, used: pins.map((i) => model.record.designs[i].used[k]) }))
      .filter((row) => row.used.some((share) => (share ?? 0) >= 0.9))
      .map((row) => ({
        label: `used of ${row.limit.label}`,
        kind: "used",
        told: row.used.map((share) => usedShare(share)),
        best: null,
      }));
    const kept = [...rows, ...used]
      .map((row) => ({ ...row, differs: new Set(row.told).size > 1 }))
      .filter((row) =>
        row.differs ? row.kind !== "derived" || every || model.derived.length < 8 : every || row.kind === "objective",
      );
    const line = (/** @type {Row & {differs: boolean}} */ row) =>
      h(
        "tr",
        { class: row.differs ? "differs" : null },
        h("th", { scope: "row" }, row.label, row.differs ? hidden(" differs") : null),
        row.told.map((text, k) =>
          h("td", null, text, row.best?.[k] ? h("span", { class: "badge good" }, "best") : null),
        ),
      );
    const button = (/** @type {number} */ i) =>
      h(
        "button",
        { type: "button", class: "link", onclick: () => x.select(i) },
        `Design ${model.record.designs[i].rank}`,
      );
    return h(
      "table",
      { class: "compare" },
      h(
        "thead",
        null,
        h(
          "tr",
          null,
          h("td"),
          pins.map((i) =>
            h(
              "th",
              { scope: "col" },
              button(i),
              model.names[i].length ? h("small", null, model.names[i].join(", ")) : null,
            ),
          ),
        ),
      ),
      h("tbody", null, kept.map(line)),
    );
  }

  /**
   * Return which of the designs are the best in a column.
   * @param {import("./record.js").Column} column
   * @param {number[]} pins
   */
  function best(column, pins) {
    const sense = x.model.record.objectives[column.key];
    if (!sense || column.kind === "word") return null;
    const values = pins.map((i) => column.values[i] ?? (sense === "min" ? Infinity : -Infinity));
    const top = (sense === "min" ? Math.min : Math.max)(...values);
    return new Set(values.map((v) => number(v))).size > 1 ? values.map((v) => v === top) : null;
  }

  return { node, draw };
}
