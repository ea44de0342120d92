// The legend: which colour and shape is what; press an entry to hide it.

import { h, s } from "./dom.js";
import { glyph, shape } from "./marks.js";

/**
 * Make the legend.
 * @param {import("./explorer.js").Explorer} x
 */
export function legendView(x) {
  const node = h("div", { class: "legend" });
  /** @type {HTMLButtonElement[]} */
  let buttons = [];

  function draw() {
    const group = x.group();
    const column = x.model.column(x.state.by);
    buttons = group.names.map((name, k) =>
      h("button", { type: "button", "aria-pressed": "true", onclick: () => x.toggle(k) }, glyph(k, group.rest), name),
    );
    const title = column && buttons.length > 0 && h("span", { class: "soft" }, column.label);
    const ghost =
      x.ghosts.length > 0 &&
      h(
        "span",
        { class: "soft" },
        s(
          "svg",
          { class: "glyph", width: 14, height: 14, viewBox: "-7 -7 14 14", "aria-hidden": "true" },
          s("path", { class: "ghost", d: shape(0, 5) }),
        ),
        "the front as asked",
      );
    node.replaceChildren(...[title, ...buttons, ghost].filter((one) => one instanceof Node));
    node.hidden = !buttons.length && !ghost;
    mark();
  }

  function mark() {
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(!x.state.off.has(k))));
  }

  return { node, draw, mark };
}
