// The families: what each declares, with the sources of its formulas.

import { faultCard, get, maySubmit, statusOf } from "./api.js";
import { allOf, byId, figure, h, symbol, unitText, words } from "./dom.js";
import { FULL_DIGITS } from "./numbers.js";
import { count } from "./words.js";

/** @typedef {import("./records.js").DeclarationRow} DeclarationRow */

const place = byId("families");
const SECTIONS = [
  ["needed", "Needed", "what a study must state"], ["limit", "Limits you may set", "asked only where they are stated"], ["assumption", "Assumptions", "each with a default and its source"],
  ["option", "Options", "how it is built and what it is judged by"], ["variable", "Sizes", "searched within their ranges"], ["count", "Counts", "whole numbers that are searched"], ["choice", "Choices", ""],
  ["part", "Parts", "rows of part tables"], ["objective", "Objectives", "what is made small or large"], ["derived", "What follows", "computed by formulas, each with its source"],
  ["kept", "Limits of the model", "what every design keeps"], ["column", "Columns of parts", "that formulas read; cells outside of their ranges are refused"], ["setting", "Settings of simulations", ""], ["refusal", "What is refused", ""], ["advice", "Advice", ""],
];
const TABLE = /^rows of (\w+)/;
/** @type {Record<string, string>} */
const CLASSES = { Meaning: "text", Source: "text note", Default: "default", "Range or choices": "choices" };
const HEADS = ["Name", "Unit", "Default", "Range or choices", "Meaning", "Source"];

async function begin() {
  try {
    if (place.dataset.family) declaration(await get(`/families/${place.dataset.family}`));
    else list((await get("/families")).families);
  } catch (error) {
    place.replaceChildren(statusOf(error) === 404 ? h("section", { class: "card stack" }, h("h1", {}, "No such family"), h("p", {}, h("a", { href: "/families" }, "To the families"))) : faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

/** @param {import("./answers.js").FamilyAnswer[]} families */
function list(families) {
  place.replaceChildren(h("h1", {}, "Families"), h("p", { class: "note lead" }, "What can be designed, and where its formulas come from."),
    h("ul", { class: "offers" }, families.map((family) => h("li", { class: "card stack" }, h("h2", {}, h("a", { href: `/families/${family.name}` }, family.title)), h("p", { class: "grow" }, family.line),
      h("p", { class: "note" }, `${count(family.sources.length, "source")} · ${count(family.options.length, "option")}`), maySubmit() ? h("p", {}, h("a", { class: "button small", href: `/new?family=${family.name}`, "aria-label": `New study: ${family.title}` }, "New study")) : null))));
}

/**
 * Where a row stands: limits that a model keeps are told apart from those that somebody may set.
 * @param {DeclarationRow} row
 */
const sectionOf = (row) => (row.kind === "limit" ? "kept" : row.section);

/** @param {import("./answers.js").DeclarationAnswer} family */
function declaration(family) {
  document.title = `${family.title} · clutchsynth`;
  const told = h("span", { class: "note", role: "status" });
  const find = h("input", { type: "search", class: "find", placeholder: "Find a name, a text, a source", "aria-label": "Find a name, a text or a source", oninput: () => {
    const wanted = find.value.toLowerCase(), lines = allOf(place, "tbody tr");
    for (const line of lines) line.hidden = !(line.textContent ?? "").toLowerCase().includes(wanted);
    for (const one of allOf(place, "section[data-section]")) one.hidden = Boolean(wanted) && !one.querySelector("tbody tr:not([hidden])");
    if (wanted) for (const one of place.querySelectorAll("details")) one.open = true;
    told.textContent = wanted ? `${lines.filter((line) => !line.hidden).length} found` : "";
  } });
  place.replaceChildren(h("p", { class: "note" }, h("a", { href: "/families" }, "Families")), h("div", { class: "heading" }, h("h1", {}, family.title), h("div", { class: "row" }, told, find, maySubmit() ? h("a", { class: "button primary", href: `/new?family=${family.name}` }, "New study") : null)),
    h("section", { class: "card" }, h("h2", {}, "Sources"), h("ul", { class: "sources" }, family.sources.map((source) => h("li", {}, source)))),
    ...SECTIONS.map(([name, title, hint]) => section(title, hint, family.rows.filter((row) => sectionOf(row) === name))).filter((one) => one !== null));
}

/**
 * @param {string} title
 * @param {string} hint
 * @param {DeclarationRow[]} rows
 */
function section(title, hint, rows) {
  if (!rows.length) return null;
  /** @param {string} head */
  const empty = (head) => rows.every((row) => cellOf(row)[head] === null);
  const heads = HEADS.filter((head) => head === "Name" || !empty(head));
  const groups = [...new Set(rows.map((row) => row.group ?? ""))];
  /** @param {string} group */
  const lines = (group) => rows.filter((row) => (row.group ?? "") === group).map((row) => h("tr", {}, heads.map((head) => (head === "Name" ? h("th", { scope: "row" }, h("code", {}, row.name), " ", symbol(row.symbol)) : h("td", { class: CLASSES[head] ?? "" }, cellOf(row)[head])))));
  return h("section", { class: "card", "data-section": title }, h("details", { open: title === "Needed" }, h("summary", {}, h("h2", {}, title), h("span", { class: "note" }, [rows.length, hint].filter(Boolean).join(" · "))), h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": title }, h("table", { class: "declared" },
    h("thead", {}, h("tr", {}, heads.map((name) => h("th", { scope: "col" }, name)))),
    groups.map((group) => h("tbody", {}, group && groups.length > 1 ? h("tr", { class: "group" }, h("th", { scope: "rowgroup", colspan: heads.length }, words(group))) : null, lines(group)))))));
}

/**
 * Return what stands in the columns; null where nothing does.
 * @param {DeclarationRow} row
 * @returns {Record<string, import("./dom.js").Child>}
 */
function cellOf(row) {
  const table = TABLE.exec(row.choices ?? "")?.[1];
  const ranged = row.lower !== null && row.lower !== undefined || row.upper !== null && row.upper !== undefined;
  return {
    Unit: unitText(row.unit) || null,
    Default: row.optional && row.default === null ? "not asked" : row.default === null || row.default === "" ? null : figure(row.default, FULL_DIGITS),
    "Range or choices": table ? ["rows of ", h("a", { href: `/catalogues?table=${table}` }, words(table)), row.choices.slice("rows of ".length + table.length)]
      : row.choices || (ranged ? `${row.lower === null ? "" : figure(row.lower, FULL_DIGITS)} … ${row.upper === null ? "" : figure(row.upper, FULL_DIGITS)}` : null),
    Meaning: row.text || null,
    Source: row.source || null,
  };
}

begin();
