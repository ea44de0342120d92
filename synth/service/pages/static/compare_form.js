// Several families asked the same: what they understand in common as one form, and which of them can serve it.

import { h, words } from "./dom.js";

/**
 * @typedef {import("./answers.js").FamilyAnswer} Family
 * @typedef {import("./records.js").DeclarationRow} DeclarationRow
 * @typedef {{name: string, rows: DeclarationRow[]}} Declaration
 */

/** The name of the choice, as a spec states it. */
export const ANY = "any";
const FEW = 2; // names that are told one by one

/**
 * Return the end of a range that holds two; null where one of them has no end.
 * @param {(...ends: number[]) => number} which
 * @param {number | null} a
 * @param {number | null} b
 */
const widest = (which, a, b) => (a === null || b === null ? null : which(a, b));

/**
 * Return what several families declare as one declaration: the requirements that mean the same in each.
 * @param {Family[]} families
 * @param {Map<string, Declaration>} declarations by name
 * @returns {Declaration}
 */
export function together(families, declarations) {
  /** @type {Map<string, DeclarationRow & {who: string[], sections: Set<string>, defaults: Set<string | number | null>}>} */
  const found = new Map();
  /** @type {Map<string, DeclarationRow & {who: string[]}>} */
  const objectives = new Map();
  for (const family of families) {
    const rows = declarations.get(family.name)?.rows ?? [];
    for (const name of family.understands) {
      const row = rows.find((row) => row.kind === "requirement" && row.name === name);
      if (!row) continue;
      const own = found.get(name) ?? { ...row, who: [], sections: new Set(), defaults: new Set() };
      own.who.push(family.title);
      own.sections.add(row.section);
      own.defaults.add(row.default);
      if (own.unit === row.unit) [own.lower, own.upper] = [widest(Math.min, own.lower, row.lower), widest(Math.max, own.upper, row.upper)];
      found.set(name, own);
    }
    for (const row of rows.filter((row) => row.section === "objective")) {
      const own = objectives.get(row.name) ?? { ...row, default: "no", who: [] };
      own.who.push(family.title);
      objectives.set(row.name, own);
    }
  }
  const told = [...found.values()].sort((a, b) => b.who.length - a.who.length).map(({ who, sections, defaults, ...row }) => ({
    ...row,
    section: sections.has("needed") ? "duty" : sections.has("assumption") ? "assumption" : "limit",
    default: defaults.size === 1 ? row.default : null,
    source: who.length === families.length ? "understood by all" : `understood by ${who.length} of ${families.length}: ${who.join(", ")}`,
  }));
  const common = [...objectives.values()].filter(({ who }) => who.length > 1).sort((a, b) => b.who.length - a.who.length);
  return { name: ANY, rows: [...told, ...common] };
}

/**
 * Return why a family cannot serve what is asked; empty where it can.
 * @param {Family} family
 * @param {Declaration} declaration
 * @param {string[]} asked names of requirements
 */
function misfit(family, declaration, asked) {
  const strange = asked.filter((name) => !family.understands.includes(name));
  const lacking = declaration.rows.filter((row) => row.section === "needed" && !asked.includes(row.name)).map((row) => row.name);
  return [strange.length ? `does not know ${few(strange)}` : "", lacking.length ? `needs ${few(lacking)}` : ""].filter(Boolean).join("; ");
}

/** @param {string[]} names */
const few = (names) => (names.length > FEW ? `${words(names[0])} and ${names.length - 1} more` : names.map(words).join(", "));

/**
 * Make the choice of families.
 * @param {Family[]} families
 * @param {Set<string>} chosen
 * @param {() => void} changed
 */
export function choiceOf(families, chosen, changed) {
  const notes = new Map(families.map((family) => [family.name, h("span", { class: "note" })]));
  const summary = h("p", { class: "note", role: "status" });
  const box = (/** @type {Family} */ family) => h("label", { title: family.line }, h("input", { type: "checkbox", name: "families", value: family.name, checked: chosen.has(family.name), onchange: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => {
    if (event.target.checked) chosen.add(family.name);
    else chosen.delete(family.name);
    changed();
  } }), h("span", {}, family.title, notes.get(family.name)));
  const element = h("div", { class: "several" }, h("div", { class: "families", role: "group", "aria-label": "Families that are compared" }, families.map(box)), summary);
  return {
    element,
    /**
     * Show who can serve what is asked.
     * @param {Map<string, Declaration>} declarations
     * @param {string[]} asked
     */
    show(declarations, asked) {
      let able = 0;
      for (const family of families) {
        const note = notes.get(family.name), declaration = declarations.get(family.name);
        const why = chosen.has(family.name) && asked.length && declaration ? misfit(family, declaration, asked) : "";
        const fits = chosen.has(family.name) && asked.length > 0 && !why;
        able += Number(fits);
        if (!note) continue;
        note.textContent = fits ? "✓ can serve this" : why;
        note.classList.toggle("good", fits);
      }
      summary.textContent = asked.length ? `${able} of ${chosen.size} can serve what is asked; the others are told with the reason.` : "All are asked the same; those that cannot serve it are told with the reason.";
    },
  };
}
