// A field of a request, as the description of the service has it: its form is that of what families declare.

import { get } from "./api.js";
import { Field } from "./fields.js";

/**
 * Make the field of a request.
 * @template {keyof import("./answers.js").Requests} K
 * @param {K} kind of the job
 * @param {string & keyof import("./answers.js").Requests[K]} name
 * @param {{hint: string, changed: () => void}} how
 */
export async function requestField(kind, name, { hint, changed }) {
  const { components } = /** @type {{components: {schemas: Record<string, {properties: Record<string, {description: string, minimum?: number, maximum?: number}>}>}}} */ (await get("/openapi.json"));
  const title = kind.split("_").map((word) => word[0].toUpperCase() + word.slice(1)).join("");
  const { description, minimum, maximum } = components.schemas[`${title}Question`].properties[name];
  return new Field({ name, text: description, unit: "", symbol: "", source: "", section: "limit", lower: minimum ?? null, upper: maximum ?? null }, { path: ["request", name], hint, value: "", changed });
}
