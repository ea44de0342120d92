// A slider of the strip: what is varied, the track with what is known along it, and a field for any other value.

import { h, s, unitText } from "./dom.js";
import { quantity, shown } from "./what_if_knobs.js";
import { drawTrack, markList } from "./what_if_track.js";

const PATIENCE = 400; // ms after a key, before a search starts

/** A slider with a field beside it; the strip that it stands in is told what is let go. */
export class Slider {
  /**
   * @param {import("./what_if.js").Strip} strip
   * @param {import("./what_if_knobs.js").Knob} knob
   * @param {number | null} value
   */
  constructor(strip, knob, value) {
    this.strip = strip;
    this.knob = knob;
    this.value = value;
    this.word = h("span", {});
    this.select = h("select", { "aria-label": "What is varied", onchange: () => this.turn() });
    this.range = h("input", { type: "range", min: 0, step: 1, oninput: () => this.dragged(), onchange: () => this.let() });
    for (const name of ["pointerdown", "touchstart"]) this.range.addEventListener(name, () => { strip.holding = true; }, { passive: true });
    for (const name of ["pointerup", "pointercancel", "touchend"]) this.range.addEventListener(name, () => setTimeout(() => {
      strip.holding = false;
      strip.held?.();
      strip.held = null;
    }), { passive: true });
    this.field = h("input", { inputmode: "decimal", autocomplete: "off", spellcheck: "false", onchange: () => this.typed(), onkeydown: (/** @type {KeyboardEvent} */ event) => event.key === "Escape" && this.set(this.value) });
    this.unit = h("span", {});
    this.drawing = s("svg", { class: "ticks", height: 26, "aria-hidden": "true" });
    this.list = h("div", { class: "unseen" });
    this.noted = h("p", { class: "soft noted" });
    this.drop = h("button", { type: "button", class: "small drop", "aria-label": "Remove this slider", onclick: () => strip.remove(this) }, "×");
    this.element = h("div", { class: "knob", role: "group" }, h("label", { class: "what" }, this.word, this.select),
      h("div", { class: "track" }, this.range, this.drawing, this.noted, this.list), h("div", { class: "value" }, h("div", { class: "typed" }, this.field, this.unit), this.drop));
    this.draw();
  }

  /**
   * Show which sliders there are beside this one.
   * @param {number} number
   * @param {number} count
   */
  place(number, count) {
    this.word.textContent = number ? "and" : "What if";
    this.drop.hidden = count < 2;
    const others = this.strip.sliders.map((slider) => slider.knob);
    const groups = new Map();
    for (const knob of this.strip.knobs) {
      if (knob !== this.knob && others.includes(knob)) continue;
      groups.set(knob.group, [...(groups.get(knob.group) ?? []), h("option", { value: knob.key, selected: knob === this.knob }, knob.label)]);
    }
    this.select.replaceChildren(...[...groups].map(([label, entries]) => h("optgroup", { label }, entries)));
    requestAnimationFrame(() => this.ticks());
  }

  turn() {
    const moved = this.value !== this.knob.base;
    this.knob = this.strip.knobs.find((knob) => knob.key === this.select.value) ?? this.knob;
    this.value = this.knob.base;
    this.draw();
    this.strip.lay();
    if (moved) this.strip.released();
    this.strip.recall();
  }

  /** Draw all for another quantity. */
  draw() {
    const { knob } = this;
    this.element.setAttribute("aria-label", knob.label);
    this.select.title = knob.text;
    this.range.max = String(knob.values.length - 1);
    this.range.setAttribute("aria-label", knob.label);
    this.field.setAttribute("aria-label", `${knob.label}${unitText(knob.unit) ? `, in ${unitText(knob.unit)}` : ""}`);
    this.field.placeholder = "no limit";
    this.unit.textContent = unitText(knob.unit);
    this.unit.hidden = !unitText(knob.unit);
    this.set(this.value);
    this.ticks();
  }

  /** @param {number | null} value */
  set(value) {
    clearTimeout(this.waiting);
    this.value = value;
    const { values } = this.knob;
    const far = (/** @type {number} */ k) => Math.abs((values[k] ?? Infinity) - (value ?? 0));
    const k = values.indexOf(value);
    this.range.value = String(k >= 0 ? k : [...values.keys()].reduce((best, i) => (far(i) < far(best) ? i : best), values[0] === null ? 1 : 0));
    this.tell(value);
  }

  /**
   * Show a value in words and in the field.
   * @param {number | null} value
   */
  tell(value) {
    this.range.setAttribute("aria-valuetext", shown(this.knob, value) + (value === this.knob.base ? ", as asked" : ""));
    this.field.value = value === null ? "" : String(Number(value.toPrecision(7)));
    this.field.removeAttribute("aria-invalid");
    this.element.classList.toggle("moved", value !== this.knob.base);
    const share = Number(this.range.value) / Math.max(1, this.knob.values.length - 1);
    this.range.style.setProperty("--share", String(share));
  }

  dragged() {
    this.tell(this.knob.values[Number(this.range.value)]);
  }

  /** The slider was let go, or moved by a key. */
  let() {
    clearTimeout(this.waiting);
    const value = this.knob.values[Number(this.range.value)];
    const go = () => {
      if (value === this.value) return;
      this.value = value;
      this.strip.released();
    };
    if (this.strip.holding) go();
    else this.waiting = setTimeout(go, PATIENCE);
  }

  typed() {
    const told = quantity(this.field.value.trim().replace(",", "."), this.knob.unit);
    const [low, high] = this.knob.bounds;
    const empty = this.field.value.trim() === "";
    const value = empty ? this.knob.base : told?.number;
    const right = told && Number.isFinite(told.number) && told.unit === this.knob.unit && told.number >= low && told.number <= high;
    if (value === undefined || !(empty || right)) {
      this.field.setAttribute("aria-invalid", "true");
      const range = Number.isFinite(low) ? ` from ${shown(this.knob, low)} to ${shown(this.knob, high)}` : "";
      return this.strip.say(h("span", { class: "fault" }, `${this.knob.label}: a number in ${unitText(this.knob.unit) || "this unit"}${range}, please.`));
    }
    const before = this.value;
    this.set(value);
    if (value !== before) this.strip.released();
    return undefined;
  }

  /** @param {string} text */
  note(text) {
    this.noted.textContent = text;
  }

  /** Draw what is known along the track. */
  ticks() {
    this.found = this.strip.fills.get(this.knob) ?? null;
    if (this.found || !this.strip.fills.has(this.knob)) this.note("");
    drawTrack(this.drawing, this.knob.values, this.found ?? { marks: [], barren: [] });
    this.list.replaceChildren(this.found ? markList(this.found.marks) : "");
  }
}
