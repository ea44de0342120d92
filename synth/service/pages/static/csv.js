// Tables as CSV, read and drawn. Those that the service hands out have numbers in the units of their headings.

import { API } from "./api.js";
import { figure, h, unitText, words } from "./dom.js";
import { FULL_DIGITS } from "./numbers.js";

/** @typedef {import("./dom.js").Child} Child */

/**
 * Return the lines of a CSV text, each as its cells; between them stands a comma, a semicolon or a tab.
 * @param {string} text
 */
export function cellsOf(text, separator = ",") {
  const cell = new RegExp(`(?:"((?:[^"]|"")*)"|([^${separator}"\\r\\n]*))(${separator}|\\r?\\n|$)`, "g");
  /** @type {string[][]} */
  const lines = [[]];
  for (const [, quoted, plain, end] of text.replace(/^\ufeff/, "").matchAll(cell)) {
    lines.at(-1)?.push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
    if (end === "") break;
    if (end !== separator) lines.push([]);
  }
  return lines.filter((line) => line.some((cell) => cell !== ""));
}

/**
 * Return a heading such as `mass [kg]` as name and unit.
 * @param {string} text
 */
export function headingOf(text) {
  const [, name, unit = ""] = /^(.*?)(?: \[([^\]]*)\])?$/s.exec(text) ?? ["", text];
  return { name, unit: unit === "-" ? "" : unit };
}

/**
 * Read the table of a job.
 * @param {string} job
 * @param {string} name of its file
 * @returns {Promise<{columns: {key: string, name: string, unit: string}[], rows: Record<string, string>[]}>}
 */
export async function tableOf(job, name) {
  const answer = await fetch(`${API}/jobs/${job}/files/${encodeURIComponent(name)}?raw=1`);
  if (!answer.ok) return { columns: [], rows: [] };
  const [head, ...lines] = cellsOf(await answer.text());
  const columns = (head ?? []).map((key) => ({ key, ...headingOf(key) }));
  return { columns, rows: lines.map((line) => Object.fromEntries(line.map((cell, k) => [head[k], cell]))) };
}

const LONG = 40; // letters of a cell that needs room
const NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;
/** @param {string} text */
export const isNumber = (text) => NUMBER.test(text);

/**
 * Return a cell; a long text in two lines, whole where one points.
 * @param {string} text
 */
export const short = (text) => (String(text).length > LONG ? h("span", { class: "clamped", title: text }, text) : text);

/**
 * Draw a table: headings with their units, and rows whose first cell is their heading.
 * @param {string} label
 * @param {{class: string, caption: Node | null, heads: {title: string | Node, unit?: string, right?: boolean}[], rows: {class?: string, cells: {class?: string, shown: Child}[]}[]}} what
 */
function drawn(label, { class: kind, caption, heads, rows }) {
  const side = (/** @type {number} */ k) => (heads[k].right ? "right" : "");
  return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, h("table", { class: kind }, caption,
    h("thead", {}, h("tr", {}, heads.map(({ title, unit }, k) => h("th", { scope: "col", class: side(k) }, title, unitText(unit) ? h("span", { class: "unit" }, ` ${unitText(unit)}`) : null)))),
    h("tbody", {}, rows.map((row) => h("tr", { class: row.class || null }, row.cells.map(({ class: tone = "", shown }, k) => h(k ? "td" : "th", { scope: k ? null : "row", class: `${side(k)} ${tone}`.trim() }, shown)))))));
}

/**
 * Return a table of CSV lines: the first are headings; numbers stand to the right.
 * @param {string[][]} lines
 * @param {{label: string, caption?: string, most?: number, cell?: (text: string, name: string, line: string[]) => Node | string | null, tone?: (name: string, line: string[]) => string}} how
 */
export function sheet([header, ...rows], { label, caption, most = 300, cell, tone }) {
  const heads = header.map(headingOf).map(({ name, unit }, k) => ({ name, title: words(name), unit, right: name !== "line" && rows.some((row) => row[k]) && rows.every((row) => !row[k] || isNumber(row[k])) }));
  const shown = rows.slice(0, most);
  const said = [caption, shown.length < rows.length ? `the first ${figure(shown.length)} of ${figure(rows.length)} rows` : ""].filter(Boolean).join("; ");
  /** @type {(row: string[], head: {name: string, right: boolean}, k: number) => Node | string} */
  const text = (row, { name, right }, k) => cell?.(row[k] ?? "", name, row) ?? (right && row[k] ? figure(Number(row[k]), FULL_DIGITS) : short(row[k] ?? ""));
  const cells = (/** @type {string[]} */ row) => heads.map((head, k) => ({ shown: text(row, head, k), class: [!head.right && (row[k] ?? "").length > LONG ? "long" : "", tone?.(head.name, row) ?? ""].join(" ").trim() }));
  return drawn(label, { class: "sheet", caption: said ? h("caption", {}, said) : null, heads, rows: shown.map((row) => ({ cells: cells(row) })) });
}

/** @param {unknown} cell */
const isAmount = (cell) => cell !== "" && cell !== null && cell !== undefined && Number.isFinite(Number(cell));
/** @param {unknown} cell */
const shortened = (cell) => figure(Number(cell));

/**
 * The number in a cell; null where it is empty.
 * @param {unknown} cell
 */
export const numberIn = (cell) => (isAmount(cell) ? Number(cell) : null);

/**
 * @template R
 * @typedef {{title: string | Node, unit?: string, cell: (row: R) => Child, words?: boolean, long?: boolean, right?: boolean}} FoundColumn
 */

/**
 * Return a table of what was found, as people read it.
 * @template R
 * @param {string} label
 * @param {FoundColumn<R>[]} columns
 * @param {R[]} rows
 * @param {(row: R) => string} [kind] class of a row
 */
export function tableView(label, columns, rows, kind = () => "") {
  const values = rows.map((row) => columns.map((column) => column.cell(row)));
  const heads = columns.map(({ title, unit, right, words: texts, long }, k) => ({ title, unit, right: right || !texts && !long && values.some((line) => isAmount(line[k])) }));
  /** @type {(value: Child, k: number) => Child} */
  const shown = (value, k) => (value === null || value === undefined || value === "" ? "–" : value instanceof Node || Array.isArray(value) ? value : heads[k].right && isAmount(value) ? shortened(value) : words(value));
  const tone = (/** @type {number} */ k) => (k === 0 || heads[k].right ? "" : columns[k].long ? "long" : columns[k].words ? "words" : "");
  const cells = (/** @type {Child[]} */ line) => line.map((value, k) => ({ shown: shown(value, k), class: tone(k) }));
  return drawn(label, { class: "found", caption: h("caption", { class: "unseen" }, label), heads, rows: rows.map((row, i) => ({ class: kind(row), cells: cells(values[i]) })) });
}
