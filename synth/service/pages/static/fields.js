// Fields of the form: what a family declares, one row for each name.

import { asWords, figure, h, symbol, unitText, words } from "./dom.js";
import { FULL_DIGITS } from "./numbers.js";

/**
 * @typedef {import("./answers.js").Problem} Problem
 * @typedef {import("./records.js").DeclarationRow} DeclarationRow
 */

/**
 * What somebody has typed, as a spec states it: a number alone is meant in the unit that stands beside it.
 * @param {string} text
 * @param {string} unit
 */
export function stated(text, unit) {
  const typed = text.trim();
  if (!/^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(typed)) return typed;
  return unit && unit !== "-" ? `${typed} ${unit}` : Number(typed);
}

/**
 * What a spec states, as it stands in a field: without the unit where it is the one beside the field.
 * @param {unknown} value
 * @param {string} unit
 */
export function typed(value, unit) {
  if (Array.isArray(value)) return value.map((name) => (/,|^"/.test(name) ? `"${name.replaceAll('"', '""')}"` : name)).join(", ");
  if (value !== null && typeof value === "object") return JSON.stringify(value);
  const text = String(value ?? "");
  return unit && unit !== "-" && text.endsWith(` ${unit}`) ? text.slice(0, -unit.length - 1) : text;
}

/** @typedef {Pick<DeclarationRow, "name" | "text" | "unit" | "symbol" | "source" | "section" | "lower" | "upper">} FieldRow what a field shows */

/** A row with a name, what it means, a place to type, and what may be typed. */
export class Field {
  /**
   * @param {FieldRow} row
   * @param {{path: string[], hint: string, value: string, changed: () => void}} how
   */
  constructor(row, { path, hint, value, changed }) {
    const id = `f-${path.join("-").replaceAll(/[^\w-]/g, "_")}`;
    this.row = row;
    /** @type {Problem | null} */
    this.told = null;
    this.path = path;
    this.touched = value !== "";
    this.input = h("input", {
      id, value, placeholder: hint, autocomplete: "off", spellcheck: "false", "aria-describedby": `${id}-text ${id}-read ${id}-fault`,
      oninput: () => { this.touched = true; this.mark(); changed(); },
      onblur: () => { if (this.needed) { this.touched = true; this.show(this.told, ""); } },
    });
    this.read = h("span", { class: "read good", id: `${id}-read` });
    this.fault = h("p", { class: "fault", id: `${id}-fault` });
    this.element = h("div", { class: "field" },
      h("div", {}, h("label", { for: id }, words(row.name), symbol(row.symbol)), h("p", { class: "note", id: `${id}-text` }, asWords(row.text))),
      h("div", { class: "entry" }, h("div", { class: "typed" }, this.input, unitText(row.unit) ? h("span", {}, unitText(row.unit)) : null), this.read),
      h("div", { class: "range note" }, range(row), row.source ? h("span", { class: "source", title: row.source }, row.source) : null),
      this.fault);
    this.mark();
  }

  get needed() { return this.row.section === "needed"; }
  get value() { return this.input.value.trim(); }
  mark() { this.element.classList.toggle("changed", this.value !== "" && !this.needed); }

  /**
   * Show what the service says of it: a fault, or how it was read.
   * @param {Problem | null} problem
   * @param {string | undefined} read
   */
  show(problem, read) {
    this.told = problem;
    const open = problem && this.value === "" && !this.touched;
    const text = problem && !open ? faultText(problem) : "";
    if (this.fault.textContent !== text) this.fault.textContent = text;
    this.input.setAttribute("aria-invalid", String(Boolean(text)));
    this.element.classList.toggle("bad", Boolean(text));
    const said = read && !problem && this.value && plain(read) !== plain(String(stated(this.value, this.row.unit))) ? `read as ${nice(read)}` : "";
    if (this.read.textContent !== said) this.read.textContent = said;
  }
}

/**
 * Return what is wrong as it is read below its field, which says already of what it is told.
 * @param {Problem} problem
 */
const faultText = ({ message, value }) => {
  const start = value === null || value === undefined ? -1 : message.indexOf(": got ");
  return start < 0 ? message : `G${message.slice(start + 3)}`;
};

/** @param {string} text */
const plain = (text) => text.replaceAll(/\s+/g, "");

/** @param {string} read */
function nice(read) {
  const [, number, unit] = /^(\S+)\s?(.*)$/.exec(read) ?? [null, read, ""];
  return `${Number.isFinite(Number(number)) ? figure(Number(number), FULL_DIGITS) : number} ${unitText(unit)}`.trim();
}

/** @param {FieldRow} row */
function range(row) {
  if (row.section === "part") return "rows of the catalogue";
  if (row.lower === null || row.lower === undefined) return "";
  return `${figure(row.lower, FULL_DIGITS)} … ${figure(row.upper, FULL_DIGITS)}`;
}

/**
 * Return what stands in an empty field.
 * @param {DeclarationRow} row
 */
export function hintOf(row) {
  if (row.section === "assumption") return typeof row.default === "number" ? figure(row.default, FULL_DIGITS) : "by others";
  if (row.section === "limit") return "not asked";
  if (row.section === "part") return "all that fit";
  return ["needed", "duty"].includes(row.section) ? "" : "free";
}

/**
 * Return the choices of an option as one group.
 * @param {DeclarationRow} row
 * @param {unknown} chosen
 * @param {(name: string) => void} changed
 */
export function choices(row, chosen, changed) {
  const names = row.choices.split(", ");
  return h("div", { class: "field option" },
    h("div", {}, h("span", { class: "label", id: `o-${row.name}` }, words(row.name)), h("p", { class: "note" }, asWords(row.text))),
    h("div", { class: "segments", role: "radiogroup", "aria-labelledby": `o-${row.name}` }, names.map((name) =>
      h("label", {}, h("input", { type: "radio", name: `o-${row.name}`, value: name, checked: name === chosen, onchange: () => changed(name) }), words(name)))));
}
