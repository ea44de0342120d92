// Parallel coordinates: one axis for each attribute, ranges kept by dragging along it; on a phone the axes lie flat.

import { h, s } from "./dom.js";
import { short, wrapped } from "./labels.js";
import { colourClass } from "./marks.js";
import { tellingColumns } from "./model.js";
import { amount, number } from "./numbers.js";
import { axisOf, rangeOf } from "./scales.js";

const MOST_AXES = 9;
const MOST_LETTERS = 20; // of a word beside its axis
const LETTER = 7.6; // pixels
const MOST_RIGHT = 168; // pixels that words may take
const NEAR = 16; // pixels from an axis within which it is meant
const REACH = 14; // pixels from a line

/**
 * @typedef {import("./record.js").NumberColumn} NumberColumn
 * @typedef {import("./record.js").WordColumn} WordColumn
 * @typedef {import("./record.js").Range} Range
 * @typedef {import("./record.js").Point} Point
 * @typedef {import("./record.js").Groups} Groups
 * @typedef {import("./record.js").ParallelAxis} ParallelAxis
 */

/**
 * Make the parallel coordinates.
 * @param {import("./explorer.js").Explorer} x
 */
export function parallelView(x) {
  const svg = s("svg", { class: "parallel", "aria-hidden": "true" });
  const box = h("div", { class: "chart" }, svg);
  const over = {
    chosen: s("path", { class: "line over chosen" }),
    hover: s("path", { class: "line over hover" }),
    dragged: s("rect", { class: "keep" }),
  };
  /** @type {ParallelAxis[]} */
  let axes = [];
  /** @type {string[]} */
  let lines = [];
  /** @type {SVGPathElement[]} */
  let drawnLines = [];
  /** @type {SVGRectElement[]} */
  let brushes = [];
  let flat = false;
  let ends = [0, 1];

  /**
   * Return the columns that are worth an axis.
   * @param {number} wide
   * @returns {(NumberColumn | WordColumn)[]}
   */
  function columns(wide) {
    const { model, state } = x;
    const most = flat ? MOST_AXES : Math.min(MOST_AXES, Math.max(4, Math.floor(wide / 105)));
    const word = model.column(state.by);
    const sizes = model.sizes.filter((c) => !model.record.families || c.values.every((v) => v !== null)); // of all
    const chosen = [...new Set([...model.objectives, model.axis(state.x), model.axis(state.y), ...sizes])];
    const first = chosen.filter((c) => c.values.some((v) => v !== null));
    const room = most - (word && word.kind === "word" ? 1 : 0);
    const rest = model.derived.filter((c) => !first.includes(c) && c.values.every((v) => v !== null));
    return [...tellingColumns(first, rest, room), ...(word && word.kind === "word" ? [word] : [])];
  }

  function draw() {
    const { model } = x;
    const wide = Math.max(280, Math.round(box.clientWidth || 800));
    flat = wide < 560;
    const shown = columns(wide);
    const last = shown[shown.length - 1];
    const letters = last?.kind === "word" ? Math.max(...last.values.map((v) => String(v).length)) : 0;
    const right = Math.min(MOST_RIGHT, Math.max(72, 16 + LETTER * Math.min(MOST_LETTERS, letters)));
    const gap = flat ? 62 : (wide - 58 - right) / Math.max(1, shown.length - 1);
    const high = flat ? 20 + gap * shown.length : 292;
    ends = flat ? [18, wide - 18] : [high - 24, 74];
    const group = x.group();
    axes = shown.map((column, k) => {
      const at = flat ? 40 + k * gap : 58 + k * gap;
      if (column.kind === "word") {
        const words = [...new Set(column.values)].sort((a, b) => String(a).localeCompare(String(b)));
        const share = (/** @type {string} */ word) => (words.indexOf(word) + 0.5) / words.length;
        return { column, at, words, share, value: null };
      }
      const values = column.values.filter((v) => v !== null);
      const scale = axisOf(values, 4, 0);
      return {
        column,
        at,
        share: scale.share,
        value: scale.at,
        range: [Math.min(...values), Math.max(...values)],
      };
    });
    const nodes = axes.flatMap((axis) => drawn(axis, gap, high, wide, group));
    lines = x.model.record.designs.map((_, i) => path(i));
    const order = model.record.designs.map((d, i) => [d.rank, i]).sort((a, b) => b[0] - a[0]);
    const many = model.count > 120 ? " many" : "";
    /** @type {SVGPathElement[]} */
    const made = [];
    order.forEach(([, i]) => {
      made[i] = s("path", { class: `line ${colourClass(group.of[i], group.rest)}${many}`, d: lines[i] });
    });
    drawnLines = made;
    brushes = axes.map(() => s("rect", { class: "keep" }));
    over.dragged.classList.remove("on");
    const behind = s(
      "g",
      null,
      order.map(([, i]) => made[i]),
    );
    svg.replaceChildren(
      behind,
      ...nodes.filter((n) => n.localName === "line"),
      ...brushes,
      over.dragged,
      over.chosen,
      over.hover,
      ...nodes.filter((n) => n.localName !== "line"),
    );
    svg.classList.toggle("flat", flat);
    svg.setAttribute("viewBox", `0 0 ${wide} ${high}`);
    svg.setAttribute("height", String(high));
    filter();
    mark();
  }

  const along = (/** @type {number} */ share) => ends[0] + (ends[1] - ends[0]) * share;
  /**
   * Return where the line of a design crosses an axis.
   * @param {ParallelAxis} axis
   * @param {number} i
   */
  const spot = (axis, i) => {
    if (axis.value === null) return along(axis.share(axis.column.values[i]));
    const value = axis.column.values[i];
    return value === null ? null : along(axis.share(value));
  };

  /**
   * Draw an axis.
   * @param {ParallelAxis} axis
   * @param {number} gap
   * @param {number} high
   * @param {number} wide
   * @param {Groups} group
   */
  function drawn(axis, gap, high, wide, group) {
    const { column, at } = axis;
    /** @type {SVGElement[]} */
    const made = [];
    if (flat) {
      const name = s(
        "text",
        { x: 14, y: at - 12, class: "title" },
        column.label,
        column.unit ? s("tspan", { class: "soft" }, `  ${column.unit}`) : null,
      );
      made.push(s("line", { class: "axis", x1: ends[0], x2: ends[1], y1: at, y2: at }), name);
      if (axis.value === null) {
        axis.words.forEach((word) =>
          made.push(
            s(
              "text",
              { x: along(axis.share(word)), y: at + 16, class: "mid" },
              short(word, Math.floor(wide / axis.words.length / 7)),
            ),
          ),
        );
      } else {
        made.push(
          s("text", { x: ends[0], y: at + 15 }, number(axis.range[0])),
          s("text", { x: ends[1], y: at + 15, class: "end" }, number(axis.range[1])),
        );
      }
      return made;
    }
    const room = Math.min(gap - 10, 2 * (at - 4), 2 * (wide - at - 4));
    const rows = wrapped(column.label, Math.max(7, Math.floor(room / 7.4)));
    made.push(s("line", { class: "axis", x1: at, x2: at, y1: ends[1] - 4, y2: ends[0] + 4 }));
    rows.forEach((row, k) =>
      made.push(s("text", { x: at, y: 14 + 14 * (k + 2 - rows.length), class: "title mid" }, row)),
    );
    if (column.unit) made.push(s("text", { x: at, y: 43, class: "mid soft" }, column.unit));
    if (axis.value === null) {
      const grouped = x.state.by === column.key;
      axis.words.forEach((word) => {
        const i = axis.column.values.indexOf(word);
        const colour = grouped ? `word ${colourClass(group.of[i], group.rest)}` : "word";
        const y = along(axis.share(word)) + 4;
        made.push(s("text", { x: at + 8, y, class: colour }, short(word, MOST_LETTERS)));
      });
    } else {
      made.push(s("text", { x: at, y: ends[1] - 9, class: "mid" }, number(axis.range[1])));
      made.push(s("text", { x: at, y: high - 6, class: "mid" }, number(axis.range[0])));
    }
    return made;
  }

  /** @param {number} i */
  function path(i) {
    let told = "";
    /** @type {Point | null} */
    let before = null;
    for (const axis of axes) {
      const there = spot(axis, i);
      if (there === null) {
        before = null;
        continue;
      }
      const [px, py] = flat ? [there, axis.at] : [axis.at, there];
      if (!before) told += `M${px.toFixed(1)} ${py.toFixed(1)}`;
      else if (flat) {
        const half = ((py + before[1]) / 2).toFixed(1);
        told += `C${before[0].toFixed(1)} ${half} ${px.toFixed(1)} ${half} ${px.toFixed(1)} ${py.toFixed(1)}`;
      } else {
        const half = ((px + before[0]) / 2).toFixed(1);
        told += `C${half} ${before[1].toFixed(1)} ${half} ${py.toFixed(1)} ${px.toFixed(1)} ${py.toFixed(1)}`;
      }
      before = [px, py];
    }
    return told;
  }

  function filter() {
    drawnLines.forEach((line, i) => line.classList.toggle("out", !x.shown(i)));
    axes.forEach((axis, k) => {
      const range = axis.value ? x.state.ranges.get(axis.column.key) : undefined;
      brushes[k].classList.toggle("on", Boolean(range));
      if (!range || !axis.value) return;
      const place = (/** @type {number} */ v) => along(Math.min(1.03, Math.max(-0.03, axis.share(v) || 0)));
      setBox(brushes[k], axis, place(range[0]), place(range[1]));
    });
  }

  /**
   * Draw what is kept of an axis.
   * @param {SVGElement} node
   * @param {ParallelAxis} axis
   * @param {number} from
   * @param {number} to
   */
  function setBox(node, axis, from, to) {
    const [low, size] = [Math.min(from, to), Math.abs(to - from)];
    const told = flat
      ? { x: low, width: size, y: axis.at - 9, height: 18 }
      : { x: axis.at - 9, width: 18, y: low, height: size };
    for (const [name, value] of Object.entries(told)) node.setAttribute(name, value.toFixed(1));
  }

  function mark() {
    const group = x.group();
    /** @type {["chosen" | "hover", number][]} */
    const marked = [
      ["chosen", x.state.selected],
      ["hover", x.state.hovered],
    ];
    for (const [name, i] of marked) {
      over[name].setAttribute("d", lines[i] ?? "");
      over[name].setAttribute("class", `line over ${name} ${i >= 0 ? colourClass(group.of[i], group.rest) : ""}`);
    }
  }

  /**
   * Return where an event is: across the axes, along them.
   * @param {PointerEvent} event
   * @returns {Point}
   */
  function at(event) {
    const area = svg.getBoundingClientRect();
    const [left, top] = [event.clientX - area.left, event.clientY - area.top];
    return flat ? [top, left] : [left, top];
  }

  const axisAt = (/** @type {Point} */ [across]) => axes.findIndex((axis) => Math.abs(axis.at - across) <= NEAR);

  /** @param {Point} here */
  function lineAt([across, level]) {
    const k = axes.findIndex((axis, n) => n + 1 < axes.length && across >= axis.at && across <= axes[n + 1].at);
    if (k < 0) return -1;
    const u = (across - axes[k].at) / (axes[k + 1].at - axes[k].at);
    const bend = u * u * (3 - 2 * u);
    let best = -1;
    let least = REACH;
    for (let i = 0; i < x.model.count; i += 1) {
      if (!x.shown(i)) continue;
      const [from, to] = [spot(axes[k], i), spot(axes[k + 1], i)];
      if (from === null || to === null) continue;
      const far = Math.abs(from + (to - from) * bend - level);
      if (far < least) [best, least] = [i, far];
    }
    return best;
  }

  /** @type {{k: number, from: Point, moved: boolean} | null} */
  let press = null;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const here = at(event);
    const k = axisAt(here);
    press = { k, from: here, moved: false };
    if (event.pointerType !== "touch") svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    const here = at(event);
    const axis = press && axes[press.k];
    if (press && axis && axis.value && event.pointerType !== "touch") {
      press.moved ||= Math.abs(here[1] - press.from[1]) > 4;
      if (press.moved) {
        over.dragged.classList.add("on");
        setBox(over.dragged, axis, press.from[1], here[1]);
        return;
      }
    }
    svg.classList.toggle("grip", axisAt(here) >= 0);
    x.hover(lineAt(here), event.clientX, event.clientY);
  });
  svg.addEventListener("pointerup", (event) => {
    const here = at(event);
    const axis = press && axes[press.k];
    over.dragged.classList.remove("on");
    if (press?.moved && axis?.value) {
      const share = (/** @type {number} */ level) => Math.min(1, Math.max(0, (level - ends[0]) / (ends[1] - ends[0])));
      x.keep([[axis.column.key, rangeOf(axis.value(share(press.from[1])), axis.value(share(here[1])))]]);
    } else if (axis && x.state.ranges.has(axis.column.key)) {
      x.keep([[axis.column.key, null]]);
    } else if (press) {
      const found = lineAt(here);
      if (found >= 0) x.select(found);
    }
    press = null;
  });
  svg.addEventListener("pointercancel", () => {
    press = null;
  });
  svg.addEventListener("pointerleave", () => x.hover(-1));

  /** Return fields to type ranges into: the way of those who have no pointer. */
  function fields() {
    const row = (/** @type {NumberColumn} */ column) => {
      const now = x.state.ranges.get(column.key) ?? [-Infinity, Infinity];
      const field = (/** @type {0 | 1} */ k, /** @type {string} */ word) =>
        h("input", {
          type: "number",
          step: "any",
          "aria-label": `${column.label}, ${word}${column.unit ? ` in ${column.unit}` : ""}`,
          placeholder: number((k ? Math.max : Math.min)(...column.values.filter((v) => v !== null))),
          value: !Number.isFinite(now[k]) ? null : Number(now[k].toPrecision(5)),
          onchange: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => {
            const typed = event.target.value === "" ? null : Number(event.target.value);
            const old = x.state.ranges.get(column.key) ?? [-Infinity, Infinity];
            /** @type {Range} */
            const next = [old[0], old[1]];
            next[k] = typed === null ? (k ? Infinity : -Infinity) : typed;
            x.keep([[column.key, next[0] === -Infinity && next[1] === Infinity ? null : next]]);
          },
        });
      return h(
        "tr",
        null,
        h("th", { scope: "row" }, column.label),
        h("td", null, field(0, "at least")),
        h("td", null, field(1, "at most")),
        h("td", null, column.unit),
      );
    };
    return h(
      "table",
      { class: "fields" },
      h(
        "thead",
        null,
        h(
          "tr",
          null,
          ["", "at least", "at most", ""].map((w) => (w ? h("th", { scope: "col" }, w) : h("td"))),
        ),
      ),
      h(
        "tbody",
        null,
        axes.flatMap((axis) => (axis.value ? [row(axis.column)] : [])),
      ),
    );
  }

  const same = () =>
    x.model.same
      .filter((c) => c.kind !== "derived")
      .map((c) => `${c.label} ${c.kind === "word" ? c.values[0] : amount(c.values[0], c.unit)}`);
  return { node: box, draw, filter, mark, fields, same };
}
