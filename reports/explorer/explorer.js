// The explorer: one state, draw() for what changes, mark() for what is pointed at, which never makes or removes a node.

import { chips, familiesCard, frontCard, heading, parallelCard, tableCard } from "./cards.js";
import { certificateBanner, nothingCard } from "./certificate.js";
import { MOST_PINS, compareView } from "./compare.js";
import { h } from "./dom.js";
import { legendView } from "./legend.js";
import { emptyModel, grouping, modelOf } from "./model.js";
import { amount } from "./numbers.js";
import { panelView } from "./panel.js";
import { parallelView } from "./parallel.js";
import { scatterView } from "./scatter.js";
import { readState, stateText } from "./state.js";
import { tableView } from "./table.js";
import { tipView } from "./tip.js";

let mounted = 0;

/**
 * @typedef {object} Download
 * @property {string} label
 * @property {string} [href] of the same host
 * @property {string} [download] name of the file
 * @property {(design: object) => void} [run] in place of an address
 */

/**
 * What whoever mounts the explorer may say; all of it may be left out.
 * @typedef {object} Options
 * @property {(design: object) => Download[]} [downloads] what the panel offers beside DESIGN.yaml
 * @property {(design: object) => Promise<string>} [picture] the drawing of a design, as SVG, that the record does not hold
 * @property {(slot: HTMLElement, handle: Handle) => void} [whatIf] fills the strip below the scatter, once: it stays the
 *   same element whatever is shown
 * @property {(slot: HTMLElement, handle: Handle) => void} [ways] fills the place for ways out where nothing is feasible
 * @property {(slot: HTMLElement, handle: Handle) => void} [actions] fills the corner beside the title
 * @property {string} [state] text of an earlier state, as `onState` told it
 * @property {(text: string) => void} [onState] is told the state after every change, for an address
 * @property {(design: object | null) => void} [onSelect] is told which design is shown
 * @property {boolean} [heading] false where the page has a title of its own
 */

/**
 * What a page holds in its hands.
 * @typedef {object} Handle
 * @property {(record: object) => void} update shows another record; axes, colours and the chosen parts stay
 * @property {(record: object | null) => void} compareWith draws the designs of another record as outlines; where the
 *   record that is shown has no design, on the axes of the other
 * @property {(rank: number) => void} select
 * @property {() => object | null} selected the design that is shown
 * @property {() => string} state
 * @property {() => void} destroy
 */

/**
 * Show a front.
 * @param {HTMLElement} element
 * @param {object} record as reports/explorer/record.py makes it
 * @param {Options} [options]
 * @returns {Handle}
 */
export function mount(element, record, options = {}) {
  const explorer = new Explorer(element, options);
  explorer.show(record, options.state ?? "");
  options.whatIf?.(explorer.strip, explorer.handle);
  return explorer.handle;
}

export class Explorer {
  /**
   * @param {HTMLElement} element
   * @param {Options} options
   */
  constructor(element, options) {
    mounted += 1;
    this.id = `explorer-${mounted}`;
    this.options = options;
    this.ghosts = [];
    this.other = null; // the model of what is drawn as outlines
    this.kept = ""; // the state of the last record with designs
    this.strip = options.whatIf ? h("div", { class: "what-if" }) : null;
    this.root = h("div", { class: "explorer" });
    this.views = [];
    element.replaceChildren(this.root);
    this.onPrint = () => this.openForPrint();
    window.addEventListener("beforeprint", this.onPrint);
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
  }

  /** Return the text of the state; of a record without designs that of the one before. */
  text() {
    return this.model.count ? stateText(this) : this.kept;
  }

  /** Return the text of the state with what another record might choose otherwise: axes and colours. */
  lasting() {
    const told = new URLSearchParams(this.text());
    for (const name of ["x", "y", "by"]) if (!told.has(name)) told.set(name, this.state[name]);
    return told.toString();
  }

  /** Show a record, with what can be kept of a state. */
  show(record, text) {
    this.watch?.disconnect();
    const before = this.model && this.model.record.designs[this.state.selected];
    this.kept = text;
    this.model = record.designs.length || !this.other ? modelOf(record) : emptyModel(record, this.other);
    this.state = readState(this.model, text);
    if (before) {
      const made = (d) => JSON.stringify([d.parts, d.choices]);
      const alike = record.designs.filter((d) => made(d) === made(before));
      const same = alike.find((d) => d.rank === before.rank) ?? alike[0];
      if (same) this.state.selected = record.designs.indexOf(same);
    }
    this.cache = null;
    const typing = this.strip?.contains(document.activeElement) ? document.activeElement : null;
    this.build();
    typing?.focus({ preventScroll: true });
    this.draw();
    if (!this.views.length) return;
    const charts = [this.scatter, this.parallel].filter(Boolean);
    const wide = new Map(charts.map((view) => [view.node, view.node.clientWidth]));
    this.watch = new ResizeObserver(() => {
      for (const view of charts) {
        const now = view.node.clientWidth;
        if (!now || Math.abs(now - wide.get(view.node)) < 2) continue;
        wide.set(view.node, now);
        view.draw();
      }
    });
    for (const view of charts) this.watch.observe(view.node);
  }

  /** Print what must not be missed on paper: what the certificate does not speak of, and all designs. */
  openForPrint() {
    this.table?.all();
    for (const each of this.root.querySelectorAll("details.certificate")) each.open = true;
  }

  /** Build what stays while one record is shown. */
  build() {
    const { model, options } = this;
    this.views = [];
    this.scatter = this.parallel = this.table = this.tip = this.legend = null;
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
      this.scatter = scatterView(this);
      this.legend = legendView(this);
      left.push(frontCard(this));
    } else if (this.strip) left.push(h("section", { class: "card front" }, this.strip));
    if (!model.count) {
      this.views = [this.scatter].filter(Boolean);
      const columns = h("div", { class: "columns" }, h("div", { class: "left" }, left), nothingCard(this));
      this.root.replaceChildren(...parts, columns);
      return;
    }
    this.panel = panelView(this);
    this.compare = compareView(this);
    if (model.count > 1) {
      this.parallel = parallelView(this);
      left.push(parallelCard(this));
    }
    this.table = tableView(this);
    left.push(tableCard(this), ...families);
    this.views = [this.scatter, this.parallel, this.table].filter(Boolean);
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

  /** Tell whether a design passes what is filtered. */
  shown(i) {
    if (this.state.off.has(this.group().of[i])) return false;
    for (const [key, [low, high]] of this.state.ranges) {
      const value = this.model.column(key).values[i];
      if (value === null || value < low || value > high) return false;
    }
    return true;
  }

  /** Draw all anew: another record, axis or colour. */
  draw() {
    this.tip?.draw();
    this.legend?.draw();
    for (const view of this.views) view.draw();
    this.refilter();
    if (!this.model.count) return this.tell();
    this.panel.draw();
    this.compare.draw();
    return this.tell();
  }

  /** Show what the filters leave. */
  refilter() {
    if (!this.scatter) return;
    const { model, state } = this;
    const kept = model.record.designs.filter((_, i) => this.shown(i)).length;
    this.count.textContent = !model.count ? "no design" : kept === model.count ? `${model.count} designs` : `${kept} of ${model.count} designs`;
    const drop = (words, run) =>
      h(
        "button",
        {
          type: "button",
          class: "filter",
          onclick: () => {
            run();
            this.root.querySelector(".scatter").focus();
          },
        },
        words,
        h("span", { "aria-hidden": "true" }, " ×"),
        h("span", { class: "unseen" }, " drop this filter"),
      );
    const chips = [...state.ranges].map(([key, [low, high]]) => {
      const c = model.column(key);
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
    if (!this.fields) return;
    const typing = this.fields.contains(document.activeElement) && this.fields.open;
    if (!typing) this.fields.replaceChildren(this.fields.firstChild, this.parallel.fields());
  }

  filtered() {
    for (const view of this.views) view.filter();
    this.legend?.mark();
    this.refilter();
    this.tell();
  }

  /** Keep ranges of attributes; null drops one. */
  keep(ranges) {
    for (const [key, range] of ranges) {
      if (range) this.state.ranges.set(key, range);
      else this.state.ranges.delete(key);
    }
    this.filtered();
  }

  /** Show or hide a group. */
  toggle(group) {
    if (!this.state.off.delete(group)) this.state.off.add(group);
    this.filtered();
  }

  /** Point at a design; -1 for none. */
  hover(i, left, top) {
    this.tip?.show(i, left, top);
    if (this.state.hovered === i) return;
    this.state.hovered = i;
    for (const view of this.views) view.mark();
  }

  /** Show a design in the panel. */
  select(i) {
    if (i < 0 || i === this.state.selected) return;
    this.state.selected = i;
    for (const view of this.views) view.mark();
    this.panel.draw();
    this.tell();
  }

  /** Take a design for comparison, or no longer. */
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
    this.table.node.focus();
  }

  pinned() {
    for (const view of this.views) view.mark();
    this.compare.draw();
    this.panel.draw();
    this.tell();
  }

  compareWith(record) {
    const other = record && modelOf(record);
    const few = this.model.count < 2;
    this.other = other;
    this.ghosts = other
      ? record.designs.map((_, i) => Object.fromEntries(other.axes.map((c) => [c.key, c.values[i]])))
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
