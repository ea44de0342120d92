// The table of designs: what the charts show, for eyes, keyboard and screen reader; sorted by any column.

import { focusOn, h, hidden } from "./dom.js";
import { glyph } from "./marks.js";
import { columnNumbers, number } from "./numbers.js";

const FIRST_ROWS = 200; // that are laid out before more are asked for
const MOST_SIZES = 6; // columns of sizes that are shown unless others are chosen

/**
 * Return the order of values: what is missing last, whatever the direction, and equal ones as they were.
 * @param {(number | string | null)[]} values
 * @param {number} way 1 or -1
 */
export function sortedBy(values, way) {
  const compare = (/** @type {number} */ a, /** @type {number} */ b) => {
    const [x, y] = [values[a], values[b]];
    if (x === null || y === null) return Number(x === null) - Number(y === null);
    return way * (typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y)));
  };
  return values.map((_, i) => i).sort((a, b) => compare(a, b) || a - b);
}

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
  /** @type {HTMLTableRowElement[]} */
  let rows = [];
  /** @type {number[]} */
  let sorted = [];
  /** @type {{hovered: number, selected: number, pins: number[]}} */
  let marked = { hovered: -1, selected: -1, pins: [] };

  /** Return the columns that are shown unless others are chosen. */
  function usual() {
    const { model } = x;
    const sizes = model.sizes.slice(0, MOST_SIZES);
    return new Set([...model.objectives, ...sizes, ...model.words].map((c) => c.key).concat("at_limit"));
  }

  /** Return the keys of the columns that are shown. */
  function keys() {
    x.state.columns ??= usual();
    return x.state.columns;
  }

  function draw() {
    const { model, state } = x;
    const columns = model.columns.filter((c) => keys().has(c.key));
    const limits = keys().has("at_limit");
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
    const bounds = (/** @type {import("./record.js").Design} */ d) => d.at_limit.map((n) => labels.get(n) ?? n).join(", ");
    const labels = new Map(model.record.limits.map((l) => [l.name, l.label]));
    /** @type {((i: number) => HTMLElement)[]} */
    const cellOf = columns.map((c) => {
      if (c.kind === "word") {
        const mark = (/** @type {number} */ i) => (c.key === state.by ? glyph(group.of[i], group.rest) : null);
        return (i) => h("td", { class: "words" }, mark(i), c.values[i]);
      }
      const text = columnNumbers(c.values);
      return (i) => h("td", null, text(c.values[i]));
    });
    rows = model.record.designs.map((d, i) => {
      const first = h(
        "th",
        { scope: "row" },
        h("button", { type: "button", tabindex: -1, "aria-label": `Design ${d.rank}` }, String(d.rank)),
      );
      const cells = cellOf.map((cell) => cell(i));
      const names = model.names[i].length ? hidden(model.names[i].join(", ")) : null;
      if (names) first.append(names);
      if (d.near) first.append(h("small", { class: "near", title: d.near }, ` +${d.near.split("#").length - 1}`), hidden(d.near));
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

  /**
   * Return the head of a column, by which it is sorted.
   * @param {string} key
   * @param {string} label
   * @param {string} unit
   * @param {string} [text]
   * @param {boolean} [words]
   */
  function header(key, label, unit, text = "", words = false) {
    const [by, way] = x.state.sort;
    const sorted = by === key ? (way > 0 ? "ascending" : "descending") : null;
    const arrow = h("span", { class: "way", "aria-hidden": "true" }, sorted ? (way > 0 ? "↑" : "↓") : "");
    const press = () => {
      x.state.sort = [key, by === key && x.state.sort[1] > 0 ? -1 : 1];
      draw();
      focusOn(head, "th[aria-sort] button");
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
    sorted = sortedBy(values, way);
    body.replaceChildren(...sorted.map((i) => rows[i]));
  }

  function filter() {
    let count = 0;
    let lines = 0;
    for (const i of sorted) {
      const kept = x.shown(i);
      // Near-equals stand on the line of the one that leads them until all are asked for.
      const line = kept && (most === Infinity || !x.model.record.designs[i].group);
      count += Number(kept);
      lines += Number(line);
      rows[i].hidden = !line || lines > most;
    }
    more.hidden = count <= Math.min(lines, most);
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
      /** @type {[number, boolean][]} */
      const changed = [
        [marked.selected, false],
        [selected, true],
      ];
      for (const [i, on] of changed) {
        if (!rows[i]) continue;
        rows[i].classList.toggle("selected", on);
        const button = rows[i].querySelector("button");
        if (!button) continue;
        button.tabIndex = on ? 0 : -1;
        if (on) button.setAttribute("aria-current", "true");
        else button.removeAttribute("aria-current");
      }
    }
    for (const i of marked.pins) rows[i]?.classList.remove("pinned");
    for (const i of pins) rows[i]?.classList.add("pinned");
    marked = { hovered, selected, pins: [...pins] };
  }

  const near = (/** @type {Event} */ event) => (event.target instanceof Element ? event.target.closest("tbody tr") : null);
  const rowOf = (/** @type {Event} */ event) => /** @type {HTMLTableRowElement | null} */ (near(event));
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
      let next = /** @type {HTMLTableRowElement | null} */ (row[step]);
      while (next?.hidden) next = /** @type {HTMLTableRowElement | null} */ (next[step]);
      if (!next) return;
      x.select(Number(next.dataset.i));
      focusOn(next, "button");
    } else return;
    event.preventDefault();
  });

  /**
   * Return a column as the list tells it.
   * @param {import("./record.js").Column} column
   * @returns {[key: string, label: string]}
   */
  const named = ({ key, label }) => [key, label];

  /** Fill the list of columns to choose from. */
  function choose() {
    /** @type {[key: string, label: string][]} */
    const all = [
      ...x.model.columns.filter((c) => c.varies || c.kind === "objective").map(named),
      ["at_limit", "at the limit"],
    ];
    chooser.replaceChildren(
      ...all.map(([key, label]) =>
        h(
          "label",
          null,
          h("input", {
            type: "checkbox",
            checked: keys().has(key),
            onchange: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => {
              if (event.target.checked) keys().add(key);
              else keys().delete(key);
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
