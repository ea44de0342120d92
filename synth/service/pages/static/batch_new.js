// A table of duties: brought, understood column by column, checked line by line, and asked.

import { Refusal, ask, faultCard, get, maySubmit, messageOf, post, sentence } from "./api.js";
import { columnsCard } from "./columns_card.js";
import { byId, figure, h, say, unitText, words } from "./dom.js";
import { count } from "./words.js";

const place = byId("batch");
const MOST_FAULTS = 100, PATIENCE = 300, LONG = 40; // letters of a cell that needs room

/**
 * @typedef {import("./answers.js").BatchCheck} BatchCheck
 * @typedef {import("./answers.js").TableFault} Fault
 * @typedef {import("./answers.js").UploadAnswer} Upload
 */

/** @type {{brought: Upload | null, families: import("./answers.js").FamilyAnswer[], faults: Fault[]}} */
const table = { brought: null, families: [], faults: [] };

const file = h("input", { type: "file", id: "file", class: "unseen", accept: ".csv,.xlsx,text/csv", "aria-describedby": "file-kinds", onchange: () => file.files?.[0] && bring(file.files[0]) });
const choose = h("label", { class: "button", for: "file" }, "choose a file");
const dropped = h("div", { class: "drop", ondragover: (/** @type {Event} */ event) => { event.preventDefault(); dropped.classList.add("over"); }, ondragleave: () => dropped.classList.remove("over"), ondrop: (/** @type {DragEvent} */ event) => {
  event.preventDefault();
  dropped.classList.remove("over");
  const [brought] = event.dataTransfer?.files ?? [];
  if (brought) bring(brought);
} }, h("p", {}, "Drop a table here, or ", choose, file),
h("p", { class: "note", id: "file-kinds" }, "CSV as your spreadsheet writes it, or the first sheet of an Excel workbook. A heading is a name with its unit, such as ", h("code", {}, "load_torque [N*m]"), "; what other headings mean can be said here."));
const fault = h("p", { class: "fault", role: "alert" });
const columns = columnsCard(later);
const first = h("section", { class: "card", hidden: true });
const go = h("button", { type: "button", class: "primary", disabled: true, onclick: start }, "Start");
const state = h("p", { role: "status" }), detail = h("div", { class: "stack" });
const told = h("section", { class: "card stack", hidden: true }, h("h2", {}, "Check"), state, detail, h("p", { class: "row" }, go)); // what is told aloud stays where it is

const asks = {
  family: asked("Family", h("select", { id: "family", onchange: () => { offerObjectives(); later(); } })),
  points: asked("Designs for each row, at most", h("input", { id: "points", inputmode: "numeric", value: "1", autocomplete: "off", oninput: later })),
  title: asked("Title", h("input", { id: "title", maxlength: "200", autocomplete: "off", placeholder: "made of the file, if empty" })),
};

const objectives = h("div", { class: "objectives", role: "group", "aria-label": "Objectives" });

/** Offer what the family that is chosen can make small or large. */
async function offerObjectives() {
  const name = asks.family.field.value;
  objectives.replaceChildren(h("p", { class: "note" }, name ? "…" : "Each family has its own; choose one for all rows to choose among them."));
  if (!name) return;
  const rows = (await get(`/families/${name}`).then(({ rows }) => rows, () => [])).filter((row) => row.section === "objective");
  if (name !== asks.family.field.value) return;
  objectives.replaceChildren(...rows.map((row) => h("label", {}, h("input", { type: "checkbox", value: row.name, checked: row.default === "yes", "data-usual": row.default, onchange: later }), words(row.name), h("span", { class: "note" }, [row.sense === "max" ? "large" : "", unitText(row.unit)].filter(Boolean).join(" · ")))));
}

/**
 * Return a field with its label and a place for what is wrong with it.
 * @template {HTMLInputElement | HTMLSelectElement} F
 * @param {string} text
 * @param {F} field
 */
function asked(text, field) {
  const wrong = h("span", { class: "fault", id: `${field.id}-fault` });
  field.setAttribute("aria-describedby", wrong.id);
  return { text, field, wrong, element: h("p", { class: "labelled" }, h("label", { for: field.id }, text), field, wrong) };
}

async function begin() {
  try {
    const { families } = await get("/families");
    table.families = families;
    const { field } = asks.family;
    field.replaceChildren(h("option", { value: "" }, "as a column of the table says"), ...families.map((one) => h("option", { value: one.name }, one.title)));
    const wanted = new URLSearchParams(location.search).get("family");
    field.value = families.find((one) => one.name === wanted)?.name ?? "";
    await offerObjectives();
    place.replaceChildren(maySubmit() ? h("div", {}, h("section", { class: "card stack" }, h("h2", {}, "The table"), dropped, fault), first,
      h("section", { class: "card" }, h("h2", {}, "What is asked of all rows"), h("div", { class: "asks" }, Object.values(asks).map((one) => one.element)), h("h3", {}, "What to make small or large"), objectives),
      columns.element, told) : h("p", { class: "card note" }, "Your token may look at jobs, not ask for any."));
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

/** @param {File} chosen */
async function bring(chosen) {
  fault.textContent = "";
  const form = new FormData();
  form.append("file", chosen);
  place.setAttribute("aria-busy", "true");
  try {
    const brought = await post("/uploads", form);
    table.brought = brought;
    choose.textContent = "choose another file";
    columns.bring(brought.header, brought.rows);
    table.faults = [];
    preview();
    await check();
  } catch (error) {
    table.brought = null;
    first.hidden = told.hidden = columns.element.hidden = true;
    fault.textContent = messageOf(error);
  } finally {
    file.value = "";
    place.setAttribute("aria-busy", "false");
  }
}

/** Show the first rows as they stand, with what is wrong in them. */
function preview() {
  if (!table.brought) return;
  const { name, size, header, rows } = table.brought;
  const wrong = new Map(table.faults.map((one) => [`${one.line} ${one.column}`, one]));
  /** @type {(row: {line: number, cells: string[]}, k: number) => HTMLElement} */
  const cell = (row, k) => {
    const found = wrong.get(`${row.line} ${header[k]}`);
    return h("td", { class: found ? "wrong" : (row.cells[k] ?? "").length > LONG ? "long" : "", title: found ? found.message : null }, found ? h("span", { class: "unseen" }, "faulty: ") : null, row.cells[k] ?? "");
  };
  first.hidden = false;
  first.replaceChildren(h("h2", {}, name), h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "First rows" }, h("table", { class: "sheet" },
    h("caption", {}, `${figure(size)} bytes; the first ${count(rows.length, "row")}`),
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Line"), header.map((title) => h("th", { scope: "col" }, title)))),
    h("tbody", {}, rows.map((row) => h("tr", {}, h("th", { scope: "row", class: "number" }, row.line), header.map((_, k) => cell(row, k))))))));
}

let waiting = 0, number = 0;
function later() {
  clearTimeout(waiting);
  go.disabled = true;
  if (table.brought) waiting = window.setTimeout(check, PATIENCE);
}

function request() {
  const boxes = [...objectives.querySelectorAll("input")];
  const names = boxes.some((box) => box.checked !== (box.dataset.usual === "yes")) ? boxes.filter((box) => box.checked).map((box) => box.value) : null;
  const many = asks.points.field.value.trim();
  const family = asks.family.field.value;
  const mapping = columns.request();
  return { upload: table.brought?.id, ...(family ? { family } : {}), ...(names ? { objectives: names } : {}), ...(many ? { points: /^\d+$/.test(many) ? Number(many) : many } : {}), ...(Object.keys(mapping).length ? { mapping } : {}) };
}

async function check() {
  const own = (number += 1);
  told.hidden = false;
  go.disabled = true;
  state.textContent = "Checking the rows …";
  try {
    const answer = await post("/batches/check", request());
    if (own !== number) return;
    clear();
    table.faults = answer.faults;
    await columns.told(answer, answer.families.filter((name) => table.families.some((one) => one.name === name)));
    if (own === number) show(answer);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    if (own === number) await refused(error);
  }
}

function clear() {
  columns.fault(null);
  for (const { field, wrong } of Object.values(asks)) {
    wrong.textContent = "";
    field.removeAttribute("aria-invalid");
  }
}

/**
 * Show what is wrong with the table as a whole at its place: a heading, a field, or the table.
 * @param {Refusal} error
 */
async function refused(error) {
  clear();
  table.faults = [];
  preview();
  const family = asks.family.field.value;
  await columns.told(null, family ? [family] : []);
  const problem = error.problems[0];
  const at = Object.entries(asks).find(([name]) => problem?.path[0] === name)?.[1] ?? (problem && problem.value === null && /, column family$/.test(problem.message.split(":")[0]) ? asks.family : null);
  let text = messageOf(error);
  if (at) {
    at.wrong.textContent = at === asks.family && problem.value === null ? "No column of the table names the family; choose it here." : sentence(problem.message);
    at.field.setAttribute("aria-invalid", "true");
    text = `${at.text}: see above.`;
  } else if (columns.fault(problem)) text = "A heading is not understood; say above what it means.";
  detail.replaceChildren();
  go.textContent = "Start";
  state.textContent = text;
  state.className = "fault";
}

/** @param {BatchCheck} answer */
function show(answer) {
  const all = answer.checked >= answer.rows, good = answer.rows - answer.bad;
  state.className = "";
  state.textContent = `${count(answer.rows, "row")}${all ? "" : `, the first ${figure(answer.checked)} checked`}: ${answer.bad ? answer.bad >= answer.checked ? "none can be asked" : `${figure(answer.bad)} faulty, the others can be asked` : "all can be asked"}.`;
  go.disabled = answer.checked <= answer.bad;
  go.textContent = answer.bad && !go.disabled ? `Start ${count(good, "row")} without the faulty` : `Start ${count(good, "row")}`;
  preview();
  const apart = gathered(answer.faults), faults = apart.slice(0, MOST_FAULTS), more = answer.more_faults + apart.length - faults.length;
  detail.replaceChildren(
    faults.length ? h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Faults" }, h("table", {}, h("thead", {}, h("tr", {}, ["Line", "Column", "There stands", "Right would be"].map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, faults.map((one) => h("tr", {}, h("th", { scope: "row", class: "number" }, linesText(one.lines)), h("td", {}, one.column ?? ""), h("td", { class: "fault wrong" }, one.value === null ? "nothing" : String(one.value)), h("td", {}, one.expected)))))) : "",
    more ? h("p", { class: "note" }, `and ${figure(more)} more`) : "",
    faults.length ? h("p", { class: "note" }, "Mend them in the file and bring it again, what you have chosen here stays; or go on without these rows.") : "",
    answer.carried.length ? h("p", { class: "note" }, `Carried along unread: ${answer.carried.join(", ")}.`) : "",
    ...Object.entries(answer.unused).map(([name, unused]) => h("p", { class: "note" }, `Not used by ${words(name)}: ${unused.join(", ")}.`)));
}

/**
 * Return faults; what is missing in many lines is one of them.
 * @param {Fault[]} faults
 */
function gathered(faults) {
  /** @type {Map<Fault | string, Fault & {lines: number[]}>} */
  const found = new Map();
  for (const one of faults) {
    const key = one.value === null ? `${one.column}\n${one.expected}` : one;
    found.set(key, { ...one, lines: [...(found.get(key)?.lines ?? []), one.line] });
  }
  return [...found.values()];
}

/** @param {number[]} lines */
const linesText = (lines) => lines.slice(0, 3).join(", ") + (lines.length > 3 ? ` and ${figure(lines.length - 3)} more` : "");

async function start() {
  go.disabled = true;
  const title = asks.title.field.value.trim();
  try {
    const job = await post("/batches", request());
    if (title) await ask("PATCH", `/jobs/${job.id}`, { title });
    location.assign(`/jobs/${job.id}`);
  } catch (error) {
    go.disabled = false;
    state.className = "fault";
    state.textContent = messageOf(error);
    say(state.textContent);
  }
}

begin();
