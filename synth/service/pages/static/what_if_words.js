// What another value has changed, in one sentence: two records of the explorer against each other.

import { figure, words } from "./dom.js";
import { signed } from "./numbers.js";
import { count } from "./words.js";

/**
 * @typedef {import("../../../../reports/explorer/record.js").FrontRecord} FrontRecord
 * @typedef {import("../../../../reports/explorer/record.js").Design} Design
 */

const MOST = 3; // parts and counts that are named

/**
 * Return the design that stands for a front: its knee, else the first.
 * @param {FrontRecord} record
 */
const middle = (record) => record.designs.find((design) => design.note.includes("knee")) ?? record.designs[0];

/**
 * Return the design that is best in an objective.
 * @param {FrontRecord} record
 * @param {number} k
 * @param {string} sense
 */
function best(record, k, sense) {
  const side = sense === "min" ? 1 : -1;
  const of = (/** @type {Design} */ design) => side * (design.v[k] ?? NaN);
  return record.designs.reduce((a, b) => (of(b) < of(a) ? b : a));
}

/**
 * @param {number} before
 * @param {number} after
 * @param {string} unit
 */
function change(before, after, unit) {
  const part = before ? (100 * (after - before)) / Math.abs(before) : NaN;
  const share = Number.isFinite(part) ? ` (${signed(part, 2)} %)` : "";
  return `${figure(before)} → ${figure(after)}${unit ? ` ${unit}` : ""}${share}`;
}

/**
 * Return what a design is made of that another one is not.
 * @param {FrontRecord} record
 * @param {Design} design
 * @param {FrontRecord} before
 * @param {Design} other
 */
function made(record, design, before, other) {
  const told = [];
  for (const [slot, key] of Object.entries(design.parts)) {
    const name = record.parts[key]?.name ?? key, earlier = before.parts[other.parts[slot]]?.name ?? other.parts[slot];
    if (name !== earlier) told.push(`${name} as ${words(slot)}`);
  }
  for (const [name, word] of Object.entries(design.choices)) if (word !== other.choices[name]) told.push(`${words(word)} as ${words(name)}`);
  record.quantities.forEach((quantity, k) => {
    const earlier = before.quantities.findIndex((own) => own.name === quantity.name);
    if (quantity.kind === "count" && earlier >= 0 && design.v[k] !== other.v[earlier]) told.push(`${figure(design.v[k])} ${quantity.label} (${figure(other.v[earlier])} before)`);
  });
  return told;
}

/**
 * Return what differs between the front as asked and another one; both have designs.
 * @param {FrontRecord} asked
 * @param {FrontRecord} now
 */
export function difference(asked, now) {
  const [a, b] = [middle(asked), middle(now)];
  const knee = [a, b].every((design) => design.note.includes("knee")) ? " at the knee" : "";
  const parts = now.quantities.flatMap((quantity, k) => {
    if (!(quantity.name in now.objectives)) return [];
    const earlier = asked.quantities.findIndex((own) => own.name === quantity.name);
    if (earlier < 0 || a.v[earlier] === null || b.v[k] === null) return [];
    if (figure(a.v[earlier]) === figure(b.v[k])) return [`${quantity.label}${knee} as before`];
    return [`${quantity.label}${knee} ${change(a.v[earlier], b.v[k], quantity.unit)}`];
  });
  if (parts.length > 1 && knee) for (let k = 1; k < parts.length; k += 1) parts[k] = parts[k].replace(knee, "");
  const more = now.designs.length - asked.designs.length;
  if (more) parts.push(`${count(Math.abs(more), "design")} ${more > 0 ? "more" : "fewer"}`);
  const [first, sense] = Object.entries(now.objectives)[0];
  const [own, other] = [now, asked].map((record) => best(record, record.quantities.findIndex((quantity) => quantity.name === first), sense));
  const different = made(now, own, asked, other);
  const which = now.designs.length > 1 ? `the one of ${sense === "min" ? "least" : "most"} ${words(first)}` : "it";
  if (different.length) parts.push(`${which} has now ${listed(different.slice(0, MOST))}`);
  if (now.certificate.level !== "good" && asked.certificate.level === "good") parts.push("this front is not proven");
  return `${parts.join("; ")}.`;
}

/** @param {string[]} texts */
const listed = (texts) => (texts.length > 1 ? `${texts.slice(0, -1).join(", ")} and ${texts.at(-1)}` : texts[0]);
