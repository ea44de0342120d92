// What can be taken along: the design as check reads it, the table as CSV.

import { plain, save } from "./dom.js";

const FORMULA = /^'*[=+\-@\t\r\uff1d\uff0b\uff0d\uff20]/;
const NUMBER = /^[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?$/;

/**
 * Return a value as YAML; what is JSON is YAML as well.
 * @param {unknown} told
 * @param {string} indent
 * @returns {string}
 */
function value(told, indent) {
  if (told === null || typeof told !== "object") return ` ${JSON.stringify(told)}\n`;
  const entries = Object.entries(told);
  if (Array.isArray(told) || !entries.length) return ` ${JSON.stringify(told)}\n`;
  const name = (/** @type {string} */ key) => (/^[A-Za-z_]\w*$/.test(key) ? key : JSON.stringify(key));
  const lines = entries.map(([key, inner]) => `${indent}${name(key)}:${value(inner, `${indent}  `)}`);
  return `\n${lines.join("")}`;
}

/**
 * Return the text of a DESIGN.yaml, as `clutchsynth check` reads it.
 * @param {import("./record.js").FrontRecord} record
 * @param {number} i
 */
export function designText(record, i) {
  const d = record.designs[i];
  const parts = Object.fromEntries(Object.entries(d.parts).map(([slot, key]) => [slot, record.parts[key].name]));
  const spec = record.families?.find((family) => family.name === d.family)?.spec ?? record.spec;
  return value({ ...spec, values: d.spec, parts }, "").slice(1);
}

/** @param {string | number | null | undefined} told */
function cell(told) {
  if (told === null || told === undefined) return "";
  if (typeof told === "number") return String(told);
  const text = plain(told);
  const safe = text.length > 1 && FORMULA.test(text) && !NUMBER.test(text) ? `'${text}` : text;
  return /[",\n\r]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/**
 * Return the designs that are shown as CSV, all columns.
 * @param {import("./explorer.js").Explorer} x
 */
export function tableText(x) {
  const { model } = x;
  const head = ["rank", "note", ...model.columns.map((c) => (c.unit ? `${c.label} [${c.unit}]` : c.label))];
  const rows = model.record.designs.map((d, i) => [d.rank, d.note, ...model.columns.map((c) => c.values[i])]);
  const kept = rows.filter((_, i) => x.shown(i));
  return [head, ...kept].map((row) => row.map(cell).join(",")).join("\r\n") + "\r\n";
}

/**
 * Hand over the design that is chosen.
 * @param {import("./explorer.js").Explorer} x
 * @param {number} i
 */
export const saveDesign = (x, i) =>
  save(
    `design_${String(x.model.record.designs[i].rank).padStart(2, "0")}.yaml`,
    designText(x.model.record, i),
    "text/yaml",
  );

/**
 * Hand over the table.
 * @param {import("./explorer.js").Explorer} x
 */
export const saveTable = (x) => save("designs.csv", `\ufeff${tableText(x)}`, "text/csv");
