// A table of duties: brought, checked line by line, and asked.

import { ask, faultCard, get, maySubmit, post, sentence } from "./api.js";
import { amount, h, words } from "./dom.js";
import { count } from "./words.js";

const place = document.getElementById("batch");
const MOST_FAULTS = 100, PATIENCE = 300;
const table = { upload: null, families: [] };

const file = h("input", { type: "file", id: "file", class: "unseen", accept: ".csv,.xlsx,text/csv", onchange: () => file.files[0] && bring(file.files[0]) });
const dropped = h("div", { class: "drop", ondragover: (event) => { event.preventDefault(); dropped.classList.add("over"); }, ondragleave: () => dropped.classList.remove("over"), ondrop: (event) => {
  event.preventDefault();
  dropped.classList.remove("over");
  if (event.dataTransfer.files[0]) bring(event.dataTransfer.files[0]);
} }, h("p", {}, "Drop a table here, or ", h("label", { class: "button", for: "file" }, "choose a file"), file),
h("p", { class: "note" }, "CSV in UTF-8, or an Excel workbook. Headings are names of requirements, such as ", h("code", {}, "load_torque [N*m]"), "; other columns are carried along."));
const fault = h("p", { class: "fault", role: "alert" });
const family = h("select", { id: "family", onchange: later });
const points = h("input", { id: "points", inputmode: "numeric", value: "1", autocomplete: "off", oninput: later });
const objectives = h("input", { id: "objectives", autocomplete: "off", spellcheck: "false", placeholder: "those of the family", oninput: later });
const title = h("input", { id: "title", maxlength: "200", autocomplete: "off", placeholder: "made of the file, if empty" });
const labelled = (text, field) => h("p", { class: "labelled" }, h("label", { for: field.id }, text), field);
const first = h("section", { class: "card", hidden: true });
const told = h("section", { class: "card", hidden: true });
const go = h("button", { type: "button", class: "primary", disabled: true, onclick: start }, "Start");
const state = h("p", { role: "status" });

async function begin() {
  try {
    const { families } = await get("/families");
    table.families = families;
    family.replaceChildren(h("option", { value: "" }, "as a column of the table says"), ...families.map((one) => h("option", { value: one.name }, one.title)));
    const asked = new URLSearchParams(location.search).get("family");
    family.value = families.some((one) => one.name === asked) ? asked : "";
    place.replaceChildren(maySubmit() ? h("div", {}, h("section", { class: "card stack" }, h("h2", {}, "The table"), dropped, fault),
      h("section", { class: "card" }, h("h2", {}, "What is asked of all rows"), h("div", { class: "asks" }, labelled("Family", family), labelled("Objectives", objectives), labelled("Designs a row, at most", points), labelled("Title", title))),
      first, told) : h("p", { class: "card note" }, "Your token may look at jobs, not ask for any."));
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

async function bring(chosen) {
  fault.textContent = "";
  first.hidden = told.hidden = true;
  const form = new FormData();
  form.append("file", chosen);
  try {
    const brought = await post("/uploads", form);
    table.upload = brought.id;
    first.hidden = false;
    first.replaceChildren(h("h2", {}, brought.name), h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "First rows" }, h("table", {},
      h("caption", {}, `${amount(brought.size)} bytes; the first ${count(brought.rows.length, "row")}`),
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Line"), brought.header.map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, brought.rows.map((row) => h("tr", {}, h("td", { class: "number" }, row.line), row.cells.map((cell) => h("td", {}, cell))))))));
    await check();
  } catch (error) {
    table.upload = null;
    fault.textContent = sentence(error.message);
  } finally {
    file.value = "";
  }
}

let waiting, number = 0;
function later() {
  clearTimeout(waiting);
  go.disabled = true;
  if (table.upload) waiting = setTimeout(check, PATIENCE);
}

function request() {
  const names = objectives.value.split(",").map((name) => name.trim().replaceAll(" ", "_")).filter(Boolean);
  const many = points.value.trim();
  return { upload: table.upload, ...(family.value ? { family: family.value } : {}), ...(names.length ? { objectives: names } : {}), ...(many ? { points: /^\d+$/.test(many) ? Number(many) : many } : {}) };
}

async function check() {
  const own = (number += 1);
  told.hidden = false;
  go.disabled = true;
  state.textContent = "Checking the rows …";
  if (!told.contains(state)) told.replaceChildren(h("h2", {}, "Check"), state);
  try {
    const answer = await post("/batches/check", request());
    if (own === number) show(answer);
  } catch (error) {
    if (own === number) told.replaceChildren(h("h2", {}, "Check"), h("p", { class: "fault", role: "alert" }, sentence(error.message)));
  }
}

function show(answer) {
  const all = answer.checked >= answer.rows;
  state.textContent = `${count(answer.rows, "row")}${all ? "" : `, the first ${amount(answer.checked)} checked`}: ${answer.bad ? `${amount(answer.bad)} faulty, the others can be asked` : "all can be asked"}.`;
  go.disabled = answer.checked <= answer.bad;
  go.textContent = `Start ${count(answer.rows - answer.bad, "row")}`;
  const understood = answer.columns.filter((column) => column.name);
  told.replaceChildren(h("h2", {}, "Check"), state,
    answer.faults.length ? h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Faults" }, h("table", {}, h("thead", {}, h("tr", {}, ["Line", "Column", "What is wrong"].map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, answer.faults.slice(0, MOST_FAULTS).map((one) => h("tr", {}, h("td", { class: "number" }, one.line), h("td", {}, one.column ?? ""), h("td", { class: "fault" }, one.message)))))) : "",
    answer.more_faults ? h("p", { class: "note" }, `and ${amount(answer.more_faults)} more`) : "",
    h("p", { class: "note" }, `Understood: ${understood.map((column) => words(column.name)).join(", ") || "no column"}.`),
    answer.carried.length ? h("p", { class: "note" }, `Carried along: ${answer.carried.join(", ")}.`) : "",
    ...Object.entries(answer.unused).map(([name, columns]) => h("p", { class: "note" }, `Not used by ${words(name)}: ${columns.join(", ")}.`)),
    h("p", { class: "row" }, go));
}

async function start() {
  go.disabled = true;
  try {
    const own = request();
    const job = await post("/batches", own);
    if (title.value.trim()) await ask("PATCH", `/jobs/${job.id}`, { title: title.value.trim() });
    location.assign(`/jobs/${job.id}`);
  } catch (error) {
    go.disabled = false;
    told.append(h("p", { class: "fault", role: "alert" }, sentence(error.message)));
  }
}

begin();
