// What was asked, shown in the units in which it was typed: the engine tells it in those that the family declares.

import { figure, unitText, words } from "./dom.js";
import { FULL_DIGITS } from "./numbers.js";
import { quantity } from "./what_if_knobs.js";

/** @param {string | null} unit */
const bare = (unit) => unitText(unit).replaceAll(/[\s·]/g, "");

/**
 * Return a record of the explorer that tells requirements as they were typed.
 * @param {import("../../../../reports/explorer/record.js").FrontRecord} record
 * @param {Record<string, string | number> | undefined} typed requirements as a spec states them
 */
export function asTyped(record, typed) {
  const stated = new Map(Object.entries(typed ?? {}).map(([name, value]) => [words(name), value]));
  const asked = record.asked.map((entry) => {
    const own = entry.words === undefined && typeof stated.get(entry.label) === "string" ? quantity(stated.get(entry.label), "") : null;
    if (!own?.unit || bare(own.unit) === bare(entry.unit)) return entry;
    const told = `${figure(own.number, FULL_DIGITS)} ${unitText(own.unit)}`;
    return { ...entry, words: told, text: [entry.text, `that is ${figure(entry.value, FULL_DIGITS)} ${entry.unit}`].filter(Boolean).join("; ") };
  });
  return { ...record, asked };
}
