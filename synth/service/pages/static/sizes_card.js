// Standard sizes for the rows of a batch: asked beside it, and shown as a page of their own.

import { get, listen, maySubmit, messageOf, post, problemsOf } from "./api.js";
import { cellsOf, headingOf, sheet, short } from "./csv.js";
import { curveOf } from "./curve.js";
import { asWords, figure, h, unitText, words } from "./dom.js";
import { stated } from "./fields.js";
import { percent } from "./numbers.js";
import { requestField } from "./request_field.js";
import { LIVE, badge, count, outcomeText, rowBadge } from "./words.js";

/** @typedef {import("./answers.js").JobAnswer} Job */

const MOST_LISTED = 5;

/**
 * Return what a batch offers where it has designs: its standard sizes.
 * @param {Job} job
 */
export function sizesCard(job) {
  const element = h("section", { class: "card stack", hidden: true });
  if (job.state === "done" && job.summary?.designs) offer(element, job).catch(() => {});
  return element;
}

/**
 * @param {HTMLElement} element
 * @param {Job} job
 */
async function offer(element, job) {
  const [{ jobs }, many] = await Promise.all([get(`/jobs?kind=size_range&parent=${job.id}&limit=${MOST_LISTED}`),
    maySubmit() ? requestField("size_range", "variants", { hint: "the fewest", changed: () => {} }) : null]);
  if (!jobs.length && !many) return;
  const slot = h("div");
  const fault = h("p", { class: "fault", role: "alert" });
  const ask = h("button", { type: "submit" }, "Choose sizes");
  const form = many && h("form", { class: "stack", novalidate: true, onsubmit: async (event) => {
    event.preventDefault();
    fault.textContent = "";
    ask.disabled = true;
    const variants = stated(many.value, "");
    try {
      const made = await post("/jobs", { kind: "size_range", request: { of: job.id, ...(variants === "" ? {} : { variants }) }, parent: job.id });
      location.assign(`/jobs/${made.id}`);
    } catch (error) {
      const problem = problemsOf(error).find(({ path }) => path.at(-1) === "variants");
      many.show(problem ?? null, "");
      fault.textContent = problem ? "" : messageOf(error);
      ask.disabled = false;
    }
  } }, many.element, h("p", {}, ask));
  element.hidden = false;
  const asked = jobs.length ? h("ul", { class: "stack" }, jobs.map((one) => h("li", { class: "row" }, badge(one), h("a", { href: `/jobs/${one.id}` }, sizesText(one))))) : null;
  element.replaceChildren(...[h("h2", {}, "Standard sizes"), h("p", { class: "note" }, "A batch gives every row its own best design. Which few designs would serve all rows, and what would that cost?"), form, fault, asked, slot].filter((one) => one !== null));
  const done = jobs.find((one) => one.state === "done");
  const drawn = done ? await excessOf(done) : null;
  if (drawn) slot.replaceChildren(drawn);
  const live = jobs.filter((one) => LIVE.includes(one.state)).map((one) => one.id);
  if (live.length) listen(live, (kind) => { if (kind === "end") offer(element, job).catch(() => {}); });
}

/** @param {Job} job */
const sizesText = (job) => (job.summary?.variants ? `${count(job.summary.variants, "size")}, total excess of ${words(job.summary.objective)} ${figure(job.summary.total_excess)} ${unitText(job.summary.unit)}`.trim() : outcomeText(job));

/**
 * @param {Job} job
 * @param {string} name
 */
const table = (job, name) => /** @type {Promise<string>} */ (get(`/jobs/${job.id}/files/${name}?raw=1`));

/** @param {Job} job */
async function excessOf(job) {
  const [header, ...rows] = cellsOf(await table(job, "curve.csv"));
  /** @type {[size: number, excess: number | null][]} */
  const points = rows.map(([sizes, excess]) => [Number(sizes), excess === "" ? null : Number(excess)]);
  const { objective, variants = NaN } = job.summary ?? {};
  const up = { name: `total excess of ${words(objective)}`, unit: headingOf(header[1]).unit, note: "over the number of sizes: what more would save, and fewer cost" };
  const chosen = { value: variants, ends: false, text: "chosen" };
  return points.length > 1 ? curveOf({ name: "number of sizes", unit: "", whole: true }, up, [{ points }], { zero: true, marks: [chosen] }) : null;
}

/**
 * Show which sizes were chosen, what they cost, and which row each serves.
 * @param {HTMLElement} element
 * @param {Job} job
 */
export async function sizesView(element, job) {
  const [record, request, variants, assignment, unserved, drawn] = await Promise.all([/** @type {Promise<import("./records.js").SizeRange>} */ (get(`/jobs/${job.id}/result`)), get(`/jobs/${job.id}/request`), table(job, "variants.csv"), table(job, "assignment.csv"), table(job, "unserved.csv"), excessOf(job)]);
  const batch = job.parent ?? request.of;
  /**
   * @param {string} text
   * @param {string} name
   */
  const told = (text, name) => (name === "line" && batch ? h("a", { href: `/jobs/${batch}/rows/${text}` }, text) : name === "family" ? words(text) : name === "status" ? rowBadge(text) : name === "reason" && text.startsWith("No ") ? short(asWords(text)) : null);
  const one = new Set(cellsOf(variants).slice(1).map((cells) => cells[1])).size < 2; // family
  /** @param {string} text */
  const lines = (text) => {
    const [names, ...rest] = ["row", ...(one ? ["family"] : [])].reduce(without, cellsOf(text)); // a row is known by its line here
    return [names.map((name) => (name === "variant" ? "size" : name)), ...rest];
  };
  const [, ...left] = cellsOf(unserved), unit = unitText(record.unit);
  element.replaceChildren(
    h("section", { class: "card stack certificate proven" }, h("h2", {}, `${count(record.variants, "size")} for ${count(cellsOf(assignment).length - 1, "row")}`),
      h("p", {}, `Total excess of ${words(record.objective)} over each row's own best: ${figure(record.total_excess)} ${unit}, ${record.gap > 0 ? `proven to within ${percent(record.gap)}` : "proven"}. The fewest that serve all rows: ${record.fewest}${record.fewest_proven ? "" : ", not proven to be the fewest"}.`),
      left.length ? h("p", { class: "fault" }, `${count(left.length, "row")} ${left.length === 1 ? "is" : "are"} not served; see below.`) : null),
    drawn ? h("section", { class: "card" }, drawn) : h("div"),
    h("section", { class: "card stack" }, h("h2", {}, "The sizes"), sheet(lines(variants), { label: "The sizes", cell: told })),
    h("section", { class: "card stack" }, h("h2", {}, "Which row gets which"), sheet(lines(assignment), { label: "Which row gets which", cell: told })),
    ...(left.length ? [h("section", { class: "card stack" }, h("h2", {}, "Not served"), sheet(lines(unserved), { label: "Not served", cell: told }))] : []));
}

/**
 * Return lines without a column.
 * @param {string[][]} lines
 * @param {string} name
 */
function without(lines, name) {
  const k = lines[0].indexOf(name);
  if (k < 0) return lines;
  return lines.map((line) => line.filter((_, own) => own !== k));
}
