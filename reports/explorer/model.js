// What follows from a record alone: columns, groups, which axes are worth showing, and the designs with names.

import { number } from "./numbers.js";

const FAMILY = "family"; // column of what compares several
const MOST_GROUPS = 6; // with a colour and a shape each; the rest is told as others

/**
 * @typedef {object} Column
 * @property {string} key
 * @property {string} label
 * @property {string} unit
 * @property {string} text what it means
 * @property {"objective" | "variable" | "count" | "derived" | "robust" | "word"} kind
 * @property {(number | string | null)[]} values one for each design
 * @property {boolean} varies
 */

const distinct = (values) => new Set(values).size;
const mean = (values) => values.reduce((sum, x) => sum + x, 0) / (values.length || 1);

/**
 * Return the columns of a record: quantities in order, then words.
 * @param {object} record
 * @returns {Column[]}
 */
function columnsOf(record) {
  const { designs, quantities } = record;
  const made = quantities.map((q, k) => {
    const kind = q.name in record.objectives ? "objective" : q.kind;
    return { key: q.name, label: q.label, unit: q.unit, text: q.text, kind, values: designs.map((d) => d.v[k]) };
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
    });
  }
  const words = (group, name, value) => ({
    key: `${group}:${name}`,
    label: name.replaceAll("_", " "),
    unit: "",
    text: "",
    kind: "word",
    values: designs.map(value),
  });
  if (record.families) {
    const titles = new Map(record.families.map((family) => [family.name, family.title]));
    made.unshift({ ...words("", FAMILY, (d) => titles.get(d.family) ?? d.family), key: FAMILY });
  }
  const all = (group) => [...new Set(designs.flatMap((d) => Object.keys(d[group])))];
  for (const slot of all("parts")) made.push(words("part", slot, (d) => record.parts[d.parts[slot]]?.name ?? ""));
  for (const name of all("choices")) made.push(words("choice", name, (d) => d.choices[name] ?? ""));
  for (const column of made) column.varies = distinct(column.values) > 1;
  return made;
}

/** Return the place of every value in their order. */
function ranksOf(values) {
  const ranks = [];
  values
    .map((v, i) => [v ?? 0, i])
    .sort((a, b) => a[0] - b[0])
    .forEach(([, i], rank) => {
      ranks[i] = rank;
    });
  return ranks;
}

/** Return whether two columns put designs into the same order, or the reverse. */
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
 * @param {Column[]} first
 * @param {Column[]} rest
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

/** Return how much better objectives are told apart by a column's words than by chance. */
function telling(column, objectives) {
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
 */
export function grouping(column, count) {
  if (!column) return { names: [], of: new Array(count).fill(0), rest: -2 };
  const counts = new Map();
  for (const word of column.values) counts.set(word, (counts.get(word) ?? 0) + 1);
  const ranked = [...counts.keys()].sort((a, b) => counts.get(b) - counts.get(a) || String(a).localeCompare(String(b)));
  const named = ranked
    .slice(0, ranked.length > MOST_GROUPS ? MOST_GROUPS - 1 : MOST_GROUPS)
    .sort((a, b) => (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b))));
  const rest = ranked.length > named.length;
  const names = named.map((word) => (typeof word === "number" ? number(word) : String(word)));
  if (rest) names.push("others");
  const place = new Map(named.map((word, k) => [word, k]));
  return { names, of: column.values.map((word) => place.get(word) ?? named.length), rest: rest ? named.length : -1 };
}

/** Return the names that designs have: the knee, and the best of each objective. */
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
 * Return everything that follows from a record, and from nothing else.
 * @param {object} record as reports/explorer/record.py makes it
 */
export function modelOf(record) {
  const columns = columnsOf(record);
  const byKey = new Map(columns.map((c) => [c.key, c]));
  const objectives = columns.filter((c) => c.kind === "objective");
  const count = record.designs.length;
  const numeric = columns.filter((c) => c.kind !== "word" && c.values.some((v) => v !== null));
  const varying = numeric.filter((c) => c.varies || c.kind === "objective");
  const sizes = varying.filter((c) => c.kind === "variable" || c.kind === "count" || c.kind === "robust");
  const derived = varying.filter((c) => c.kind === "derived");
  const candidates = columns.filter((c) => {
    const different = distinct(c.values);
    return (c.kind === "word" && different > 1) || (c.kind === "count" && different > 1 && different <= MOST_GROUPS);
  });
  const scored = candidates.filter((c) => c.kind === "word").map((c) => [telling(c, objectives), c]);
  scored.sort((a, b) => b[0] - a[0]);
  const words = columns.filter((c) => c.kind === "word" && c.varies);
  return {
    record,
    count,
    columns,
    column: (key) => byKey.get(key),
    objectives,
    axes: [...objectives, ...sizes, ...derived],
    sizes,
    derived,
    words,
    same: columns.filter((c) => !c.varies && c.kind !== "objective" && c.values[0] !== null && count > 1),
    groupable: candidates,
    groupBy: byKey.get(FAMILY)?.varies ? FAMILY : (scored[0]?.[1].key ?? ""),
    names: namesOf(record, objectives),
    knee: record.designs.findIndex((d) => d.note.includes("knee")),
  };
}

/**
 * Return the model of a record without designs, with the columns of another one: so that there are axes to draw on.
 * @param {object} record
 * @param {ReturnType<typeof modelOf>} like
 * @returns {ReturnType<typeof modelOf>}
 */
export function emptyModel(record, like) {
  const byKey = new Map(like.columns.map((c) => [c.key, { ...c, values: [], varies: false }]));
  const of = (columns) => columns.map((c) => byKey.get(c.key));
  const [objectives, axes, groupable] = [of(like.objectives), of(like.axes), of(like.groupable)];
  const none = { sizes: [], derived: [], words: [], same: [], names: [], count: 0, knee: -1 };
  const columns = [...byKey.values()];
  const column = (key) => byKey.get(key);
  return { record, columns, column, objectives, axes, groupable, groupBy: like.groupBy, ...none };
}
