// The table of designs: what the charts show, for eyes, keyboard and screen reader; sorted by any column.

import { h, hidden } from "./dom.js";
import { glyph } from "./marks.js";
import { columnNumbers, number } from "./numbers.js";

const FIRST_ROWS = 200; // that are laid out before more are asked for
const MOST_SIZES = 6; // columns of sizes that are shown unless others are chosen

/**
 * Make the table.
 * @param {import("./explorer.js").Explorer} x
 */
export function tableView(x) {
  const head = h("thead");
  const body = h("tbody");
  const table = h("table", { class: "designs" }, h("caption", { class: "unseen" }, "Designs of the front"), head, body);
  const more = h("button", {
    type: "button",
    class: "small more",
    onclick: () => {
      all();
      node.focus();
    },
  });
  const node = h(
    "div",
    { class: "scroll", tabindex: 0, role: "region", "aria-label": "Table of designs" },
    table,
    more,
  );
  let most = FIRST_ROWS;
  const chooser = h("div", { class: "chooser" });
  let rows = [];
  let sorted = [];
  let marked = { hovered: -1, selected: -1, pins: [] };

  /** Return the columns that are shown unless others are chosen. */
  function usual() {
    const { model } = x;
    const sizes = model.sizes.slice(0, MOST_SIZES);
    return new Set([...model.objectives, ...sizes, ...model.words].map((c) => c.key).concat("at_limit"));
  }

  function shownColumns() {
    x.state.columns ??= usual();
    return x.model.columns.filter((c) => x.state.columns.has(c.key));
  }

  function draw() {
    const { model, state } = x;
    const columns = shownColumns();
    const limits = state.columns.has("at_limit");
    const group = x.group();
    head.replaceChildren(
      h(
        "tr",
        null,
        header("rank", "#", ""),
        columns.map((c) => header(c.key, c.label, c.unit, c.text, c.kind === "word")),
        limits ? h("th", { scope: "col", class: "words" }, "at the limit") : null,
      ),
    );
    const bounds = (d) => d.at_limit.map((n) => labels.get(n) ?? n).join(", ");
    const labels = new Map(model.record.limits.map((l) => [l.name, l.label]));
    const numbers = new Map(columns.filter((c) => c.kind !== "word").map((c) => [c, columnNumbers(c.values)]));
    rows = model.record.designs.map((d, i) => {
      const first = h(
        "th",
        { scope: "row" },
        h("button", { type: "button", tabindex: -1, "aria-label": `Design ${d.rank}` }, String(d.rank)),
      );
      const cells = columns.map((c) =>
        c.kind === "word"
          ? h("td", { class: "words" }, c.key === state.by ? glyph(group.of[i], group.rest) : null, c.values[i])
          : h("td", null, numbers.get(c)(c.values[i])),
      );
      const names = model.names[i].length ? hidden(model.names[i].join(", ")) : null;
      if (names) first.append(names);
      const bound = limits ? h("td", { class: "words last soft", title: bounds(d) }, bounds(d)) : null;
      const row = h("tr", null, first, cells, bound);
      row.dataset.i = String(i);
      return row;
    });
    order();
    filter();
    marked = { hovered: -1, selected: -1, pins: [] };
    mark();
    choose();
  }

  function header(key, label, unit, text = "", words = false) {
    const [by, way] = x.state.sort;
    const sorted = by === key ? (way > 0 ? "ascending" : "descending") : null;
    const arrow = h("span", { class: "way", "aria-hidden": "true" }, sorted ? (way > 0 ? "↑" : "↓") : "");
    const press = () => {
      x.state.sort = [key, by === key && x.state.sort[1] > 0 ? -1 : 1];
      draw();
      head.querySelector("th[aria-sort] button")?.focus();
    };
    const name = key === "rank" ? hidden("rank") : null;
    return h(
      "th",
      { scope: "col", "aria-sort": sorted, class: words ? "words" : null, title: text || null },
      h(
        "button",
        { type: "button", onclick: press },
        name,
        name ? h("span", { "aria-hidden": "true" }, "#") : label,
        arrow,
      ),
      unit ? h("small", null, unit) : null,
    );
  }

  function order() {
    const [key, way] = x.state.sort;
    const values = key === "rank" ? x.model.record.designs.map((d) => d.rank) : (x.model.column(key)?.values ?? []);
    const compare = (a, b) => {
      if (values[a] === null || values[b] === null) return (values[a] === null) - (values[b] === null);
      return (
        way *
        (typeof values[a] === "number" ? values[a] - values[b] : String(values[a]).localeCompare(String(values[b])))
      );
    };
    sorted = rows.map((_, i) => i).sort((a, b) => compare(a, b) || a - b);
    body.replaceChildren(...sorted.map((i) => rows[i]));
  }

  function filter() {
    let count = 0;
    for (const i of sorted) {
      const kept = x.shown(i);
      count += Number(kept);
      rows[i].hidden = !kept || count > most;
    }
    more.hidden = count <= most;
    more.textContent = `Show all ${number(count)} designs`;
  }

  /** Show the rows that were left for later. */
  function all() {
    most = Infinity;
    filter();
  }

  function mark() {
    const { hovered, selected, pins } = x.state;
    if (marked.hovered !== hovered) {
      rows[marked.hovered]?.classList.remove("hovered");
      rows[hovered]?.classList.add("hovered");
    }
    if (marked.selected !== selected) {
      for (const [i, on] of [
        [marked.selected, false],
        [selected, true],
      ]) {
        if (!rows[i]) continue;
        rows[i].classList.toggle("selected", on);
        const button = rows[i].querySelector("button");
        button.tabIndex = on ? 0 : -1;
        if (on) button.setAttribute("aria-current", "true");
        else button.removeAttribute("aria-current");
      }
    }
    for (const i of marked.pins) rows[i]?.classList.remove("pinned");
    for (const i of pins) rows[i]?.classList.add("pinned");
    marked = { hovered, selected, pins: [...pins] };
  }

  const rowOf = (event) => event.target.closest?.("tbody tr");
  body.addEventListener("click", (event) => {
    const row = rowOf(event);
    if (row) x.select(Number(row.dataset.i));
  });
  body.addEventListener("pointerover", (event) => {
    const row = rowOf(event);
    x.hover(row ? Number(row.dataset.i) : -1);
  });
  body.addEventListener("pointerleave", () => x.hover(-1));
  body.addEventListener("keydown", (event) => {
    const row = rowOf(event);
    if (!row) return;
    if (event.key === " ") x.pin(Number(row.dataset.i));
    else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      const step = event.key === "ArrowDown" ? "nextElementSibling" : "previousElementSibling";
      let next = row[step];
      while (next?.hidden) next = next[step];
      if (!next) return;
      x.select(Number(next.dataset.i));
      next.querySelector("button").focus();
    } else return;
    event.preventDefault();
  });

  /** Fill the list of columns to choose from. */
  function choose() {
    const all = [
      ...x.model.columns.filter((c) => c.varies || c.kind === "objective").map((c) => [c.key, c.label]),
      ["at_limit", "at the limit"],
    ];
    chooser.replaceChildren(
      ...all.map(([key, label]) =>
        h(
          "label",
          null,
          h("input", {
            type: "checkbox",
            checked: x.state.columns.has(key),
            onchange: (event) => {
              if (event.target.checked) x.state.columns.add(key);
              else x.state.columns.delete(key);
              const place = all.findIndex(([each]) => each === key);
              draw();
              chooser.querySelectorAll("input")[place]?.focus();
            },
          }),
          label,
        ),
      ),
    );
  }

  return { node, chooser, draw, filter, mark, all };
}
