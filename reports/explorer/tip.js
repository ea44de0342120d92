// The words beside the pointer: made once for a front, afterwards only their letters change.

import { h, plain } from "./dom.js";
import { amount } from "./numbers.js";

const MOST_ROWS = 9;

/**
 * Make the tip.
 * @param {import("./explorer.js").Explorer} x
 */
export function tipView(x) {
  const node = h("div", { class: "tip", "aria-hidden": "true" });
  const head = document.createTextNode("");
  const limits = document.createTextNode("");
  /** @type {{column: import("./record.js").Column, text: Text}[]} */
  let rows = [];

  function draw() {
    const { model, state } = x;
    const chosen = [model.axis(state.x), model.axis(state.y)];
    const wanted = [...new Set([...model.objectives, ...chosen, ...model.sizes, ...model.words])];
    head.data = "";
    rows = wanted.slice(0, MOST_ROWS).map((column) => ({ column, text: document.createTextNode("") }));
    limits.data = "";
    node.replaceChildren(
      h("b", null, head),
      h(
        "table",
        null,
        h(
          "tbody",
          null,
          rows.map(({ column, text }) => h("tr", null, h("td", null, column.label), h("td", null, text))),
        ),
      ),
      h("p", { class: "soft" }, limits),
    );
  }

  /**
   * Show a design beside the pointer, or nothing.
   * @param {number} i
   * @param {number} [left]
   * @param {number} [top]
   */
  function show(i, left, top) {
    const d = x.model.record.designs[i];
    const on = d !== undefined && left !== undefined && top !== undefined;
    node.classList.toggle("on", on);
    if (!on) return;
    head.data = plain(`Design ${d.rank}${x.model.names[i].length ? `, ${x.model.names[i].join(", ")}` : ""}`);
    for (const { column, text } of rows)
      text.data = plain(column.kind === "word" ? column.values[i] : amount(column.values[i], column.unit));
    const reached = x.model.record.limits.filter((l) => d.at_limit.includes(l.name)).map((l) => l.label);
    limits.data = reached.length
      ? plain(`at the limit: ${reached.slice(0, 4).join(", ")}${reached.length > 4 ? " …" : ""}`)
      : "";
    const area = x.root.getBoundingClientRect();
    const [wide, high] = [node.offsetWidth, node.offsetHeight];
    const view = document.documentElement.clientWidth;
    const before = left + 18 + wide > Math.min(view, area.right);
    const px = Math.max(area.left + 4, before ? left - 18 - wide : left + 18);
    const py = Math.min(Math.max(4, top - high / 2), window.innerHeight - high - 4);
    node.style.setProperty("transform", `translate(${Math.round(px - area.left)}px, ${Math.round(py - area.top)}px)`);
  }

  return { node, draw, show };
}
