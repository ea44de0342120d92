// What can be varied of a study, and along which values: from what was asked, what its family declares and what was found.

import { figure, unitText, words } from "./dom.js";
import { FULL_DIGITS } from "./numbers.js";

const NUMBER = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?:\s+((?:1\/)?[^\d\s].*?)|([^\d\s].*?))?\s*$/i; // 1/min begins with a digit
const LIMIT = /^\s*(<=|>=)\s*(.+)$/;
const OFFSET = /deg[CF]/; // units that no factor turns into others
const STEPS = 60; // of a track, about
const SPAN = [0.5, 2]; // of the value that was asked
const AROUND = [0.6, 1.1]; // of the least and the largest value on the front, where no limit was asked
const FILLED = 11; // values of the study that fills a track
/** @type {Record<string, string>} */
const SIGNS = { "<=": "at most", ">=": "at least" };

/**
 * @typedef {import("./records.js").DeclarationRow} DeclarationRow
 * @typedef {import("./records.js").Patch} Patch
 * @typedef {object} Knob
 * @property {string} key what stands in addresses
 * @property {string} vary what a study of it varies
 * @property {string} label
 * @property {string} group under which it is offered
 * @property {string} text what it means
 * @property {string} unit
 * @property {"" | "<=" | ">="} sign of a limit
 * @property {number | null} base the value that was asked; null where none was
 * @property {[number, number]} bounds of what may be typed
 * @property {(number | null)[]} values along the track
 */

/**
 * Return a number and its unit; null where a value is no number.
 * @param {unknown} value
 * @param {string} declared unit
 */
export function quantity(value, declared) {
  if (typeof value === "number") return { number: value, unit: declared };
  const found = typeof value === "string" ? NUMBER.exec(value) : null;
  return found ? { number: Number(found[1]), unit: found[2] ?? found[3] ?? declared } : null;
}

/**
 * Return what can be varied.
 * @param {import("./records.js").Spec} request of the study
 * @param {DeclarationRow[]} rows that its family declares
 * @param {Record<string, string>} read how requirements were understood, in declared units
 * @param {import("../../../../reports/explorer/record.js").FrontRecord} record what the explorer shows
 * @returns {Knob[]}
 */
export function knobsOf(request, rows, read, record) {
  /** @type {Knob[]} */
  const found = [];
  const typed = Object.keys(request.requirements ?? {}); // in this order, before those at their defaults
  const place = (/** @type {DeclarationRow} */ row) => (typed.includes(row.name) ? typed.indexOf(row.name) : typed.length);
  for (const row of rows.filter((row) => row.kind === "requirement").sort((a, b) => place(a) - place(b))) {
    const stated = request.requirements?.[row.name];
    const asked = quantity(stated ?? row.default, row.unit);
    if (!asked || asked.number === 0) continue;
    const scale = asked.unit === row.unit ? 1 : OFFSET.test(asked.unit + row.unit) ? NaN : asked.number / (quantity(read[row.name] ?? "", row.unit)?.number ?? NaN);
    /** @type {[number, number]} */
    const bounds = Number.isFinite(scale) ? [(row.lower ?? -Infinity) * scale, (row.upper ?? Infinity) * scale] : [-Infinity, Infinity];
    const group = stated === undefined ? "Assumptions" : "Requirements";
    found.push(knob({ ...asked, bounds, group, key: row.name, vary: row.name, sign: "", label: words(row.name), text: row.text }));
  }
  for (const [name, told] of Object.entries(request.limits ?? {})) {
    const [, sign, value] = LIMIT.exec(told) ?? [];
    const row = rows.find((row) => row.name === name);
    const asked = value && quantity(value, row?.unit ?? "-");
    if (asked && asked.number !== 0) found.push(limit(name, sign === ">=" ? ">=" : "<=", "Limits", row, asked));
  }
  record.quantities.forEach((own, k) => {
    const row = rows.find((row) => row.name === own.name && row.kind !== "limit" && row.kind !== "objective");
    const values = record.designs.flatMap(({ v }) => v[k] ?? []).filter((value) => value > 0);
    const objective = own.name in record.objectives;
    if (!row || !values.length || row.kind === "count" || request.limits?.[own.name] !== undefined || request.fix?.[own.name] !== undefined) return;
    const [least, most] = [Math.min(...values), Math.max(...values)];
    if (!objective && !(most > 1.001 * least)) return;
    const sign = record.objectives[own.name] === "max" ? ">=" : "<=";
    const ends = sign === "<=" ? [AROUND[0] * least, AROUND[1] * most] : [least / AROUND[1], most / AROUND[0]];
    found.push(limit(own.name, sign, objective ? "Limits of what is made small or large" : "Other limits", row, { number: null, unit: row.unit, ends }));
  });
  const order = ["Requirements", "Limits", "Limits of what is made small or large", "Assumptions", "Other limits"];
  return found.sort((a, b) => order.indexOf(a.group) - order.indexOf(b.group));
}

/**
 * @param {string} name
 * @param {"<=" | ">="} sign
 * @param {string} group
 * @param {DeclarationRow | undefined} row
 * @param {{number: number | null, unit: string, ends?: number[]}} asked
 */
const limit = (name, sign, group, row, asked) =>
  knob({ ...asked, group, key: `${name}${sign}`, vary: `${name} ${sign}`, sign, label: `${words(name)} ${SIGNS[sign]}`, text: row?.text ?? "", bounds: [-Infinity, Infinity] });

/**
 * @param {Omit<Knob, "base" | "values"> & {number: number | null, ends?: number[]}} what
 * @returns {Knob}
 */
function knob({ number, unit, bounds, ends, ...rest }) {
  const span = ends ?? SPAN.map((share) => share * (number ?? NaN)).sort((a, b) => a - b);
  const [low, high] = [Math.max(span[0], bounds[0]), Math.min(span[1], bounds[1])];
  const track = trackOf(low, high, number);
  const values = number !== null ? track : rest.sign === ">=" ? [null, ...track] : [...track, null];
  return { ...rest, unit, bounds, base: number, values };
}

/**
 * Return round values between two ends, with one more that must be among them.
 * @param {number} low
 * @param {number} high
 * @param {number | null} base
 */
function trackOf(low, high, base) {
  const rough = (high - low) / STEPS, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((k) => k * power).find((k) => k >= rough * 0.999) ?? NaN;
  const values = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-12); k += 1) values.push(Number((k * step).toPrecision(12)));
  if (base !== null && !values.includes(base)) values.push(base);
  return values.sort((a, b) => a - b);
}

/**
 * Return a value as people read it.
 * @param {Knob} knob
 * @param {number | null} value
 */
export const shown = (knob, value) => (value === null ? "no limit" : `${figure(value, FULL_DIGITS)} ${unitText(knob.unit)}`.trim());

/**
 * Return a value as a spec states it.
 * @param {Knob} knob
 * @param {number} value
 */
export const stated = (knob, value) => (knob.unit && knob.unit !== "-" ? `${value} ${knob.unit}` : value);

/**
 * Return what changes of a spec where knobs stand at these values.
 * @param {[Knob, number][]} moved
 */
export function patchOf(moved) {
  /** @type {Patch} */
  const patch = {};
  for (const [knob, value] of moved) {
    const [section, told] = knob.sign ? ["limits", `${knob.sign} ${stated(knob, value)}`] : ["requirements", stated(knob, value)];
    patch[section] = { ...patch[section], [knob.key.replace(/[<>]=$/, "")]: told };
  }
  return patch;
}

/**
 * Return at which values knobs must stand for what a patch says; null where it says something else as well.
 * @param {Patch} patch
 * @param {Knob[]} knobs
 * @returns {[Knob, number][] | null}
 */
export function valuesOf(patch, knobs) {
  /** @type {[Knob, number][]} */
  const found = [];
  for (const [section, entries] of Object.entries(patch)) {
    for (const [name, told] of Object.entries(entries)) {
      const [, sign = "", value = told] = section === "limits" ? LIMIT.exec(String(told)) ?? [] : [];
      const own = knobs.find((knob) => knob.key === name + sign);
      const asked = own && quantity(value, own.unit);
      if (!asked || asked.unit !== own.unit || !["requirements", "limits"].includes(section)) return null;
      found.push([own, asked.number]);
    }
  }
  return found.length ? found : null;
}

/**
 * Return the values along a track that are numbers.
 * @param {Knob} knob
 */
export const numbersOf = (knob) => knob.values.filter((value) => value !== null);

/**
 * Return what a study that fills the track of a knob varies.
 * @param {Knob} knob
 */
export function filling(knob) {
  const values = numbersOf(knob), low = values[0], high = values[values.length - 1];
  const spread = Array.from({ length: FILLED }, (_, k) => Number((low + ((high - low) * k) / (FILLED - 1)).toPrecision(6)));
  return { [knob.vary]: spread.map((value) => stated(knob, value)) };
}
