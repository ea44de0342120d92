// What follows from a record alone: columns, groups, which axes are worth showing, and the designs with names.

import { number } from "./numbers.js";

const FAMILY = "family"; // column of what compares several
const MOST_GROUPS = 6; // with a colour and a shape each; the rest is told as others

/**
 * @typedef {import("./record.js").FrontRecord} FrontRecord
 * @typedef {import("./record.js").Design} Design
 * @typedef {import("./record.js").Column} Column
 * @typedef {import("./record.js").NumberColumn} NumberColumn
 * @typedef {import("./record.js").WordColumn} WordColumn
 * @typedef {import("./record.js").Model} Model
 */

const distinct = (/** @type {unknown[]} */ values) => new Set(values).size;
const mean = (/** @type {number[]} */ values) => values.reduce((sum, x) => sum + x, 0) / (values.length || 1);

/**
 * Return the columns of a record: quantities in order, then words.
 * @param {FrontRecord} record
 * @returns {Column[]}
 */
function columnsOf(record) {
  const { designs, quantities } = record;
  /** @type {Column[]} */
  const made = quantities.map((q, k) => {
    const kind = q.name in record.objectives ? "objective" : q.kind;
    const values = designs.map((d) => d.v[k]);
    return { key: q.name, label: q.label, unit: q.unit, text: q.text, kind, values, varies: false };
  });
  if (designs.some((d) => d.robust && d.robust.yield !== null)) {
    const values = designs.map((d) => d.robust?.yield ?? null);
    made.push({
      key: "robust:yield",
      label: "yield",
      unit: "%",
      text: "Share of what scatters in which all limits hold, estimated unless it is 100 %",
      kind: "robust",
      values,
      varies: false,
    });
  }
  /**
   * @param {string} group
   * @param {string} name
   * @param {(design: Design) => string} value
   * @returns {WordColumn}
   */
  const words = (group, name, value) => ({
    key: `${group}:${name}`,
    label: name.replaceAll("_", " "),
    unit: "",
    text: "",
    kind: "word",
    values: designs.map(value),
    varies: false,
  });
  if (record.families) {
    const titles = new Map(record.families.map((family) => [family.name, family.title]));
    made.unshift({ ...words("", FAMILY, (d) => titles.get(d.family ?? "") ?? d.family ?? ""), key: FAMILY });
  }
  const all = (/** @type {"parts" | "choices"} */ group) => [...new Set(designs.flatMap((d) => Object.keys(d[group])))];
  for (const slot of all("parts")) made.push(words("part", slot, (d) => record.parts[d.parts[slot]]?.name ?? ""));
  for (const name of all("choices")) made.push(words("choice", name, (d) => d.choices[name] ?? ""));
  for (const column of made) column.varies = distinct(column.values) > 1;
  return made;
}

/**
 * Return the place of every value in their order.
 * @param {(number | null)[]} values
 */
function ranksOf(values) {
  /** @type {number[]} */
  const ranks = [];
  values
    .map((v, i) => [v ?? 0, i])
    .sort((a, b) => a[0] - b[0])
    .forEach(([, i], rank) => {
      ranks[i] = rank;
    });
  return ranks;
}

/**
 * Return whether two columns put designs into the same order, or the reverse.
 * @param {NumberColumn} a
 * @param {NumberColumn} b
 */
function alike(a, b) {
  const [p, q] = [ranksOf(a.values), ranksOf(b.values)];
  const middle = (p.length - 1) / 2;
  let both = 0;
  let own = 0;
  p.forEach((rank, i) => {
    both += (rank - middle) * (q[i] - middle);
    own += (rank - middle) ** 2;
  });
  return own > 0 && Math.abs(both / own) > 0.96;
}

/**
 * Return columns that are worth an axis each: those that must be there, then such that tell something else.
 * @param {NumberColumn[]} first
 * @param {NumberColumn[]} rest
 * @param {number} room
 */
export function tellingColumns(first, rest, room) {
  const found = first.slice(0, room);
  for (const column of rest) {
    if (found.length >= room) break;
    if (!found.some((other) => alike(column, other))) found.push(column);
  }
  return found;
}

/**
 * Return how much better objectives are told apart by a column's words than by chance.
 * @param {WordColumn} column
 * @param {NumberColumn[]} objectives
 */
function telling(column, objectives) {
  /** @type {Map<string, number[]>} */
  const groups = new Map();
  column.values.forEach((word, i) => groups.set(word, [...(groups.get(word) ?? []), i]));
  const n = column.values.length;
  const shares = objectives.map(({ values }) => {
    const ranks = ranksOf(values);
    const all = mean(ranks);
    const total = ranks.reduce((sum, r) => sum + (r - all) ** 2, 0) || 1;
    let between = 0;
    for (const members of groups.values()) between += members.length * (mean(members.map((i) => ranks[i])) - all) ** 2;
    return between / total;
  });
  return mean(shares) - (groups.size - 1) / Math.max(1, n - 1) - (groups.size > MOST_GROUPS ? 0.3 : 0);
}

/**
 * Group designs by the words of a column; the most frequent ones get a colour and a shape.
 * @param {Column | undefined} column
 * @param {number} count of designs
 * @returns {import("./record.js").Groups}
 */
export function grouping(column, count) {
  if (!column) return { names: [], of: new Array(count).fill(0), rest: -2 };
  /** @type {Map<string | number | null, number>} */
  const counts = new Map();
  const often = (/** @type {string | number | null} */ word) => counts.get(word) ?? 0;
  for (const word of column.values) counts.set(word, often(word) + 1);
  const ranked = [...counts.keys()].sort((a, b) => often(b) - often(a) || String(a).localeCompare(String(b)));
  const named = ranked
    .slice(0, ranked.length > MOST_GROUPS ? MOST_GROUPS - 1 : MOST_GROUPS)
    .sort((a, b) => (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b))));
  const rest = ranked.length > named.length;
  const names = named.map((word) => (typeof word === "number" ? number(word) : String(word)));
  if (rest) names.push("others");
  const place = new Map(named.map((word, k) => [word, k]));
  return { names, of: column.values.map((word) => place.get(word) ?? named.length), rest: rest ? named.length : -1 };
}

/**
 * Return the names that designs have: the knee, and the best of each objective.
 * @param {FrontRecord} record
 * @param {NumberColumn[]} objectives
 */
function namesOf(record, objectives) {
  const names = record.designs.map((d) => (d.note.includes("knee") ? ["knee"] : []));
  for (const column of objectives) {
    const least = record.objectives[column.key] === "min";
    let best = 0;
    column.values.forEach((v, i) => {
      const than = column.values[best];
      if (v !== null && (than === null || (least ? v < than : v > than))) best = i;
    });
    if (record.designs.length > 1) names[best]?.push(`${least ? "smallest" : "largest"} ${column.label}`);
  }
  return names;
}

/**
 * Return what finds an axis.
 * @param {NumberColumn[]} axes
 */
const finder = (axes) => (/** @type {string} */ key) => {
  const found = axes.find((c) => c.key === key);
  if (!found) throw new Error(`there is no axis ${key}`);
  return found;
};

/**
 * Return everything that follows from a record, and from nothing else.
 * @param {FrontRecord} record as reports/explorer/record.py makes it
 * @returns {Model}
 */
export function modelOf(record) {
  const columns = columnsOf(record);
  const byKey = new Map(columns.map((c) => [c.key, c]));
  const numbers = columns.filter((c) => c.kind !== "word");
  const objectives = numbers.filter((c) => c.kind === "objective");
  const count = record.designs.length;
  const numeric = numbers.filter((c) => c.values.some((v) => v !== null));
  const varying = numeric.filter((c) => c.varies || c.kind === "objective");
  const sizes = varying.filter((c) => c.kind === "variable" || c.kind === "count" || c.kind === "robust");
  const derived = varying.filter((c) => c.kind === "derived");
  const candidates = columns.filter((c) => {
    const different = distinct(c.values);
    return (c.kind === "word" && different > 1) || (c.kind === "count" && different > 1 && different <= MOST_GROUPS);
  });
  const scored = candidates.filter((c) => c.kind === "word").map((column) => ({ column, telling: telling(column, objectives) }));
  scored.sort((a, b) => b.telling - a.telling);
  const words = columns.filter((c) => c.kind === "word").filter((c) => c.varies);
  const axes = [...objectives, ...sizes, ...derived];
  return {
    record,
    count,
    columns,
    column: (key) => byKey.get(key),
    axis: finder(axes),
    objectives,
    axes,
    sizes,
    derived,
    words,
    same: columns.filter((c) => !c.varies && c.kind !== "objective" && c.values[0] !== null && count > 1),
    groupable: candidates,
    groupBy: byKey.get(FAMILY)?.varies ? FAMILY : (scored[0]?.column.key ?? ""),
    names: namesOf(record, objectives),
    knee: record.designs.findIndex((d) => d.note.includes("knee")),
  };
}

/**
 * Return the model of a record without designs, with the columns of another one: so that there are axes to draw on.
 * @param {FrontRecord} record
 * @param {Model} like
 * @returns {Model}
 */
export function emptyModel(record, like) {
  /**
   * @template {Column} C
   * @param {C[]} columns
   */
  const of = (columns) => columns.map((c) => ({ ...c, values: [], varies: false }));
  const [columns, axes, groupable] = [of(like.columns), of(like.axes), of(like.groupable)];
  const objectives = axes.filter((c) => c.kind === "objective");
  const none = { sizes: [], derived: [], words: [], same: [], names: [], count: 0, knee: -1 };
  const byKey = new Map(columns.map((c) => [c.key, c]));
  const column = (/** @type {string} */ key) => byKey.get(key);
  return { record, columns, column, axis: finder(axes), objectives, axes, groupable, groupBy: like.groupBy, ...none };
}
