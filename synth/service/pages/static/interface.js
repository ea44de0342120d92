// The interface as its description tells it.

import { faultCard, get } from "./api.js";
import { h } from "./dom.js";

const place = document.getElementById("interface");
const METHODS = ["get", "post", "patch", "delete"];

async function begin() {
  try {
    const told = await get("/openapi.json");
    const groups = new Map();
    for (const [path, methods] of Object.entries(told.paths)) {
      for (const method of METHODS.filter((name) => methods[name])) {
        const tag = methods[method].tags?.[0] ?? "more";
        groups.set(tag, [...(groups.get(tag) ?? []), operation(told, path, method, methods[method])]);
      }
    }
    place.replaceChildren(...[...groups].map(([tag, operations]) => h("section", { class: "card" }, h("h2", {}, tag[0].toUpperCase() + tag.slice(1)), h("ul", { class: "operations" }, operations.map((one) => h("li", {}, one))))));
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

function operation(told, path, method, own) {
  const parameters = own.parameters ?? [];
  const body = own.requestBody ? exampleOf(told, own.requestBody) : null;
  return h("details", {}, h("summary", {}, h("span", { class: `method ${method}` }, method.toUpperCase()), h("code", {}, path), h("span", { class: "note" }, own.summary ?? "")),
    h("div", { class: "stack operation" }, own.description ? h("p", {}, own.description.split("\n\n")[0]) : null,
      parameters.length ? h("div", { class: "scroll" }, h("table", {}, h("thead", {}, h("tr", {}, ["Parameter", "In", "What it is"].map((name) => h("th", { scope: "col" }, name)))),
        h("tbody", {}, parameters.map((one) => h("tr", {}, h("th", { scope: "row" }, h("code", {}, one.name), one.required ? " needed" : ""), h("td", {}, one.in), h("td", {}, one.description ?? "")))))) : null,
      body ? h("div", {}, h("h3", {}, "Body"), h("pre", { tabindex: "0" }, body)) : null,
      h("div", {}, h("h3", {}, "Answers"), h("ul", {}, Object.entries(own.responses ?? {}).map(([status, answer]) => h("li", {}, h("code", {}, status), ` ${answer.description ?? ""}`))))));
}

/** Return the example of a body, as JSON. */
function exampleOf(told, body) {
  const content = Object.values(body.content)[0];
  const schema = content.schema?.$ref ? told.components.schemas[content.schema.$ref.split("/").at(-1)] : content.schema;
  const example = Object.values(content.examples ?? {})[0]?.value ?? schema?.examples?.[0];
  return example === undefined ? Object.keys(body.content)[0] : JSON.stringify(example, null, 2);
}

begin();
