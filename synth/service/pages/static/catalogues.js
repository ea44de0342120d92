// Part tables: those that come with the families, and one's own in versions.

import { ask, faultCard, get, maySubmit, messageOf, post, problemsOf, sentence, statusOf } from "./api.js";
import { cellsOf, headingOf, sheet, short } from "./csv.js";
import { allOf, byId, figure, firstOf, h, say, unitText, when, words } from "./dom.js";
import { FULL_DIGITS, number } from "./numbers.js";
import { badge, count } from "./words.js";

/**
 * @typedef {import("./answers.js").CatalogueDiff} Changes
 * @typedef {import("./answers.js").CatalogueEntry} Entry
 * @typedef {import("./answers.js").TableEntry} TableEntry
 */

const place = byId("catalogues");
const address = new URLSearchParams(location.search);
const SHOWN_JOBS = 5, MOST = 300;
/** @type {Record<string, string>} */
const CONFIDENCE = { verified: "good", textbook: "fair", computed: "fair", typical: "warn" };
/** @param {string} reference */
const ownPlace = (reference) => `/catalogues?own=${encodeURIComponent(reference)}`;

async function begin() {
  try {
    const [table, own] = [address.get("table"), address.get("own")];
    if (table) shippedTable(await get(`/tables/${encodeURIComponent(table)}`));
    else if (own) await ownTable(own);
    else await lists();
  } catch (error) {
    place.replaceChildren(statusOf(error) === 404 ? h("section", { class: "card stack" }, h("h1", {}, "No such table"), h("p", {}, h("a", { href: "/catalogues" }, "To the catalogues"))) : faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

// ---- which tables there are ----

async function lists() {
  const [{ catalogues }, { tables }, { families }] = await Promise.all([get("/catalogues"), get("/tables"), get("/families")]);
  const titles = new Map(families.map((family) => [family.name, family.title]));
  /** @param {string[]} names */
  const heads = (names) => h("thead", {}, h("tr", {}, names.map((name) => h("th", { scope: "col", class: name === "Rows" ? "right" : "" }, name))));
  place.replaceChildren(h("h1", {}, "Catalogues"), h("p", { class: "note lead" }, "The part tables that designs are made of: those that come with the families, and your own in versions."),
    h("section", { class: "card stack" }, h("h2", {}, "Your own"), catalogues.length ? h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Your own tables" }, h("table", {}, heads(["Version", "Rows", "Rows for", "Brought", "Note"]),
      h("tbody", {}, catalogues.map((entry) => h("tr", {}, h("th", { scope: "row" }, h("a", { href: ownPlace(entry.reference) }, entry.reference)), h("td", { class: "right" }, figure(entry.rows)), h("td", {}, words(entry.table)), h("td", {}, when(entry.created)), h("td", {}, entry.note))))))
      : h("p", { class: "note" }, "You have brought no table. Studies use the tables below."),
    maySubmit() ? h("p", {}, h("a", { class: "button", href: "#bring" }, "Bring a table")) : null),
    h("section", { class: "card stack" }, h("h2", {}, "Tables that come with the families"), h("p", { class: "note" }, "Every row has a source, and says how far it can be trusted. A value that is not known stays empty."),
      h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Tables that come with the families" }, h("table", {}, heads(["Table", "Rows", "Parts of"]),
        h("tbody", {}, tables.map((table) => h("tr", {}, h("th", { scope: "row" }, h("a", { href: `/catalogues?table=${table.name}` }, words(table.name))), h("td", { class: "right" }, figure(table.rows)), h("td", {}, table.families.length ? users(table.families.map((name) => titles.get(name) ?? words(name)).join("; ")) : h("span", { class: "note" }, "looked up by formulas, or for reference")))))))),
    maySubmit() ? bringing(tables) : "");
  if (location.hash === "#bring") document.getElementById("bring")?.scrollIntoView();
}

/** @param {string} text */
const users = (text) => h("span", { class: "users", title: text }, text);
const back = () => h("p", { class: "note" }, h("a", { href: "/catalogues" }, "Catalogues"));

/** @param {string} confidence */
const trust = (confidence) => h("span", { class: `badge ${CONFIDENCE[confidence] ?? ""}` }, confidence);

/**
 * Return the places of columns as they are read: what a row is, how far it can be trusted, then the rest.
 * @param {string[]} names
 */
function inOrder(names) {
  const trusted = names.indexOf("confidence");
  return [0, ...(trusted > 0 ? [trusted] : []), ...names.keys()].filter((k, at, all) => all.indexOf(k) === at);
}

/**
 * Return a field that leaves the lines of a table that have a text, and the table.
 * @param {HTMLElement} table
 */
function found(table) {
  const lines = allOf(table, "tbody tr");
  const told = h("span", { class: "note", role: "status" });
  return h("p", { class: "row" }, h("input", { type: "search", class: "find", placeholder: "Find in the rows", "aria-label": "Find in the rows", oninput: (/** @type {import("./elements.js").EventOf<HTMLInputElement>} */ event) => {
    const wanted = event.target.value.toLowerCase();
    for (const line of lines) line.hidden = !(line.textContent ?? "").toLowerCase().includes(wanted);
    told.textContent = wanted ? `${count(lines.filter((line) => !line.hidden).length, "row")} of ${lines.length}` : "";
  } }), told);
}

// ---- a table that comes with the families ----

/** @param {import("./answers.js").TableAnswer} table */
function shippedTable(table) {
  document.title = `${words(table.name)} · clutchsynth`;
  const name = words(table.name), numeric = table.columns.map((_, k) => table.rows.some((row) => typeof row[k] === "number"));
  const order = inOrder(table.columns.map((column) => column.name));
  /**
   * @param {string | number | null} value
   * @param {number} k
   */
  const cell = (value, k) => (table.columns[k].name === "confidence" && value ? trust(String(value)) : value === null ? h("span", { class: "note" }, "–") : short(typeof value === "string" ? value.replaceAll(/;(?=\S)/g, "; ") : number(value, FULL_DIGITS)));
  const rows = h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Rows" }, h("table", { class: "sheet" },
    h("thead", {}, h("tr", {}, order.map((k) => ({ column: table.columns[k], k })).map(({ column, k }) => h("th", { scope: "col", class: numeric[k] ? "right" : "", title: column.text }, words(column.name), unitText(column.unit) && !column.unit?.startsWith("column:") ? h("span", { class: "unit" }, ` ${unitText(column.unit)}`) : null)))),
    h("tbody", {}, table.rows.map((row) => h("tr", {}, order.map((k) => h(k ? "td" : "th", { scope: k ? null : "row", class: numeric[k] ? "right" : typeof row[k] === "string" && row[k].length > 40 ? "long" : "" }, cell(row[k], k))))))));
  place.replaceChildren(back(), h("h1", {}, name[0].toUpperCase() + name.slice(1)), h("section", { class: "card stack" },
    h("p", { class: "note" }, `${count(table.rows.length, "row")}. `, table.families.length ? ["Parts of ", table.families.map((family, k) => [k ? ", " : "", h("a", { href: `/families/${family}` }, words(family))]), ". "] : null, "In a spec it is ", h("code", {}, table.name), "."),
    found(rows), rows),
  h("section", { class: "card" }, h("details", {}, h("summary", {}, h("h2", {}, "What the columns are"), h("span", { class: "note" }, String(table.columns.length))), h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Columns" }, h("table", {},
    h("thead", {}, h("tr", {}, ["Column", "Unit", "Plausible", "Meaning"].map((text) => h("th", { scope: "col" }, text)))),
    h("tbody", {}, table.columns.map((column) => h("tr", {}, h("th", { scope: "row" }, h("code", {}, column.name)), h("td", {}, column.unit?.startsWith("column:") ? `as ${words(column.unit.slice(7))} says` : unitText(column.unit)),
      h("td", { class: "number" }, column.lower === null && column.upper === null ? "" : `${column.lower === null ? "" : figure(column.lower, FULL_DIGITS)} … ${column.upper === null ? "" : figure(column.upper, FULL_DIGITS)}`), h("td", { class: "text" }, column.text)))))))));
}

// ---- a version of one's own ----

/** @param {string} reference */
async function ownTable(reference) {
  const [name, stated] = reference.split("@");
  const version = Number(stated), path = /** @type {const} */ (`/catalogues/${encodeURIComponent(name)}/${version}`);
  const [own, { catalogues }] = await Promise.all([get(path), get("/catalogues")]);
  const { entry, csv, separator, used_by: users } = own;
  const others = catalogues.filter((one) => one.name === name && one.version !== version);
  const jobs = await Promise.all(users.slice(0, SHOWN_JOBS).map((id) => get(`/jobs/${id}`).catch(() => null)));
  const changed = h("div", { class: "stack" }), rows = h("div", { class: "stack" }), fault = h("p", { class: "fault", role: "alert" });
  document.title = `${entry.reference} · clutchsynth`;

  /** @param {string | number} since */
  async function compare(since) {
    const changes = since ? await get(`${path}/changes?since=${since}`) : null;
    const cells = new Map(changes?.changed.map((cell) => [`${cell.designation}\n${headingOf(cell.column).name}`, cell]) ?? []), added = new Set(changes?.added ?? []);
    const [header, ...lines] = cellsOf(csv, separator), order = inOrder(header.map((text) => headingOf(text).name));
    const table = sheet([header, ...lines].map((line) => order.map((k) => line[k] ?? "")), { label: "Rows", most: MOST, tone: (column, line) => (added.has(line[0]) ? "added" : cells.has(`${line[0]}\n${column}`) ? "changed" : ""),
      cell: (text, column) => (column === "confidence" && text ? trust(text) : null) });
    rows.replaceChildren(h("h2", {}, count(entry.rows, "row")), found(table), table);
    changed.replaceChildren(...(changes ? differences(changes) : []));
  }
  const choice = h("select", { id: "since", onchange: () => compare(choice.value).catch((error) => { fault.textContent = messageOf(error); }) }, h("option", { value: "" }, "nothing"), others.map((one) => h("option", { value: one.version }, one.reference)));
  const before = others.find((one) => one.version < version);
  choice.value = before ? String(before.version) : "";
  await compare(choice.value);
  place.replaceChildren(back(), h("div", { class: "heading" }, h("h1", {}, entry.reference), maySubmit() ? removing(entry, users, fault) : null), h("section", { class: "card stack" }, fault,
    h("dl", { class: "facts" }, h("dt", {}, "Rows for"), h("dd", {}, h("a", { href: `/catalogues?table=${encodeURIComponent(entry.table)}` }, words(entry.table))), h("dt", {}, "Brought"), h("dd", {}, when(entry.created)), entry.note ? [h("dt", {}, "Note"), h("dd", {}, entry.note)] : null,
      h("dt", {}, "In a spec"), h("dd", {}, h("code", {}, `catalogs: {${entry.table}: ["+", "${entry.reference}"]}`)),
      h("dt", {}, "Versions"), h("dd", {}, others.length ? others.map((one, k) => [k ? ", " : "", h("a", { href: ownPlace(one.reference) }, one.reference)]) : "this one alone"),
      h("dt", {}, "Used by"), h("dd", {}, users.length ? h("ul", {}, jobs.filter((job) => job !== null).map((job) => h("li", { class: "row" }, badge(job), h("a", { href: `/jobs/${job.id}` }, job.title))), users.length > SHOWN_JOBS ? h("li", { class: "note" }, `and ${users.length - SHOWN_JOBS} more`) : null) : "no study")),
    others.length ? h("p", { class: "row" }, h("label", { for: "since" }, "Compare with"), choice) : null, changed),
  h("section", { class: "card" }, rows));
}

/**
 * Return what is different between two versions; cells that changed are marked in the rows as well.
 * @param {Changes} changes
 */
function differences(changes) {
  /**
   * @param {string} title
   * @param {string[]} names
   */
  const named = (title, names) => (names.length ? h("p", {}, `${title}: ${names.join(", ")}`) : null);
  const told = [named("Added", changes.added), named("Removed", changes.removed), named("Columns added", changes.columns_added), named("Columns removed", changes.columns_removed),
    changes.changed.length ? h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Changed cells" }, h("table", {}, h("thead", {}, h("tr", {}, ["Row", "Column", "Before", "After"].map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, changes.changed.slice(0, MOST).map((cell) => h("tr", {}, h("th", { scope: "row" }, cell.designation), h("td", {}, cell.column), h("td", {}, cell.before || "empty"), h("td", { class: "changed" }, cell.after || "empty")))))) : null].filter((one) => one !== null);
  return [h("h3", {}, `Since ${changes.before.reference}`), ...(told.length ? told : [h("p", {}, "The rows are the same.")])];
}

/**
 * @param {Entry} entry
 * @param {string[]} users
 * @param {HTMLElement} fault
 */
function removing(entry, users, fault) {
  if (users.length) return h("span", { class: "note" }, "A version that a study names stays.");
  const button = h("button", { type: "button", onclick: async () => {
    if (!button.classList.contains("danger")) {
      button.classList.add("danger");
      button.textContent = "Really remove?";
      return;
    }
    try {
      await ask("DELETE", `/catalogues/${encodeURIComponent(entry.name)}/${entry.version}`);
      location.assign("/catalogues");
    } catch (error) {
      fault.textContent = messageOf(error);
    }
  } }, "Remove");
  return button;
}

// ---- a table that is brought ----

/** @param {TableEntry[]} tables */
function bringing(tables) {
  /** @type {Record<string, HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement>} */
  const fields = {};
  /** @type {Record<string, HTMLElement>} */
  const faults = {};
  /**
   * @param {string} name
   * @param {string} text
   * @param {HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} field
   */
  const labelled = (name, text, field) => {
    fields[name] = field;
    faults[name] = h("span", { class: "fault", id: `${field.id}-fault` });
    field.setAttribute("aria-describedby", faults[name].id);
    return h("p", { class: "labelled" }, h("label", { for: field.id }, text), field, faults[name]);
  };
  const file = h("input", { type: "file", id: "csv-file", class: "unseen", accept: ".csv,text/csv", onchange: async () => { if (file.files?.[0]) fields.csv.value = await file.files[0].text(); } });
  const fault = h("p", { class: "fault", role: "alert" });
  const kept = h("div", { id: "kept", role: "status" });
  const form = h("form", { class: "card stack", id: "bring", novalidate: true, onsubmit: async (event) => {
    event.preventDefault();
    fault.textContent = "";
    kept.replaceChildren();
    for (const [name, own] of Object.entries(faults)) {
      own.textContent = "";
      fields[name].removeAttribute("aria-invalid");
    }
    try {
      const made = await post("/catalogues", { name: fields.name.value.trim(), table: fields.table.value, csv: fields.csv.value, schema: fields.schema.value, note: fields.note.value.trim() });
      say(`${made.reference} is kept`);
      if (made.remarks.length) kept.replaceChildren(h("p", {}, h("a", { href: ownPlace(made.reference) }, made.reference), " is kept. As it was read:"), h("ul", {}, made.remarks.map((text) => h("li", {}, sentence(text)))));
      else location.assign(ownPlace(made.reference));
    } catch (error) {
      const problems = problemsOf(error), left = problems.filter((problem) => {
        const name = problem.path[0];
        if (!faults[name]) return true;
        faults[name].textContent = sentence(problem.message);
        fields[name].setAttribute("aria-invalid", "true");
        return false;
      });
      fault.textContent = left.length ? sentence(left[0].message) : problems.length ? "" : messageOf(error);
      firstOf(form, "[aria-invalid]")?.focus();
    }
  } }, h("h2", {}, "Bring a table"), h("p", { class: "note" }, "Each change is a new version; studies name the one that they were asked with. The first column is ", h("code", {}, "designation"), ", units stand in the headings: ", h("code", {}, "thickness [mm]"), "."),
  h("div", { class: "asks" }, labelled("name", "Name", h("input", { id: "name", maxlength: "60", autocomplete: "off", spellcheck: "false", placeholder: "my_linings" })),
    labelled("table", "Rows for the table", h("select", { id: "table" }, h("option", { value: "" }, "as its name says"), tables.map((table) => h("option", { value: table.name }, words(table.name))))),
    labelled("note", "Note", h("input", { id: "note", maxlength: "200", autocomplete: "off", placeholder: "what is new in it" }))),
  h("div", { class: "stack" }, h("p", {}, h("label", { class: "button small", for: "csv-file" }, "Rows from a file"), file), labelled("csv", "Rows as CSV", h("textarea", { id: "csv", rows: "8", class: "wide", spellcheck: "false" }))),
  h("details", { class: "more" }, h("summary", {}, "Schema, for a table that is none of ours"), labelled("schema", "Columns as CSV", h("textarea", { id: "schema", rows: "5", class: "wide", spellcheck: "false", placeholder: "column,type,unit,minimum,maximum,required,symbol,description" }))),
  fault, kept, h("p", {}, h("button", { type: "submit", class: "primary" }, "Keep as a new version")));
  return form;
}

begin();
