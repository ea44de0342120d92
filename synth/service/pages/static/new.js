// The form of a study: what a family declares, checked by the service while somebody types.

import { Refusal, faultCard, get, maySubmit, messageOf, post } from "./api.js";
import { ANY, choiceOf, together } from "./compare_form.js";
import { byId, firstOf, h, say, unitText, words } from "./dom.js";
import { Field, choices, hintOf, stated, typed } from "./fields.js";
import { sideView } from "./new_side.js";

/**
 * @typedef {import("./answers.js").FamilyAnswer} Family
 * @typedef {import("./answers.js").Problem} Problem
 * @typedef {import("./records.js").DeclarationRow} DeclarationRow
 * @typedef {import("./records.js").Spec} Spec
 */

const PATIENCE = 300; // ms without a key, before the service is asked
const place = byId("new");
const address = new URLSearchParams(location.search);
const SIZES = ["variable", "count"];

/**
 * @typedef {string[] | Record<string, string>} Objectives names alone, or names with what is made of them
 * @typedef {{[key: string]: import("./records.js").Json, family: string}} Own a family, with what concerns it alone
 * @typedef {Record<string, import("./records.js").Json>} Values by name
 */

// What is asked: the spec as stated, apart from what fields hold. `rest` has no field and is passed on.
/**
 * @type {{family: string, several: Set<string> | null, own: Own[], title: string, options: Record<string, string>, objectives: Objectives | null,
 *   values: Record<string, Values>, points: string, rest: Spec}}
 */
const study = { family: "", several: null, own: [], title: "", options: {}, objectives: null, values: { requirements: {}, fix: {}, parts: {} }, points: "20", rest: {} };
// Where several families are compared, `several` holds their names, `own` the entries that say more than a name.
/** @type {ReturnType<typeof choiceOf> | null} */
let choice = null;
/** @type {Field[]} */
let fields = [];
/** @type {Family[]} */
let families = [];
/** @type {import("./answers.js").ExampleAnswer[]} */
let examples = [];
/** @type {import("./compare_form.js").Declaration} what the form shows */
let declared = { name: "", rows: [] };
/** @type {import("./answers.js").CheckAnswer} */
let told = { ready: false, problems: [], read: {}, remarks: [], combinations: null };

/** @type {Map<string, import("./answers.js").DeclarationAnswer>} */
const declarations = new Map();
const side = sideView({ start, spec: () => body(), fieldAt });
const form = h("form", { id: "study", novalidate: true, onsubmit: (event) => { event.preventDefault(); start(); } });

async function begin() {
  try {
    [{ families }, { examples }] = await Promise.all([get("/families"), get("/examples")]);
    examples = examples.filter((example) => !example.design);
    const from = address.get("from"), example = examples.find((one) => one.name === address.get("example"));
    if (from) await fromJob(from);
    else if (example) take(example.spec);
    else if (address.get("family") === ANY) take({ family: ANY });
    else study.family = families.find((family) => family.name === address.get("family"))?.name ?? examples[0]?.family ?? families[0].name;
    await redraw();
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

/** @param {string} id */
async function fromJob(id) {
  const [job, request] = await Promise.all([get(`/jobs/${id}`), get(`/jobs/${id}/request`)]);
  /** @type {import("./records.js").Patch} */
  const patch = location.hash.startsWith("#patch=") ? JSON.parse(decodeURIComponent(location.hash.slice(7))) : {};
  for (const [section, values] of Object.entries(patch)) request[section] = { .../** @type {object} */ (request[section]), ...values };
  take(request);
  study.title = patch && Object.keys(patch).length ? `${job.title}, changed`.slice(0, 200) : "";
}

/**
 * Take a spec as what is asked.
 * @param {Spec} spec
 */
function take(spec) {
  const { family, options = {}, requirements = {}, objectives = null, fix = {}, parts = {}, limits = {}, points, ...rest } = spec;
  const entries = Array.isArray(family) ? family : [];
  const several = family === ANY ? families.map((one) => one.name) : entries.length ? entries.map((entry) => (typeof entry === "string" ? entry : entry.family)) : null;
  Object.assign(study, { several: several && new Set(several), own: entries.filter((entry) => typeof entry !== "string") });
  Object.assign(study, { family: several ? ANY : family, options: { ...options }, objectives: objectives === null ? null : structuredClone(objectives), rest, points: String(points ?? 20) });
  study.values = { requirements: { ...requirements }, fix: { ...fix }, parts: { ...parts } };
  study.rest = Object.keys(limits).length ? { limits, ...rest } : rest;
}

async function redraw() {
  const chosen = Object.entries(study.options).map(([name, value]) => `${name}:${value}`).join(",");
  if (study.several) declared = await declaredBySeveral();
  else declared = await get(`/families/${study.family}${chosen ? `?options=${encodeURIComponent(chosen)}` : ""}`);
  draw();
  await check();
}

async function declaredBySeveral() {
  const compared = families.filter(({ name }) => study.several?.has(name));
  const missing = compared.filter(({ name }) => !declarations.has(name));
  for (const { name } of missing) declarations.set(name, await get(`/families/${name}`)); // one after the other: they share what answers forms
  return together(compared, declarations);
}

/** @param {...string} sections */
const of = (...sections) => declared.rows.filter((row) => sections.includes(row.section));
/** @param {DeclarationRow} row */
const ofPractice = (row) => row.group === "practice";
/** @param {string} section */
const asked = (section) => declared.rows.filter((row) => row.section === section && row.kind === "requirement");

function draw() {
  fields = [];
  const open = new Set([...form.querySelectorAll("details[open]")].map((one) => one.id));
  if (!maySubmit()) form.replaceChildren(h("p", { class: "card note" }, "Your token may look at studies, not ask for any. What you write here can be copied."));
  else form.replaceChildren();
  const objectives = of("objective");
  const rules = [...asked("limit"), ...asked("assumption")].filter(ofPractice), assumptions = asked("assumption").filter((row) => !ofPractice(row));
  const cards = [
    familyCard(),
    study.several ? card("The duty", "what you know of it; who needs more says so", asked("duty").map((row) => field(row, "requirements")))
      : card("The duty", "needed", asked("needed").map((row) => field(row, "requirements"))),
    folded("limits", "Limits you may set", "empty is not asked", asked("limit").filter((row) => !ofPractice(row)).map((row) => field(row, "requirements")), true),
    objectiveCard(objectives),
    ...(study.several ? [] : [folded("construction", "Construction", `${of("option").length} choices`, of("option").map((row) => choices(row, study.options[row.name] ?? row.default, (name) => choose(row, name)))),
    folded("parts", "Parts", "designations with commas between them (one that has a comma itself in double quotes), or a condition on columns", of("part").map((row) => field({ ...row, unit: "" }, "parts"))),
    folded("sizes", "Sizes that are given", "empty is free", of(...SIZES).map((row) => field(row, "fix")))]),
    folded("practice", "Rules of practice", `${rules.length} of what an experienced engineer demands; each can be widened alone`, rules.map((row) => field(row, "requirements")), false, true),
    folded("assumptions", "Assumptions", `${assumptions.length} values, each with a default and its source`, assumptions.map((row) => field(row, "requirements")), false, true),
    h("section", { class: "card" }, h("label", { for: "title" }, "Title"), h("input", { id: "title", class: "wide", maxlength: "200", value: study.title, placeholder: "made of the duty, if empty", oninput: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => { study.title = event.target.value; side.code(); } }))];
  form.append(...cards.filter((one) => one !== null));
  for (const id of open) form.querySelector(`#${id}`)?.setAttribute("open", "");
  for (const one of form.querySelectorAll("details")) if (one.querySelector(".changed")) one.open = true;
  if (!place.contains(form)) place.replaceChildren(h("div", { class: "split" }, form, side.element));
}

/**
 * @param {string} title
 * @param {string} hint
 * @param {import("./dom.js").Child} children
 */
function card(title, hint, children) {
  return h("section", { class: "card" }, h("h2", {}, title, h("span", { class: "note" }, hint)), children);
}

/**
 * @param {string} id
 * @param {string} title
 * @param {string} hint
 * @param {HTMLElement[]} children
 */
function folded(id, title, hint, children, open = false, find = false) {
  if (!children.length) return null;
  const search = find ? h("input", { type: "search", class: "find", placeholder: "Find: friction, oil …", "aria-label": `Find in ${title.toLowerCase()}`, oninput: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => {
    const wanted = event.target.value.toLowerCase();
    for (const one of children) one.hidden = !one.textContent.toLowerCase().includes(wanted);
  } }) : null;
  return h("section", { class: "card" }, h("details", { id, open }, h("summary", {}, h("h2", {}, title), h("span", { class: "note" }, hint)), search, children));
}

function familyCard() {
  const own = examples.filter((example) => example.family === study.family);
  choice = study.several && choiceOf(families, study.several, () => { collect(); redraw().catch(show); });
  return h("section", { class: "card" }, h("h2", { id: "family" }, "Family"),
    h("div", { class: "families", role: "radiogroup", "aria-labelledby": "family" }, [{ name: ANY, title: "Compare several" }, ...families].map((family) =>
      h("label", {}, h("input", { type: "radio", name: "family", value: family.name, checked: family.name === study.family, onchange: () => turn(family.name) }), family.title))), choice?.element,
    own.length ? h("p", { class: "row starts" }, h("span", { class: "note" }, "Start from"), own.map((example) =>
      h("button", { type: "button", class: "small", title: example.description, onclick: () => { take(example.spec); redraw(); } }, words(example.name)))) : null);
}

/** @param {string} family */
function turn(family) {
  const known = /** @type {Record<string, string | number>} */ (study.values.requirements), limits = new Set(study.several || family === ANY ? Object.keys(known) : []);
  take({ family, requirements: Object.fromEntries(Object.entries(known).filter(([name]) => limits.has(name) && understood(family, name))) });
  redraw().then(() => firstOf(form, `input[value="${family}"]`)?.focus()).catch(show);
}

/**
 * Tell whether a requirement means the same in other families: then it is taken over.
 * @param {string} family
 * @param {string} name
 */
const understood = (family, name) => families.some((one) => (family === ANY || one.name === family) && one.understands.includes(name));

/**
 * @param {DeclarationRow} row
 * @param {string} name
 */
function choose(row, name) {
  collect();
  if (name === row.default) delete study.options[row.name];
  else study.options[row.name] = name;
  redraw().then(() => firstOf(form, `input[name="o-${row.name}"]:checked`)?.focus()).catch(show);
}

/**
 * @param {DeclarationRow} row
 * @param {string} section
 */
function field(row, section) {
  const value = typed(study.values[section][row.name] ?? "", row.unit);
  const one = new Field(row, { path: [section, row.name], hint: hintOf(row), value, changed: later });
  fields.push(one);
  return one.element;
}

/** @param {DeclarationRow[]} rows */
function objectiveCard(rows) {
  const chosen = study.objectives === null ? rows.filter((row) => row.default === "yes").map((row) => row.name)
    : Array.isArray(study.objectives) ? study.objectives : Object.keys(study.objectives);
  const boxes = rows.map((row) => h("label", {}, h("input", { type: "checkbox", value: row.name, checked: chosen.includes(row.name), onchange: () => { collect(); later(); } }),
    words(row.name), h("span", { class: "note" }, [row.sense === "max" ? "large" : "", unitText(row.unit)].filter(Boolean).join(" · "))));
  return h("section", { class: "card" }, h("h2", {}, "What to make small or large"), h("div", { class: "objectives", role: "group", "aria-label": "Objectives" }, boxes),
    h("p", { class: "row points" }, h("label", { for: "points" }, "Designs at most"), h("input", { id: "points", inputmode: "numeric", autocomplete: "off", value: study.points, "aria-describedby": "points-fault", oninput: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => { study.points = event.target.value; later(); } }), h("span", { id: "objective-note", class: "note" })),
    h("p", { class: "fault", id: "points-fault" }));
}

/** Gather what the fields hold. */
function collect() {
  for (const one of fields) {
    const [section, name] = one.path;
    if (!one.value) delete study.values[section][name];
    else study.values[section][name] = section === "parts" ? partsOf(one.value) : stated(one.value, one.row.unit);
  }
  const boxes = /** @type {NodeListOf<HTMLInputElement>} */ (form.querySelectorAll(".objectives input"));
  const names = [...boxes].filter((box) => box.checked).map((box) => box.value);
  const before = study.objectives;
  if (before === null || Array.isArray(before)) study.objectives = names;
  else study.objectives = Object.fromEntries(names.map((name) => [name, before[name] ?? of("objective").find((row) => row.name === name)?.sense ?? "min"]));
}

/** Return what is asked of a part: a condition, or designations; one that has a comma itself stands in double quotes. */
const NAMES = /\s*(?:"((?:[^"]|"")*)"\s*(?=,|$)|([^,]*))(?:,|$)/g;
/** @param {string} text */
const partsOf = (text) => {
  if (/[<>=]| in /.test(text.replace(/(^|,)\s*"(?:[^"]|"")*"\s*(?=,|$)/g, "$1"))) return text;
  return [...text.matchAll(NAMES)].map(([, quoted, plain]) => (quoted === undefined ? plain : quoted.replaceAll('""', '"')).trim()).filter(Boolean);
};

function spec() {
  collect();
  const all = study.several && study.several.size === families.length && !study.own.length;
  /** @type {Spec} */
  const found = { family: !study.several || all ? study.family : [...study.several].map((name) => study.own.find((entry) => entry.family === name) ?? name) };
  if (Object.keys(study.options).length) found.options = study.options;
  for (const [section, values] of Object.entries(study.values)) if (Object.keys(values).length || section === "requirements") found[section] = values;
  if (!study.several || count() > 0) found.objectives = study.objectives;
  found.points = /^\d+$/.test(study.points.trim()) ? Number(study.points) : study.points;
  return { ...found, ...study.rest };
}

/** Return how many objectives are chosen. */
const count = () => (study.objectives === null ? 0 : Array.isArray(study.objectives) ? study.objectives.length : Object.keys(study.objectives).length);

function body() {
  /** @type {import("./spec.js").Asked} */
  const own = { kind: study.several ? "compare" : "synthesis", request: spec() };
  if (study.title.trim()) own.title = study.title.trim();
  return own;
}

let waiting = 0, number = 0;
function later() {
  clearTimeout(waiting);
  side.code();
  side.checking();
  waiting = window.setTimeout(() => check().catch(show), PATIENCE);
}

async function check() {
  const own = (number += 1);
  side.code();
  const answer = await post("/check", spec());
  if (own === number) tell(answer);
}

/** @param {import("./answers.js").CheckAnswer} answer */
function tell(answer) {
  told = answer;
  const left = [];
  const at = new Map();
  for (const problem of answer.problems) {
    const one = fieldAt(problem.path);
    if (one) at.set(one, problem);
    else left.push(problem);
  }
  for (const one of fields) one.show(at.get(one) ?? null, one.path[0] === "requirements" ? answer.read[one.row.name] : "");
  const points = left.find((problem) => problem.path[0] === "points");
  byId("points-fault").textContent = points?.message ?? "";
  byId("points").setAttribute("aria-invalid", String(Boolean(points)));
  const chosen = count(), objectives = study.several ? Math.max(1, chosen) : chosen;
  choice?.show(declarations, Object.keys(study.values.requirements));
  byId("objective-note").textContent = study.several && !chosen ? "None chosen: those that all have in common." : ["Choose at least one.", "One optimum.", "A front of the best compromises."][chosen] ?? `A front in ${chosen} dimensions; this can take minutes.`;
  side.show(answer, at, left, { objectives, stated: Object.keys(study.values.requirements).length, slots: of("part").map((row) => words(row.name)) });
}

/** @param {(string | number)[]} path */
function fieldAt(path) {
  return fields.find((one) => one.path[0] === path[0] && one.path[1] === path[1]);
}

/**
 * Show a refusal; what is wrong in the input goes to its fields.
 * @param {unknown} error
 */
function show(error) {
  if (!(error instanceof Refusal)) throw error;
  if (error.problems.length) tell({ ...told, ready: false, problems: error.problems });
  else side.refused(messageOf(error));
}

async function start() {
  for (const one of fields) if (one.needed) one.touched = true;
  side.busy(true);
  try {
    await check();
    if (!told.ready) {
      const first = fields.find((one) => one.input.getAttribute("aria-invalid") === "true");
      first?.element.closest("details")?.setAttribute("open", "");
      first?.input.focus();
      say(`${told.problems.length} to correct`);
      return side.busy(false);
    }
    const job = await post("/jobs", body(), { "Idempotency-Key": crypto.randomUUID?.() ?? String(Math.random()) });
    location.assign(`/jobs/${job.id}`);
  } catch (error) {
    side.busy(false);
    show(error);
  }
}

begin();
