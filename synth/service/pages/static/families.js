// The families: what each declares, with the sources of its formulas.

import { faultCard, get, maySubmit } from "./api.js";
import { amount, h, symbol, unitText, words } from "./dom.js";

const place = document.getElementById("families");
const SECTIONS = [
  ["needed", "Needed"], ["limit", "Limits"], ["assumption", "Assumptions"], ["option", "Options"], ["variable", "Sizes"], ["count", "Counts"], ["part", "Parts"],
  ["objective", "Objectives"], ["derived", "Derived quantities"], ["refusal", "What is refused"], ["advice", "Advice"],
];

async function begin() {
  try {
    if (place.dataset.family) declaration(await get(`/families/${place.dataset.family}`));
    else list((await get("/families")).families);
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

function list(families) {
  place.replaceChildren(h("h1", {}, "Families"), h("p", { class: "note lead" }, "What can be designed, and where its formulas come from."),
    h("ul", { class: "offers" }, families.map((family) => h("li", { class: "card stack" }, h("h2", {}, h("a", { href: `/families/${family.name}` }, family.title)), h("p", { class: "grow" }, family.line),
      h("p", { class: "note" }, `${family.sources.length} sources · ${family.options.length} options`), maySubmit() ? h("p", {}, h("a", { class: "button small", href: `/new?family=${family.name}` }, "New study")) : null))));
}

function declaration(family) {
  document.title = `${family.title} · clutchsynth`;
  const find = h("input", { type: "search", class: "find", placeholder: "Find a name or a text", "aria-label": "Find a name or a text", oninput: () => {
    const wanted = find.value.toLowerCase();
    for (const line of place.querySelectorAll("tbody tr")) line.hidden = !line.textContent.toLowerCase().includes(wanted);
    if (wanted) for (const one of place.querySelectorAll("details")) one.open = true;
  } });
  place.replaceChildren(h("p", { class: "note" }, h("a", { href: "/families" }, "Families")), h("div", { class: "heading" }, h("h1", {}, family.title), h("div", { class: "row" }, find, maySubmit() ? h("a", { class: "button primary", href: `/new?family=${family.name}` }, "New study") : null)),
    h("section", { class: "card" }, h("h2", {}, "Sources"), h("ul", { class: "sources" }, family.sources.map((source) => h("li", {}, source)))),
    ...SECTIONS.map(([name, title]) => section(title, family.rows.filter((row) => row.section === name))).filter(Boolean));
}

function section(title, rows) {
  if (!rows.length) return null;
  return h("section", { class: "card" }, h("details", { open: title === "Needed" }, h("summary", {}, h("h2", {}, title), h("span", { class: "note" }, String(rows.length))), h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": title }, h("table", { class: "declared" },
    h("thead", {}, h("tr", {}, ["Name", "Unit", "Default", "Range or choices", "Meaning", "Source"].map((name) => h("th", { scope: "col" }, name)))),
    h("tbody", {}, rows.map((row) => h("tr", {}, h("th", { scope: "row" }, h("code", {}, row.name), " ", symbol(row.symbol)), h("td", {}, unitText(row.unit)), h("td", { class: "default" }, row.optional && row.default === null ? "not asked" : amount(row.default)),
      h("td", { class: "choices" }, row.choices || (row.lower === null ? "" : `${amount(row.lower)} … ${amount(row.upper)}`)), h("td", { class: "text" }, row.text), h("td", { class: "text note" }, row.source))))))));
}

begin();
