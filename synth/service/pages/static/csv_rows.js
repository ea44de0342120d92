// Tables that the service hands out as CSV: numbers are in the units of their headings.

import { API } from "./api.js";
import { cellsOf, headingOf } from "./csv.js";
import { amount, h, unitText, words } from "./dom.js";

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

const isNumber = (cell) => cell !== "" && cell !== null && cell !== undefined && Number.isFinite(Number(cell));
const shortened = (cell) => amount(Number(Number(cell).toPrecision(4)));

/**
 * Return a table as people read it.
 * @param {string} label
 * @param {{title: string | Node, unit?: string, cell: (row: object) => unknown, words?: boolean, long?: boolean, right?: boolean}[]} columns
 * @param {object[]} rows
 * @param {(row: object) => string} [kind] class of a row
 */
export function tableView(label, columns, rows, kind = () => "") {
  const cells = rows.map((row) => columns.map((column) => column.cell(row)));
  const right = columns.map((column, k) => column.right || !column.words && !column.long && cells.some((line) => isNumber(line[k])));
  const shown = (value, k) => (value === null || value === undefined || value === "" ? "–" : value instanceof Node || Array.isArray(value) ? value : right[k] && isNumber(value) ? shortened(value) : words(value));
  return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, h("table", { class: "found" }, h("caption", { class: "unseen" }, label),
    h("thead", {}, h("tr", {}, columns.map(({ title, unit }, k) => h("th", { scope: "col", class: right[k] ? "right" : "" }, title, unitText(unit) ? h("span", { class: "unit" }, ` ${unitText(unit)}`) : null)))),
    h("tbody", {}, cells.map((line, i) => h("tr", { class: kind(rows[i]) || null }, line.map((value, k) => (k === 0 ? h("th", { scope: "row", class: right[k] ? "right" : "" }, shown(value, k)) : h("td", { class: right[k] ? "right" : columns[k].long ? "long" : columns[k].words ? "words" : "" }, shown(value, k)))))))));
}
