// The interface as its description tells it: routes, parameters, bodies and answers, drawn here and from nowhere else.

import { faultCard, get } from "./api.js";
import { allOf, byId, h } from "./dom.js";

/**
 * @typedef {import("./dom.js").Child} Child
 * @typedef {{[key: string]: unknown, $ref?: string, anyOf?: Schema[], oneOf?: Schema[], type?: string | string[], const?: unknown, enum?: unknown[], format?: string, items?: Schema,
 *   properties?: Record<string, Schema>, required?: string[], description?: string, examples?: unknown[]}} Schema
 * @typedef {{schema?: Schema, examples?: Record<string, {value: unknown}>}} Content
 * @typedef {object} Operation
 * @property {string[]} [tags]
 * @property {string} [summary]
 * @property {string} [description]
 * @property {{name: string, in: string, required?: boolean, description?: string, schema?: Schema}[]} [parameters]
 * @property {{description?: string, content: Record<string, Content>}} [requestBody]
 * @property {Record<string, {description?: string, content?: Record<string, Content>}>} [responses]
 */

const place = byId("interface");
const METHODS = ["get", "post", "patch", "delete"];
const DEEPEST = 3; // levels of answers that are shown; what is deeper is in openapi.json
/** @type {Record<string, Schema>} */
let schemas = {};

async function begin() {
  try {
    const told = /** @type {{paths: Record<string, Record<string, Operation>>, components: {schemas: Record<string, Schema>}}} */ (await get("/openapi.json"));
    schemas = told.components.schemas;
    /** @type {Map<string, HTMLElement[]>} */
    const groups = new Map();
    for (const [path, methods] of Object.entries(told.paths)) {
      for (const method of METHODS.filter((name) => methods[name])) {
        const tag = methods[method].tags?.[0] ?? "more";
        groups.set(tag, [...(groups.get(tag) ?? []), operation(path, method, methods[method])]);
      }
    }
    const said = h("span", { class: "note", role: "status" });
    const find = h("input", { type: "search", class: "find", placeholder: "Find a route", "aria-label": "Find a route", oninput: () => {
      const wanted = find.value.toLowerCase(), lines = allOf(place, ".operations > li");
      for (const line of lines) line.hidden = !(line.querySelector("summary")?.textContent ?? "").toLowerCase().includes(wanted);
      for (const card of allOf(place, "section.card")) card.hidden = !card.querySelector(".operations > li:not([hidden])");
      said.textContent = wanted ? `${lines.filter((line) => !line.hidden).length} found` : "";
    } });
    place.replaceChildren(h("p", { class: "row" }, find, said), ...[...groups].map(([tag, operations]) => h("section", { class: "card" }, h("h2", {}, tag[0].toUpperCase() + tag.slice(1)), h("ul", { class: "operations" }, operations.map((one) => h("li", {}, one))))));
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

/**
 * @param {string} path
 * @param {string} method
 * @param {Operation} own
 */
function operation(path, method, own) {
  const details = h("details", { ontoggle: () => { if (details.open && details.children.length < 2) details.append(described(path, method, own)); } },
    h("summary", {}, h("span", { class: `method ${method}` }, method.toUpperCase()), h("code", {}, path), h("span", { class: "note" }, own.summary ?? "")));
  return details;
}

/**
 * @param {string} path
 * @param {string} method
 * @param {Operation} own
 */
function described(path, method, own) {
  const parameters = own.parameters ?? [], body = own.requestBody ? Object.entries(own.requestBody.content)[0] : null;
  const example = body ? exampleOf(body[1]) : undefined;
  return h("div", { class: "stack operation" }, (own.description ?? "").split("\n\n").filter(Boolean).map((text) => h("p", {}, coded(text))),
    parameters.length ? table("Parameters", ["Parameter", "In", "Type", "What it is"], parameters.map((one) => [named(one.name, one.required), one.in, typeOf(one.schema), coded(one.description ?? one.schema?.description ?? "")])) : null,
    body ? [h("h3", {}, "Body"), fieldsOf(body[1].schema, 0) ?? h("p", {}, coded(body[1].schema?.description ?? own.requestBody?.description ?? (example === undefined ? body[0] : "An object, as below.")))] : null,
    example === undefined ? null : [h("h3", {}, "By example"), h("pre", { tabindex: "0", "aria-label": "Example" }, curl(path, method, example))],
    h("h3", {}, "Answers"), answersOf(own.responses ?? {}));
}

/**
 * Return what may come back; what answers with the same object tells its fields once.
 * @param {Record<string, {description?: string, content?: Record<string, Content>}>} responses
 */
function answersOf(responses) {
  const told = new Set();
  return h("ul", { class: "schema" }, Object.entries(responses).map(([status, answer]) => {
    const [media, content] = Object.entries(answer.content ?? {})[0] ?? [];
    const kind = JSON.stringify(content?.schema ?? null);
    const fields = status < "300" && media === "application/json" && !told.has(kind) ? fieldsOf(content.schema, 0, false) : null;
    told.add(kind);
    return h("li", {}, h("code", {}, status), ` ${answer.description ?? ""}`, fields);
  }));
}

/**
 * Return a text with what stands in backticks as code.
 * @param {string} text
 */
const coded = (text) => text.split("`").map((part, k) => (k % 2 ? h("code", {}, part) : part));
/**
 * @param {string} name
 * @param {boolean | undefined} needed
 */
const named = (name, needed) => [h("code", {}, name), needed ? h("span", { class: "note" }, " needed") : null];

/**
 * @param {string} label
 * @param {string[]} heads
 * @param {Child[][]} lines
 */
function table(label, heads, lines) {
  return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, h("table", {}, h("thead", {}, h("tr", {}, heads.map((name) => h("th", { scope: "col" }, name)))),
    h("tbody", {}, lines.map(([first, ...rest]) => h("tr", {}, h("th", { scope: "row" }, first), rest.map((cell) => h("td", {}, cell)))))));
}

/** @param {string} reference */
const nameOf = (reference) => reference.slice(reference.lastIndexOf("/") + 1);

/**
 * @param {Schema | undefined} schema
 * @returns {Schema}
 */
const resolved = (schema) => (schema?.$ref ? schemas[nameOf(schema.$ref)] : schema) ?? {};
/** @param {Schema | undefined} schema */
const some = (schema) => (schema?.anyOf ?? schema?.oneOf ?? []).filter((one) => one.type !== "null");

/**
 * Return the type of a value in words.
 * @param {Schema | undefined} schema
 * @returns {string}
 */
function typeOf(schema) {
  if (!schema) return "";
  if (some(schema).length) return some(schema).map(typeOf).join(" or ") + (schema.anyOf?.some((one) => one.type === "null") ? ", or nothing" : "");
  const own = resolved(schema);
  const known = schema.enum ?? own.enum;
  if (known) return known.join(", ");
  if (own.const !== undefined) return JSON.stringify(own.const);
  if (Array.isArray(own.type)) return own.type.map((type) => typeOf({ type })).join(" or ");
  if (own.type === "array") return `list of ${typeOf(own.items) || "values"}`;
  return schema.$ref ? nameOf(schema.$ref).replace(/([a-z])([A-Z])/g, "$1 $2").toLowerCase() : own.format && own.format !== "binary" ? own.format : own.type === "integer" ? "whole number" : own.type ?? "anything";
}

/**
 * Return the fields of an object, and below each those of what it holds.
 * @param {Schema | undefined} schema
 * @param {number} level
 * @param {boolean} [asked]
 * @returns {HTMLElement | null}
 */
function fieldsOf(schema, level, asked = true) {
  const own = resolved(schema), fields = Object.entries(own.properties ?? {});
  if (!fields.length) return some(own).map((one) => fieldsOf(one, level, asked)).find(Boolean) ?? null;
  const inner = (/** @type {Schema} */ one) => { const held = some(one)[0] ?? one; return resolved(held).type === "array" ? resolved(held).items : held; };
  return h("ul", { class: "schema" }, fields.map(([name, one]) => h("li", {}, named(name, asked && own.required?.includes(name)), " ", h("span", { class: "note" }, typeOf(one)), one.description ? [" – ", coded(one.description)] : "", level + 1 < DEEPEST ? fieldsOf(inner(one), level + 1, asked) : null)), kindsOf(own));
}

/**
 * Return what each kind of job takes as its request, to be opened one by one.
 * @param {Schema} own
 * @returns {HTMLElement[]}
 */
function kindsOf(own) {
  return some(own).flatMap(({ properties: { kind, request } = {} }) => (kind?.const ? { kind: String(kind.const), request } : [])).map(({ kind, request }) => {
    const asked = resolved(request), forms = asked.properties ? [asked] : some(asked);
    return h("li", {}, h("details", {}, h("summary", {}, "request of ", h("code", {}, kind)), forms.map((form) => [h("p", {}, coded(form.description ?? "")), fieldsOf(form, 0)])));
  });
}

/** @param {Content} content */
function exampleOf(content) {
  return Object.values(content.examples ?? {})[0]?.value ?? resolved(content.schema).examples?.[0];
}

/**
 * @param {string} path
 * @param {string} method
 * @param {unknown} example
 */
const curl = (path, method, example) => `curl -s ${method === "post" ? "" : `-X ${method.toUpperCase()} `}${location.origin}${path} \\\n  -H "Authorization: Bearer $TOKEN" \\\n  --json '${JSON.stringify(example, null, 2).replaceAll("'", "'\\''")}'`;

begin();
