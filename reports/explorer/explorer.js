// The explorer: one state, draw() for what changes, mark() for what is pointed at, which never makes or removes a node.

import { chips, familiesCard, frontCard, heading, parallelCard, rangeFields, tableCard } from "./cards.js";
import { certificateBanner, nothingCard } from "./certificate.js";
import { MOST_PINS, compareView } from "./compare.js";
import { focusOn, h } from "./dom.js";
import { legendView } from "./legend.js";
import { emptyModel, grouping, modelOf } from "./model.js";
import { amount } from "./numbers.js";
import { panelView } from "./panel.js";
import { parallelView } from "./parallel.js";
import { scatterView } from "./scatter.js";
import { CHOSEN, passes, readState, stateText } from "./state.js";
import { tableView } from "./table.js";
import { tipView } from "./tip.js";

let mounted = 0;

/**
 * @typedef {import("./record.js").FrontRecord} FrontRecord
 * @typedef {import("./record.js").Design} Design
 * @typedef {import("./record.js").Model} Model
 * @typedef {import("./record.js").Range} Range
 * @typedef {import("./options.js").Options} Options what whoever mounts the explorer may say
 * @typedef {import("./options.js").Handle} Handle what a page holds in its hands
 * @typedef {{node: Element, draw: () => void, filter: () => void, mark: () => void}} View
 */

/**
 * Show a front.
 * @param {HTMLElement} element
 * @param {FrontRecord} record as reports/explorer/record.py makes it
 * @param {Options} [options]
 * @returns {Handle}
 */
export function mount(element, record, options = {}) {
  const explorer = new Explorer(element, record, options);
  if (explorer.strip) options.whatIf?.(explorer.strip, explorer.handle);
  return explorer.handle;
}

export class Explorer {
  /**
   * @param {HTMLElement} element
   * @param {FrontRecord} record
   * @param {Options} options
   */
  constructor(element, record, options) {
    mounted += 1;
    this.id = `explorer-${mounted}`;
    this.options = options;
    /** @type {Record<string, number | null>[]} */
    this.ghosts = [];
    /** @type {Model | null} */
    this.other = null; // the model of what is drawn as outlines
    this.kept = ""; // the state of the last record with designs
    this.strip = options.whatIf ? h("div", { class: "what-if" }) : null;
    this.root = h("div", { class: "explorer" });
    /** @type {View[]} */
    this.views = [];
    this.count = h("p", { class: "count", role: "status" });
    this.filters = h("div", { class: "filters" });
    /** @type {import("./record.js").Groups | null} */
    this.cache = null;
    /** @type {HTMLDetailsElement | null} */
    this.fields = null;
    /** @type {ResizeObserver | null} */
    this.watch = null;
    /** @type {ReturnType<typeof scatterView> | null} */
    this.scatter = null;
    /** @type {ReturnType<typeof parallelView> | null} */
    this.parallel = null;
    /** @type {ReturnType<typeof tableView> | null} */
    this.table = null;
    /** @type {ReturnType<typeof tipView> | null} */
    this.tip = null;
    /** @type {ReturnType<typeof legendView> | null} */
    this.legend = null;
    /** @type {ReturnType<typeof panelView> | null} */
    this.panel = null;
    /** @type {ReturnType<typeof compareView> | null} */
    this.compare = null;
    element.replaceChildren(this.root);
    this.onPrint = () => this.openForPrint();
    window.addEventListener("beforeprint", this.onPrint);
    /** @type {Handle} */
    this.handle = {
      update: (record) => {
        const kept = this.text();
        this.show(record, this.lasting());
        this.kept = kept;
        this.tell();
      },
      compareWith: (record) => this.compareWith(record),
      select: (rank) => this.select(this.model.record.designs.findIndex((d) => d.rank === rank)),
      selected: () => this.model.record.designs[this.state.selected] ?? null,
      state: () => this.text(),
      destroy: () => {
        this.watch?.disconnect();
        window.removeEventListener("beforeprint", this.onPrint);
        this.root.remove();
      },
    };
    this.model = modelOf(record);
    this.state = readState(this.model, options.state ?? "");
    this.begin(options.state ?? "");
  }

  /** Return the text of the state; of a record without designs that of the one before. */
  text() {
    return this.model.count ? stateText(this) : this.kept;
  }

  /** Return the text of the state with what another record might choose otherwise: axes and colours. */
  lasting() {
    const told = new URLSearchParams(this.text());
    for (const name of CHOSEN) if (!told.has(name)) told.set(name, this.state[name]);
    return told.toString();
  }

  /**
   * Show a record, with what can be kept of a state.
   * @param {FrontRecord} record
   * @param {string} text
   */
  show(record, text) {
    this.watch?.disconnect();
    /** @type {Design | undefined} */
    const before = this.model.record.designs[this.state.selected];
    this.model = record.designs.length || !this.other ? modelOf(record) : emptyModel(record, this.other);
    this.state = readState(this.model, text);
    if (before) {
      const made = (/** @type {Design} */ d) => JSON.stringify([d.parts, d.choices]);
      const alike = record.designs.filter((d) => made(d) === made(before));
      const same = alike.find((d) => d.rank === before.rank) ?? alike[0];
      if (same) this.state.selected = record.designs.indexOf(same);
    }
    this.begin(text);
  }

  /**
   * Build, draw and watch what the model has.
   * @param {string} text of the state
   */
  begin(text) {
    this.kept = text;
    this.cache = null;
    const typing = this.strip?.contains(document.activeElement) ? document.activeElement : null;
    this.build();
    if (typing instanceof HTMLElement) typing.focus({ preventScroll: true });
    this.draw();
    if (!this.views.length) return;
    const charts = [this.scatter, this.parallel].filter((view) => view !== null);
    const wide = new Map(charts.map((view) => [view.node, view.node.clientWidth]));
    this.watch = new ResizeObserver(() => {
      for (const view of charts) {
        const now = view.node.clientWidth;
        if (!now || Math.abs(now - (wide.get(view.node) ?? now)) < 2) continue;
        wide.set(view.node, now);
        view.draw();
      }
    });
    for (const view of charts) this.watch.observe(view.node);
  }

  /** Print what must not be missed on paper: what the certificate does not speak of, and all designs. */
  openForPrint() {
    this.table?.all();
    const banners = /** @type {NodeListOf<HTMLDetailsElement>} */ (this.root.querySelectorAll("details.certificate"));
    for (const each of banners) each.open = true;
  }

  /** Build what stays while one record is shown. */
  build() {
    const { model, options } = this;
    this.views = [];
    this.scatter = this.parallel = this.table = this.tip = this.legend = this.panel = this.compare = null;
    const head = options.heading === false ? [] : [heading(this)];
    const parts = [...head, chips(this), certificateBanner(model.record)];
    const families = model.record.families ? [familiesCard(this)] : [];
    this.fields = null;
    if (!model.count && !this.other) {
      const strip = this.strip && h("section", { class: "card" }, this.strip);
      this.root.replaceChildren(...parts, strip || "", nothingCard(this), ...families);
      return;
    }
    const several = model.count > 1 || this.ghosts.length > 1;
    const left = [];
    if (several) {
      this.tip = tipView(this);
      const [scatter, legend] = [scatterView(this), legendView(this)];
      [this.scatter, this.legend] = [scatter, legend];
      left.push(frontCard(this, scatter, legend));
    } else if (this.strip) left.push(h("section", { class: "card front" }, this.strip));
    if (!model.count) {
      this.views = this.scatter ? [this.scatter] : [];
      const columns = h("div", { class: "columns" }, h("div", { class: "left" }, left), nothingCard(this));
      this.root.replaceChildren(...parts, columns);
      return;
    }
    this.panel = panelView(this);
    this.compare = compareView(this);
    if (model.count > 1) {
      this.parallel = parallelView(this);
      this.fields = rangeFields();
      left.push(parallelCard(this, this.parallel, this.fields));
    }
    this.table = tableView(this);
    left.push(tableCard(this, this.table), ...families);
    this.views = [this.scatter, this.parallel, this.table].filter((view) => view !== null);
    this.root.replaceChildren(
      ...parts,
      h("div", { class: several ? "columns" : "columns single" }, h("div", { class: "left" }, left), this.panel.node),
      this.compare.node,
      ...(this.tip ? [this.tip.node] : []),
    );
  }

  /** Return the groups that are shown by colour and shape. */
  group() {
    this.cache ??= grouping(this.model.column(this.state.by), this.model.count);
    return this.cache;
  }

  /**
   * Tell whether a design passes what is filtered.
   * @param {number} i
   */
  shown(i) {
    return passes(this, this.group(), i);
  }

  /** Draw all anew: another record, axis or colour. */
  draw() {
    this.tip?.draw();
    this.legend?.draw();
    for (const view of this.views) view.draw();
    this.refilter();
    this.panel?.draw();
    this.compare?.draw();
    this.tell();
  }

  /** Show what the filters leave. */
  refilter() {
    if (!this.scatter) return;
    const { model, state } = this;
    const kept = model.record.designs.filter((_, i) => this.shown(i)).length;
    this.count.textContent = !model.count ? "no design" : kept === model.count ? `${model.count} designs` : `${kept} of ${model.count} designs`;
    const drop = (/** @type {string} */ words, /** @type {() => void} */ run) =>
      h(
        "button",
        {
          type: "button",
          class: "filter",
          onclick: () => {
            run();
            focusOn(this.root, ".scatter");
          },
        },
        words,
        h("span", { "aria-hidden": "true" }, " ×"),
        h("span", { class: "unseen" }, " drop this filter"),
      );
    const chips = [...state.ranges].map(([key, [low, high]]) => {
      const c = model.axis(key);
      const words =
        low === -Infinity
          ? `${c.label} ≤ ${amount(high, c.unit)}`
          : high === Infinity
            ? `${c.label} ≥ ${amount(low, c.unit)}`
            : `${c.label} ${amount(low, "")} to ${amount(high, c.unit)}`;
      return drop(words, () => this.keep([[key, null]]));
    });
    if (state.off.size)
      chips.push(
        drop(`${[...state.off].map((k) => this.group().names[k]).join(", ")} hidden`, () => {
          state.off.clear();
          this.filtered();
        }),
      );
    if (chips.length > 1)
      chips.push(
        drop("all filters", () => {
          state.off.clear();
          state.ranges.clear();
          this.filtered();
        }),
      );
    this.filters.replaceChildren(...chips);
    if (!this.fields || !this.parallel) return;
    const typing = this.fields.contains(document.activeElement) && this.fields.open;
    if (!typing) this.fields.replaceChildren(this.fields.firstChild ?? "", this.parallel.fields());
  }

  filtered() {
    for (const view of this.views) view.filter();
    this.legend?.mark();
    this.refilter();
    this.tell();
  }

  /**
   * Keep ranges of attributes; null drops one.
   * @param {[string, Range | null][]} ranges
   */
  keep(ranges) {
    for (const [key, range] of ranges) {
      if (range) this.state.ranges.set(key, range);
      else this.state.ranges.delete(key);
    }
    this.filtered();
  }

  /**
   * Show or hide a group.
   * @param {number} group
   */
  toggle(group) {
    if (!this.state.off.delete(group)) this.state.off.add(group);
    this.filtered();
  }

  /**
   * Point at a design; -1 for none.
   * @param {number} i
   * @param {number} [left]
   * @param {number} [top]
   */
  hover(i, left, top) {
    this.tip?.show(i, left, top);
    if (this.state.hovered === i) return;
    this.state.hovered = i;
    for (const view of this.views) view.mark();
  }

  /**
   * Show a design in the panel.
   * @param {number} i
   */
  select(i) {
    if (i < 0 || i === this.state.selected) return;
    this.state.selected = i;
    for (const view of this.views) view.mark();
    this.panel?.draw();
    this.tell();
  }

  /**
   * Take a design for comparison, or no longer.
   * @param {number} i
   */
  pin(i) {
    const { pins } = this.state;
    const place = pins.indexOf(i);
    if (place >= 0) pins.splice(place, 1);
    else if (pins.length < MOST_PINS && i >= 0 && this.model.count > 1) pins.push(i);
    this.pinned();
  }

  unpin() {
    this.state.pins.length = 0;
    this.pinned();
    this.table?.node.focus();
  }

  pinned() {
    for (const view of this.views) view.mark();
    this.compare?.draw();
    this.panel?.draw();
    this.tell();
  }

  /**
   * Draw the designs of another record as outlines.
   * @param {FrontRecord | null} record
   */
  compareWith(record) {
    const other = record && modelOf(record);
    const few = this.model.count < 2;
    this.other = other;
    this.ghosts = other
      ? other.record.designs.map((_, i) => Object.fromEntries(other.axes.map((c) => [c.key, c.values[i]])))
      : [];
    if (few) this.show(this.model.record, this.text()); // with a scatter, or without one
    this.scatter?.draw();
    this.legend?.draw();
  }

  tell() {
    this.options.onState?.(this.text());
    this.options.onSelect?.(this.handle.selected());
  }
}
