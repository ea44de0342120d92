// A row of a batch: what it asks, and the designs that it has found.

import { faultCard, get, maySubmit, messageOf, post, sentence, statusOf } from "./api.js";
import { asWords, byId, duration, figure, h, symbol, unitText, words } from "./dom.js";
import { percent, usedShare } from "./numbers.js";
import { plotOf } from "./plot.js";
import { yamlText } from "./spec.js";
import { count, rowBadge } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./answers.js").RowAnswer} Row
 * @typedef {import("./answers.js").RowRecord} RowRecord
 * @typedef {import("./answers.js").ColumnAnswer} Column
 * @typedef {import("./answers.js").DeclarationAnswer} Declaration
 * @typedef {import("./records.js").FlatDesign} FlatDesign
 * @typedef {import("./records.js").DeclarationRow} DeclarationRow
 * @typedef {import("./records.js").Question} Question
 * @typedef {import("./records.js").Spec} Spec
 */

const place = byId("row");
const { job: id = "", line = "" } = place.dataset;
const BESIDE = ["rank", "score", "status", "gap", "note", "alternatives"];
const LIMIT = "utilisation: ";
const HOT = 0.995; // of a limit: it decides
const SEARCHED = ["objectives", "weights", "points", "gap", "grid", "seed", "time_limit", "catalogs"]; // that all rows of a batch share
/** @type {[title: string, sections: string[]][]} */
const GROUPS = [["Sizes", ["variable", "count", "choice"]], ["Parts", ["part"]], ["What follows", ["derived"]]];

async function begin() {
  try {
    const [job, found, request] = await Promise.all([get(`/jobs/${id}`), get(`/jobs/${id}/rows/${line}`), get(`/jobs/${id}/request`)]);
    const family = found.question ? await declarationOf(found.question).catch(() => null) : null;
    show(job, found, request, family);
  } catch (error) {
    place.replaceChildren(statusOf(error) === 404 ? h("section", { class: "card stack" }, h("h1", {}, "No such row"), h("p", {}, `The table has no row at line ${line}, or it is not read yet.`), h("p", {}, h("a", { href: `/jobs/${id}` }, "To the batch")))
      : faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
  if (location.hash === "#design") document.getElementById("design")?.scrollIntoView();
}

/** @param {Question} question */
function declarationOf({ family, options }) {
  const chosen = Object.entries(options).map(([name, value]) => `${name}:${value}`).join(",");
  return get(`/families/${family}${chosen ? `?options=${encodeURIComponent(chosen)}` : ""}`);
}

/**
 * @param {Job} job
 * @param {RowRecord} record
 * @param {Spec} request
 * @param {Declaration | null} family
 */
function show(job, { row, header, faults, question, columns, designs }, request, family) {
  const fault = h("p", { class: "fault", role: "alert" });
  const took = row.seconds === null ? "" : ` · took ${duration(row.seconds)}`;
  document.title = `Line ${row.line} · ${job.title} · clutchsynth`;
  place.replaceChildren(
    h("p", { class: "note" }, h("a", { href: `/jobs/${id}` }, job.title)),
    h("div", { class: "heading" }, h("h1", {}, `Line ${row.line}`), question && maySubmit() ? h("div", { class: "row" }, studyButton(row, question, request, designs, fault)) : null),
    h("p", { class: "row note" }, rowBadge(row.status), h("span", {}, family?.title ?? words(row.family), took)), fault,
    ...outcome(row, designs, faults),
    ...found(columns, designs, request, family),
    h("section", { class: "card stack" }, h("h2", {}, "What stands in the table"), h("dl", { class: "facts" }, header.map((title, k) => [h("dt", {}, title), h("dd", { class: faults.some((one) => one.column === title) ? "wrong" : "" }, row.cells[k] || "–")])),
      row.remarks ? h("p", { class: "note" }, row.remarks) : null),
    question ? h("section", { class: "card" }, h("details", {}, h("summary", {}, h("h2", {}, "What was asked")), h("pre", { tabindex: "0", "aria-label": "The question of this row as a spec" }, yamlText(specOf(question, request))))) : "");
}

/**
 * Return the question of a row as a spec of its own.
 * @param {Question} question
 * @param {Spec} request
 */
function specOf(question, request) {
  const own = Object.fromEntries(Object.entries(question).filter(([, value]) => typeof value === "string" || Object.keys(value ?? {}).length));
  return { ...own, ...Object.fromEntries(SEARCHED.filter((name) => request[name] !== undefined && request[name] !== null).map((name) => [name, request[name]])) };
}

/**
 * A row keeps figures of its designs; the explorer, ways out and reports are those of a study that asks the same.
 * @param {Row} row
 * @param {Question} question
 * @param {Spec} request
 * @param {FlatDesign[]} designs
 * @param {HTMLElement} fault
 */
function studyButton(row, question, request, designs, fault) {
  const button = h("button", { type: "button", class: "primary", onclick: async () => {
    button.disabled = true;
    fault.textContent = "";
    try {
      const title = `Line ${row.line}: ${row.cells.find((cell) => cell.trim()) ?? row.family}`.replaceAll(/[\u0000-\u001f\u007f]/g, " ").slice(0, 200);
      const made = await post("/jobs", { kind: "synthesis", request: specOf(question, request), title, parent: id }, { "Idempotency-Key": `row-${id}-${row.line}` });
      location.assign(`/jobs/${made.id}`);
    } catch (error) {
      fault.textContent = messageOf(error);
      button.disabled = false;
    }
  } }, designs.length ? "Open in the explorer" : "Find ways out");
  return button;
}

/**
 * @param {Row} row
 * @param {FlatDesign[]} designs
 * @param {RowRecord["faults"]} faults
 */
function outcome(row, designs, faults) {
  if (faults.length) return [h("section", { class: "card stack" }, h("h2", {}, "What is wrong"), h("ul", {}, faults.map((one) => h("li", { class: "fault" }, `${one.column || "The line"}: ${one.value === null ? "nothing stands there" : `got ${one.value}`}; expected ${one.expected}.`))))];
  if (!designs.length) return [h("section", { class: "card stack" }, h("h2", {}, row.status === "infeasible" ? "Nothing is feasible" : row.status === "not_found" ? "No design was found" : "No designs"), h("p", {}, sentence(asWords(row.explanation) || (row.status === "not_solved" ? "it has not been answered yet" : ""))))];
  const proven = row.certificate === "global" && row.status === "optimal";
  return [h("section", { class: `card certificate ${proven ? "proven" : ""}` }, h("h2", {}, `${count(designs.length, "design")}, ${proven ? "proven" : "not proven to be the best"}`),
    h("p", {}, proven ? `No other design that this row allows is better in all objectives${row.gap ? `, to within ${percent(row.gap)}` : ""}.` : "They hold all limits; better ones may exist."))];
}

/**
 * @param {Column[]} columns
 * @param {FlatDesign[]} designs
 * @param {Spec} request
 * @param {Declaration | null} family
 */
function found(columns, designs, request, family) {
  if (!designs.length) return [];
  const kinds = new Map((family?.rows ?? []).filter((one) => ["variable", "count", "choice", "part", "derived"].includes(one.section)).map((one) => [one.name, one]));
  const wanted = Array.isArray(request.objectives) ? request.objectives : request.objectives ? Object.keys(request.objectives) : (family?.rows ?? []).filter((one) => one.section === "objective" && one.default === "yes").map((one) => one.name);
  const objectives = wanted.flatMap((name) => columns.find((column) => column.name === name) ?? []);
  const shown = h("div", { id: "design" });
  /** @param {FlatDesign} design */
  const panel = (design) => {
    shown.replaceChildren(panelOf(design, designs.length, columns, objectives, kinds));
    designs.forEach((one, k) => buttons[k].setAttribute("aria-pressed", String(one === design)));
  };
  const buttons = designs.map((design) => h("button", { type: "button", class: "small", "aria-label": `Show design ${design.rank}`, onclick: () => panel(design) }, design.rank));
  panel(designs[0]);
  const points = designs.map((design) => ({ rank: design.rank, note: designs.length > 1 ? design.note : "", values: objectives.map(({ name }) => Number(design[name])), design }));
  const lines = designs.map((design, k) => h("tr", {}, h("th", { scope: "row" }, buttons[k]), objectives.map(({ name }) => h("td", { class: "right" }, figure(design[name]))), h("td", { class: "note" }, words(design.note))));
  return [designs.length > 1 && objectives.length ? plotOf(objectives, points, { label: "Designs of this row", choose: (point) => panel(point.design) }) : "",
    designs.length > 1 ? h("section", { class: "card" }, h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Designs" }, h("table", {}, h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Design"), objectives.map(({ name, unit }) => h("th", { scope: "col", class: "right" }, words(name), h("span", { class: "unit" }, ` ${unitText(unit)}`))), h("th", { scope: "col" }, "What it is"))), h("tbody", {}, lines)))) : "",
    shown];
}

/**
 * Return everything that is kept of a design: its objectives large, then sizes, parts, what follows, and limits.
 * @param {FlatDesign} design
 * @param {number} many
 * @param {Column[]} columns
 * @param {Column[]} objectives
 * @param {Map<string, DeclarationRow>} kinds
 */
function panelOf(design, many, columns, objectives, kinds) {
  /** @param {Column} column */
  const value = ({ name, unit }) => `${typeof design[name] === "number" ? figure(design[name]) : words(design[name] ?? "")} ${unitText(unit)}`.trim();
  /** @param {Column} column */
  const line = (column) => [h("dt", { title: kinds.get(column.name)?.text ?? "" }, words(column.name), " ", symbol(kinds.get(column.name)?.symbol)), h("dd", { class: "number" }, typeof design[column.name] === "string" && kinds.get(column.name)?.section === "part" ? design[column.name] : value(column))];
  const rest = columns.filter((column) => !BESIDE.includes(column.name) && !column.name.startsWith(LIMIT) && !objectives.includes(column));
  const groups = GROUPS.map(([title, sections]) => ({ title, own: rest.filter(({ name }) => sections.includes(kinds.get(name)?.section ?? "derived")) })).filter(({ own }) => own.length);
  /** @param {{title: string, own: Column[]}} of */
  const group = ({ title, own }) => h("div", {}, h("h3", {}, title), h("dl", { class: "facts" }, own.map(line)));
  const limits = columns.filter((column) => column.name.startsWith(LIMIT) && design[column.name] !== "" && design[column.name] !== null).map((column) => ({ name: column.name.slice(LIMIT.length), share: Number(design[column.name]) })).sort((a, b) => b.share - a.share);
  return h("section", { class: "card stack", "aria-label": `Design ${design.rank}` }, h("h2", {}, many > 1 ? `Design ${design.rank}` : "The design"),
    h("dl", { class: "figures" }, objectives.map((column) => h("div", {}, h("dt", {}, words(column.name)), h("dd", {}, value(column))))),
    h("div", { class: "panels" }, h("div", { class: "stack" }, groups.slice(0, -1).map(group)),
      limits.length ? h("div", {}, h("h3", {}, "Limits used"), h("dl", { class: "facts limits" }, limits.map(({ name, share }) => [h("dt", {}, words(name)), h("dd", { class: share >= HOT ? "hot" : "" }, h("span", { class: "number" }, usedShare(share)), share >= HOT ? h("span", { class: "note" }, " decides") : null)]))) : null,
      groups.slice(-1).map(group)));
}

begin();
