// Part tables of one's own: versions, what each has changed, and which jobs name them.

import { ask, faultCard, get, maySubmit, post, sentence } from "./api.js";
import { h, say, when } from "./dom.js";
import { count } from "./words.js";

const place = document.getElementById("catalogues");
const listed = h("div"), shown = h("div");

async function begin() {
  try {
    await list();
    place.replaceChildren(listed, shown, maySubmit() ? bringing() : "");
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

async function list() {
  const { catalogues } = await get("/catalogues");
  listed.replaceChildren(catalogues.length ? h("section", { class: "card" }, h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Tables" }, h("table", {},
    h("thead", {}, h("tr", {}, ["Version", "Rows for", "Rows", "Brought", "Note", ""].map((name) => h("th", { scope: "col" }, name)))),
    h("tbody", {}, catalogues.map((entry) => h("tr", {}, h("th", { scope: "row" }, h("button", { type: "button", class: "small", onclick: () => show(entry) }, entry.reference)), h("td", {}, entry.table), h("td", { class: "number" }, entry.rows), h("td", {}, when(entry.created)), h("td", {}, entry.note),
      h("td", {}, maySubmit() ? h("button", { type: "button", class: "small", "aria-label": `Remove ${entry.reference}`, onclick: (event) => remove(entry, event.target) }, "Remove") : null)))))))
    : h("p", { class: "card note" }, "You have brought no table. Studies use the tables that are shipped with the families."));
}

async function remove(entry, button) {
  if (button.dataset.sure !== "yes") {
    button.dataset.sure = "yes";
    button.textContent = "Really remove?";
    button.classList.add("danger");
    return;
  }
  try {
    await ask("DELETE", `/catalogues/${entry.name}/${entry.version}`);
    shown.replaceChildren();
    await list();
    say(`${entry.reference} is removed`);
  } catch (error) {
    shown.replaceChildren(faultCard(error));
  }
}

async function show(entry) {
  try {
    const [found, changes] = await Promise.all([get(`/catalogues/${entry.name}/${entry.version}`), entry.version > 1 ? get(`/catalogues/${entry.name}/${entry.version}/changes?since=${entry.version - 1}`).catch(() => null) : null]);
    const named = (title, names) => (names.length ? h("p", {}, `${title}: ${names.join(", ")}`) : null);
    shown.replaceChildren(h("section", { class: "card stack" }, h("h2", { tabindex: "-1" }, entry.reference),
      found.used_by.length ? h("p", { class: "note" }, `Named by ${count(found.used_by.length, "job")}: `, found.used_by.slice(0, 5).map((job, k) => [k ? ", " : "", h("a", { href: `/jobs/${job}` }, job.slice(-6))])) : h("p", { class: "note" }, "No job names it."),
      changes ? h("div", { class: "stack" }, h("h3", {}, `Since version ${entry.version - 1}`), named("Added", changes.added), named("Removed", changes.removed), named("Columns added", changes.columns_added), named("Columns removed", changes.columns_removed),
        changes.changed.length ? h("ul", {}, changes.changed.map((cell) => h("li", {}, `${cell.designation}, ${cell.column}: ${cell.before || "empty"} → ${cell.after || "empty"}`))) : null) : null,
      h("pre", { tabindex: "0", "aria-label": "Rows as CSV" }, found.csv)));
    shown.querySelector("h2").focus();
  } catch (error) {
    shown.replaceChildren(faultCard(error));
  }
}

function bringing() {
  const name = h("input", { id: "name", maxlength: "60", autocomplete: "off", spellcheck: "false", placeholder: "my_linings" });
  const table = h("input", { id: "table", autocomplete: "off", spellcheck: "false", placeholder: "friction_materials, as its name if empty" });
  const note = h("input", { id: "note", maxlength: "200", autocomplete: "off", placeholder: "what is new in it" });
  const csv = h("textarea", { id: "csv", rows: "8", class: "wide", spellcheck: "false" });
  const file = h("input", { type: "file", id: "csv-file", class: "unseen", accept: ".csv,text/csv", onchange: async () => { if (file.files[0]) csv.value = await file.files[0].text(); } });
  const fault = h("p", { class: "fault", role: "alert" });
  const labelled = (text, field) => h("p", { class: "labelled" }, h("label", { for: field.id }, text), field);
  return h("form", { class: "card stack", novalidate: true, onsubmit: async (event) => {
    event.preventDefault();
    fault.textContent = "";
    try {
      const made = await post("/catalogues", { name: name.value.trim(), table: table.value.trim(), csv: csv.value, note: note.value.trim() });
      csv.value = note.value = "";
      await list();
      say(`${made.reference} is kept`);
      show(made);
    } catch (error) {
      fault.textContent = sentence(error.message);
    }
  } }, h("h2", {}, "Bring a table"), h("div", { class: "asks" }, labelled("Name", name), labelled("Rows for the table", table), labelled("Note", note)),
  h("p", { class: "row" }, h("label", { for: "csv" }, "Rows as CSV"), h("label", { class: "button small", for: "csv-file" }, "From a file"), file), csv, fault, h("p", {}, h("button", { type: "submit", class: "primary" }, "Keep as a new version")));
}

begin();
