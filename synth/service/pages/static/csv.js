// Tables as CSV, read and shown.

import { amount, h, unitText, words } from "./dom.js";

/** Return the lines of a CSV text, each as its cells. */
export function cellsOf(text) {
  const lines = [[]];
  for (const [, quoted, plain, end] of text.replace(/^\ufeff/, "").matchAll(/(?:"((?:[^"]|"")*)"|([^,"\r\n]*))(,|\r?\n|$)/g)) {
    lines.at(-1).push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
    if (end === "") break;
    if (end !== ",") lines.push([]);
  }
  return lines.filter((line) => line.some((cell) => cell !== ""));
}

/** Return a heading such as `mass [kg]` as name and unit. */
export function headingOf(text) {
  const [, name, unit = ""] = /^(.*?)(?: \[([^\]]*)\])?$/s.exec(text);
  return { name, unit: unit === "-" ? "" : unit };
}

const LONG = 40; // letters of a cell that needs room
const NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;
export const isNumber = (text) => NUMBER.test(text);

/** Return a cell; a long text in two lines, whole where one points. */
export const short = (text) => (String(text).length > LONG ? h("span", { class: "clamped", title: text }, text) : text);

/**
 * Return a table of CSV lines: the first are headings; numbers stand to the right.
 * @param {string[][]} lines
 * @param {{label: string, caption?: string, most?: number, cell?: (text: string, name: string, line: string[]) => Node | string | null, tone?: (name: string, line: string[]) => string}} how
 */
export function sheet([header, ...rows], { label, caption, most = 300, cell, tone }) {
  const heads = header.map(headingOf);
  const right = heads.map(({ name }, k) => name !== "line" && rows.some((row) => row[k]) && rows.every((row) => !row[k] || isNumber(row[k])));
  const shown = rows.slice(0, most);
  const said = [caption, shown.length < rows.length ? `the first ${amount(shown.length)} of ${amount(rows.length)} rows` : ""].filter(Boolean).join("; ");
  const text = (row, k) => cell?.(row[k] ?? "", heads[k].name, row) ?? (right[k] && row[k] ? amount(Number(row[k])) : short(row[k] ?? ""));
  return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, h("table", { class: "sheet" }, said ? h("caption", {}, said) : null,
    h("thead", {}, h("tr", {}, heads.map(({ name, unit }, k) => h("th", { scope: "col", class: right[k] ? "right" : "" }, words(name), unit ? h("span", { class: "unit" }, ` ${unitText(unit)}`) : null)))),
    h("tbody", {}, shown.map((row) => h("tr", {}, heads.map(({ name }, k) => h(k ? "td" : "th", { scope: k ? null : "row", class: [right[k] ? "right" : (row[k] ?? "").length > LONG ? "long" : "", tone?.(name, row) ?? ""].join(" ").trim() }, text(row, k))))))));
}
