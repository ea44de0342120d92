// Up to four designs side by side, differences marked.

import { h, hidden } from "./dom.js";
import { amount, number, usedShare } from "./numbers.js";

export const MOST_PINS = 4;

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
                node.querySelector(".fold").focus();
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
              onchange: (e) => {
                every = e.target.checked;
                draw();
                node.querySelector("input").focus();
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

  function table(pins) {
    const { model } = x;
    const rows = model.columns.map((c) => ({
      label: c.label,
      kind: c.kind,
      values: pins.map((i) => c.values[i]),
      told: pins.map((i) => (c.kind === "word" ? c.values[i] : amount(c.values[i], c.unit))),
      best: best(c, pins),
    }));
    const used = model.record.limits
      .map((limit, k) => ({
        label: `used of ${limit.label}`,
        kind: "used",
        told: pins.map((i) => usedShare(model.record.designs[i].used[k])),
        hot: pins.map((i) => model.record.designs[i].used[k] >= 0.9),
      }))
      .filter((row) => row.hot.some(Boolean));
    const kept = [...rows, ...used]
      .map((row) => ({ ...row, differs: new Set(row.told).size > 1 }))
      .filter((row) =>
        row.differs ? row.kind !== "derived" || every || model.derived.length < 8 : every || row.kind === "objective",
      );
    const line = (row) =>
      h(
        "tr",
        { class: row.differs ? "differs" : null },
        h("th", { scope: "row" }, row.label, row.differs ? hidden(" differs") : null),
        row.told.map((text, k) =>
          h("td", null, text, row.best?.[k] ? h("span", { class: "badge good" }, "best") : null),
        ),
      );
    const button = (i) =>
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

  function best(column, pins) {
    const sense = x.model.record.objectives[column.key];
    if (!sense) return null;
    const values = pins.map((i) => column.values[i] ?? (sense === "min" ? Infinity : -Infinity));
    const top = (sense === "min" ? Math.min : Math.max)(...values);
    return new Set(values.map((v) => number(v))).size > 1 ? values.map((v) => v === top) : null;
  }

  return { node, draw };
}
