// Nodes: text goes in as text only, and no style attribute is written, which a strict policy refuses.

const SVG = "http://www.w3.org/2000/svg";
// Control characters and what turns the direction of writing: shown by their numbers, as in the PDF of reports.
const TURNING =
  /[\u0000-\u0008\u000b\u000c\u000e-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufff9-\ufffb]/g;

/**
 * Return a text in which nothing hides.
 * @param {unknown} text
 * @returns {string}
 */
export function plain(text) {
  const code = (/** @type {string} */ found) => `[U+${found.charCodeAt(0).toString(16).toUpperCase().padStart(4, "0")}]`;
  return String(text ?? "").replace(TURNING, code);
}

/**
 * @typedef {import("./elements.js").Child} Child
 * @typedef {import("./elements.js").Attributes} Attributes
 */

/**
 * @template {Element} E
 * @param {E} node
 * @param {Attributes | null} attributes
 * @param {Child[]} children
 */
function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? "" : plain(value));
  }
  for (const child of /** @type {Exclude<Child, Child[]>[]} */ (/** @type {unknown[]} */ (children).flat(Infinity))) {
    if (child === null || child === undefined || child === false) continue;
    node.append(child instanceof Node ? child : document.createTextNode(plain(child)));
  }
  return node;
}

/**
 * Make an element of HTML.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Attributes | null} [attributes]
 * @param {...Child} children
 */
export const h = (tag, attributes = null, ...children) => filled(document.createElement(tag), attributes, children);

/**
 * Make an element of SVG.
 * @template {keyof SVGElementTagNameMap} T
 * @param {T} tag
 * @param {Attributes | null} [attributes]
 * @param {...Child} children
 */
export const s = (tag, attributes = null, ...children) =>
  filled(document.createElementNS(SVG, tag), attributes, children);

/**
 * Return an address if it leads to a file beside the page or to data made here; nothing for all others.
 * @param {unknown} address
 * @returns {string}
 */
export function localAddress(address) {
  const text = String(address ?? "");
  return /^(?:\.{0,2}\/)?[\w%-][\w%.,~-]*(?:\/[\w%.,~-]+)*(?:[?#][\w%=&.~-]*)?$/.test(text) ? text : "";
}

/**
 * Hand a text over as a file.
 * @param {string} name
 * @param {string} text
 * @param {string} kind
 */
export function save(name, text, kind) {
  const address = URL.createObjectURL(new Blob([text], { type: kind }));
  const link = h("a", { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/**
 * Words that only a screen reader tells.
 * @param {...Child} words
 */
export const hidden = (...words) => h("span", { class: "unseen" }, ...words);

/**
 * Return the element of an id, which the page has.
 * @param {string} id
 */
export function byId(id) {
  const node = document.getElementById(id);
  if (!node) throw new Error(`the page has no element ${id}`);
  return node;
}

/**
 * Set the focus on the first element that fits a selector, if there is one.
 * @param {ParentNode} place
 * @param {string} selector
 */
export function focusOn(place, selector) {
  const node = place.querySelector(selector);
  if (node instanceof HTMLElement || node instanceof SVGElement) node.focus();
}
