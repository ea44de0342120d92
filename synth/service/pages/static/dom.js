// Nodes and texts. Whatever comes from people goes in as text only; no markup is made of it, and no style attribute.

import { FULL_DIGITS, number } from "./numbers.js";

/**
 * @typedef {import("./elements.js").Child} Child
 * @typedef {import("./elements.js").Attributes} Attributes
 */

/**
 * Make an element.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Attributes} [attributes] `onclick` and its like are listeners; true, false and null do what they say
 * @param {...Child} children
 */
export function h(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

/**
 * Make an element of a drawing.
 * @template {keyof SVGElementTagNameMap} T
 * @param {T} tag
 * @param {Attributes} [attributes]
 * @param {...Child} children
 */
export function s(tag, attributes = {}, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

/**
 * @template {Element} E
 * @param {E} element
 * @param {Attributes} attributes
 * @param {Child[]} children
 */
function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (name === "value" && "value" in element) element.value = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  for (const child of /** @type {unknown[]} */ (children).flat(3)) {
    if (child !== null && child !== undefined && child !== false) element.append(child instanceof Node ? child : String(child));
  }
  return element;
}

/** @type {Record<string, string>} */
const SUPERSCRIPT = { 2: "²", 3: "³" };
/** @type {Record<string, string>} */
const GREEK = {
  alpha: "α", beta: "β", gamma: "γ", delta: "δ", epsilon: "ε", eta: "η", theta: "θ", kappa: "κ", lambda: "λ", mu: "μ", nu: "ν", xi: "ξ", pi: "π",
  rho: "ρ", sigma: "σ", tau: "τ", phi: "φ", psi: "ψ", omega: "ω", Omega: "Ω", Delta: "Δ", Phi: "Φ",
};

/**
 * Return a unit as people write it: `kg·m²` for `kg*m2`.
 * @param {string | null | undefined} unit
 */
export function unitText(unit) {
  return unit && unit !== "-" ? unit.replaceAll("*", "·").replace(/([A-Za-z])([23])(?!\d)/g, (_, letter, power) => letter + SUPERSCRIPT[power]) : "";
}

/**
 * A number as it is shown; a text as it is.
 * A number as it is shown; a text as it is.
 * @param {string | number | null | undefined} value
 * @param {number} [digits]
 */
export const figure = (value, digits) => (typeof value === "string" ? value : number(value, digits));

/**
 * Return a name of the interface as words.
 * @param {unknown} name
 */
export const words = (name) => String(name).replaceAll("_", " ");

const LONG_NUMBER = /(?<![\w.,'"#-])\d[\d.]{3,}\d(?![\w'"]|,\d)/g; // neither quoted nor part of a name

/** @param {string} found */
const regrouped = (found) => (/^\d+(\.\d+)?$/.test(found) ? number(Number(found), FULL_DIGITS) : found);

/**
 * Return a text with its long numbers as they are shown elsewhere.
 * @param {string} text
 */
export const withFigures = (text) => text.replaceAll(LONG_NUMBER, regrouped);

/**
 * Return a sentence of the engine as people read it: names in words, units, signs and numbers as they are written.
 * @param {string | null | undefined} text
 */
export const asWords = (text) =>
  withFigures(words(text ?? "").replaceAll(/(\d) ([A-Za-z][A-Za-z0-9*/()]*)/g, (_, digit, unit) => `${digit}\u00a0${unitText(unit)}`))
    .replaceAll("<=", "≤").replaceAll(">=", "≥").replaceAll("->", "→");

/**
 * Return a symbol with its subscript; nothing where there is none.
 * @param {string | null | undefined} text
 */
export function symbol(text) {
  if (!text) return null;
  const [, base, below] = /^([A-Za-z]+?)_?([0-9]+|(?<=_).*)?$/.exec(text) ?? [null, text, ""];
  return h("span", { class: "symbol" }, GREEK[base] ?? base, below ? h("sub", {}, GREEK[below] ?? below) : null);
}

/**
 * Return a date.
 * @param {number} seconds
 */
export const day = (seconds) => new Date(1000 * seconds).toLocaleDateString("en-GB", { day: "numeric", month: "short", year: "numeric" });

/**
 * Return a time of day or a date, as near as it matters.
 * @param {number} seconds
 */
export function when(seconds) {
  const date = new Date(1000 * seconds), minutes = Math.round((Date.now() / 1000 - seconds) / 60);
  const text = minutes < 1 ? "just now" : minutes < 60 ? `${minutes} min ago` : minutes < 24 * 60 ? `${Math.round(minutes / 60)} h ago`
    : day(seconds);
  return h("time", { datetime: date.toISOString(), title: date.toLocaleString("en-GB") }, text);
}

/**
 * Return how long something takes.
 * @param {number} seconds
 */
export function duration(seconds) {
  if (seconds < 9.95) return `${number(Math.max(0, seconds), 2)} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return seconds < 5400 ? `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s` : `${number(seconds / 3600, 2)} h`;
}

/**
 * Say something to whoever listens to the page instead of looking at it.
 * @param {string} text
 */
export function say(text) {
  let place = document.getElementById("said");
  if (!place) document.body.append((place = h("div", { id: "said", class: "unseen", role: "status", "aria-live": "polite" })));
  place.textContent = text;
}

/**
 * Return the element of an id, which the page has.
 * @param {string} id
 */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element ${id}`);
  return element;
}

/**
 * Return the elements of a page or a part of it that fit a selector; all of them are elements of HTML.
 * @param {ParentNode} place
 * @param {string} selector
 * @returns {HTMLElement[]}
 */
export const allOf = (place, selector) => [...place.querySelectorAll(selector)].filter((one) => one instanceof HTMLElement);

/**
 * Return the first element of HTML that fits a selector, if there is one.
 * @param {ParentNode} place
 * @param {string} selector
 */
export const firstOf = (place, selector) => allOf(place, selector)[0];
