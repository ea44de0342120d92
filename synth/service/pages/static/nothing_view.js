// Nothing is feasible: what stands in the way, and what would help.

import { get, listen, maySubmit, messageOf, post, sentence } from "./api.js";
import { asWords, h } from "./dom.js";
import { FULL_DIGITS, number } from "./numbers.js";
import { quantity } from "./what_if_knobs.js";
import { LIVE, outcomeText, stageText } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./records.js").Explanation} Explanation
 * @typedef {import("./records.js").Patch} Patch
 * @typedef {import("./records.js").Way} Way
 * @typedef {Record<string, string | number>} Typed requirements as they were typed
 */

const MOST_OPEN = 4; // sentences of what was neither shown nor excluded

/**
 * Show why there is no design.
 * @param {HTMLElement} element
 * @param {Job} job a search without a design, or an explanation
 * @param {Job | null} explaining the explanation, where it is the job itself
 */
export async function nothingView(element, job, explaining) {
  const why = h("section", { class: "card stack" }), ways = h("section", { class: "card stack" });
  element.replaceChildren(why, ways);
  if (explaining) {
    why.remove();
    return tell(ways, job, { heading: "h2" });
  }
  const record = /** @type {import("./records.js").Front} */ (await get(`/jobs/${job.id}/result`));
  const conflicts = record.explanation?.conflicts ?? [];
  why.append(h("h2", {}, "Nothing is feasible"),
    h("p", {}, record.certificate?.kind === "global" ? "This is proven: no combination of parts and sizes holds all limits." : "No design was found that holds all limits."),
    conflicts.length ? h("p", {}, "The nearest that was found misses:") : h("p", {}, sentence(record.explanation?.message)),
    h("ul", { class: "misses" }, conflicts.map((conflict) => h("li", {}, missText(conflict.sentence)))));
  await seek(ways, job);
}

/**
 * @typedef {object} Ways
 * @property {"h2" | "h3"} heading tag of the heading
 * @property {boolean} [begin] whether they are looked for without being asked, behind what others wait for
 * @property {(job: Job) => void} [asked] is told the job that looks for them
 * @property {() => void} [told] is told when they are shown
 * @property {(patch: Patch) => (() => void) | null} [apply] what is done for a change in place of a new study
 */

/**
 * Find the explanation of a job, or ask for it; it is asked once.
 * @param {HTMLElement} ways
 * @param {Job} job
 * @param {Ways} [how]
 */
export async function seek(ways, job, how = { heading: "h2" }) {
  const known = (await get(`/jobs?kind=explain&parent=${job.id}&limit=1`)).jobs[0];
  if (known && !(how.begin && known.state === "cancelled")) return follow(ways, job, known, how);
  const fault = h("p", { class: "fault", role: "alert" });
  const begin = async () => {
    try {
      const { points, gap, objectives, weights, grid, ...request } = await get(`/jobs/${job.id}/request`);
      const title = `Ways out: ${job.title}`.slice(0, 200);
      const body = { kind: "explain", request: { ...request, ...(grid === undefined ? {} : { grid }) }, title, parent: job.id, ...(how.begin ? { priority: 0 } : {}) };
      const explaining = known ? await post(`/jobs/${known.id}/resume`) : await post("/jobs", body, { "Idempotency-Key": `ways-out-${job.id}` });
      how.asked?.(explaining);
      follow(ways, job, explaining, how);
    } catch (error) {
      how.told?.();
      fault.textContent = messageOf(error);
    }
  };
  ways.replaceChildren(h(how.heading, {}, "What would help?"), h("p", {}, "The smallest changes that make it feasible can be searched; that takes some seconds to minutes."),
    ...(maySubmit() ? [h("p", {}, h("button", { type: "button", class: "primary", onclick: begin }, "Find ways out"))] : []), fault);
  if (how.begin && maySubmit()) await begin();
}

/**
 * @param {HTMLElement} ways
 * @param {Job} job
 * @param {Job} explaining
 * @param {Ways} how
 */
function follow(ways, job, explaining, how) {
  const stage = h("p", { role: "status" }, stageText(explaining.progress));
  const show = async (/** @type {Job} */ found) => {
    how.told?.();
    if (found.state === "done") await tell(ways, found, how, job);
    else ways.replaceChildren(h(how.heading, {}, "Ways out"), h("p", {}, outcomeText(found)), h("p", {}, h("a", { href: `/jobs/${found.id}` }, "Look at it")));
  };
  if (!LIVE.includes(explaining.state)) return show(explaining);
  ways.replaceChildren(h(how.heading, {}, "Looking for ways out"), h("progress", { "aria-label": "Ways out are searched" }), stage);
  return listen([explaining.id], async (kind, told) => {
    if (kind === "progress") stage.textContent = stageText(told);
    if (kind === "end") show(await get(`/jobs/${explaining.id}`));
  });
}

/**
 * Return how a limit is missed, as people read it; a limit of one's own is told by its quantity alone.
 * @param {string} text
 */
const missText = (text) => asWords(text.replace(/^(\w+) [<>]= .*? is (?=[-\d])/, "$1 is ").replace(/(at least .*?) is allowed/, "$1 is needed"));

const REQUIREMENT = /^(\w+) (\S+) (.+) instead of (\S+) (.+?)( \(.*)?$/;

/**
 * Return the sentence of a requirement that was typed in another unit than the declared one with both.
 * @param {string} text
 * @param {string | number | undefined} typed
 */
function inUnit(text, typed) {
  const own = typeof typed === "string" ? quantity(typed, "") : null, found = REQUIREMENT.exec(text);
  if (!own?.unit || !found || own.unit === found[5] || /deg/.test(own.unit + found[5])) return text;
  const [, name, needed, unit, given, , rest = ""] = found;
  return `${name} ${needed} ${unit} (${number((own.number * Number(needed)) / Number(given), FULL_DIGITS)} ${own.unit}) instead of ${own.number} ${own.unit}${rest}`;
}

/**
 * Return how much a way out changes, and whether less would do.
 * @param {Way} way
 */
const amountText = (way, by = "") => h("p", { class: "note" }, by ? `${by}; ` : "", way.proven ? "proven: nothing less would do" : "perhaps less would do as well: not proven");

/**
 * Return a way out as what changes, to what, and by how much: the change is told apart from its amount.
 * @param {Way} way
 * @param {Typed} typed
 */
function change(way, typed) {
  const text = asWords(inUnit(way.sentence, typed[way.name]));
  const [, what, by] = /^(.*) \(([^()]* (?:more|less))\)$/.exec(text) ?? [null, text, ""];
  return [h("p", {}, what.replace(/^limit /, "")), amountText(way, by)];
}

/**
 * Return what gives way together, as a list.
 * @param {Way} way
 * @param {Typed} typed
 */
function together(way, typed) {
  const [, share, rest] = /^together, each by (.*?): (.*)$/.exec(way.sentence) ?? [null, "", way.sentence];
  const told = (/** @type {string} */ text) => asWords(inUnit(text, typed[text.split(" ")[0]])).replace(/^limit /, "");
  return [h("p", {}, "All of these together", share ? `, each by ${share}:` : ":"), h("ul", { class: "together" }, rest.split("; ").map((text) => h("li", {}, told(text)))), amountText(way)];
}

/**
 * Return what cannot hold, in words.
 * @param {Explanation} found
 */
function conflictText(found) {
  const names = found.conflict.map(asWords);
  if (!names.length) return asWords(sentence(found.message));
  if (names.length === 1) return `No design keeps ${names[0]}, however far other limits give way.`;
  return `These cannot hold together: ${names.join(", ")}.${found.minimal ? " If any one of them gives way, the others can hold." : ""}`;
}

const JOINT = ["joint", "physics"];

/**
 * Show what an explanation has found.
 * @param {HTMLElement} ways
 * @param {Job} explaining
 * @param {Ways} how
 * @param {Job} [job] whose question is changed by a way out
 */
async function tell(ways, explaining, how, job = explaining) {
  const found = /** @type {Explanation} */ (await get(`/jobs/${explaining.id}/result`));
  const typed = (await get(`/jobs/${job.id}/request`)).requirements ?? {};
  const apply = (/** @type {Way} */ way) => {
    if (!maySubmit()) return null;
    if (!Object.keys(way.patch ?? {}).length) return way.kind === "part" ? h("a", { class: "button", href: "/catalogues#bring" }, "Bring a table") : null;
    const own = how.apply?.(way.patch);
    const said = `Apply: ${asWords(way.name)}`;
    if (own) return h("button", { type: "button", "aria-label": said, onclick: own }, "Apply");
    return h("a", { class: how.apply ? "button" : "button primary", "aria-label": said, href: `/new?from=${job.id}#patch=${encodeURIComponent(JSON.stringify(way.patch))}` }, "Apply");
  };
  /** @typedef {(way: Way, typed: Typed) => Node[]} Telling */
  const list = (/** @type {Way[]} */ some, /** @type {Telling} */ told) => h("ul", { class: "ways" }, some.map((way) => h("li", {}, h("div", {}, told(way, typed)), apply(way))));
  const single = found.ways.filter(({ kind }) => !JOINT.includes(kind) && kind !== "part"), joint = found.ways.filter(({ kind }) => JOINT.includes(kind)), parts = found.ways.filter(({ kind }) => kind === "part");
  const sub = how.heading === "h2" ? "h3" : "h4";
  /** @type {(title: string, some: Way[], told: Telling) => Node[]} */
  const group = (title, some, told) => (some.length ? [h(sub, {}, title), list(some, told)] : []);
  ways.replaceChildren(h(how.heading, {}, "Ways out"), h("p", {}, conflictText(found)),
    ...group(single.length > 1 ? "Any one of these changes is enough" : "This change is enough", single, change),
    ...group(single.length ? "Or everything gives way a little" : "Everything gives way a little", joint, together),
    ...group("Or a part that no table has yet", parts, change),
    ...(found.ways.length ? [] : [h("p", {}, found.feasible ? "All limits can hold together." : "No single change was found that helps.")]),
    ...(found.not_settled ?? []).slice(0, MOST_OPEN).map((text) => h("p", { class: "note" }, `Not settled: ${asWords(text)}`)),
    found.interrupted ? h("p", { class: "note" }, `Interrupted: ${found.interrupted}`) : "");
}
