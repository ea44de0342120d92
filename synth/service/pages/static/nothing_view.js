// Nothing is feasible: what stands in the way, and what would help.

import { get, listen, maySubmit, post, sentence } from "./api.js";
import { asWords, h } from "./dom.js";
import { LIVE, outcomeText, stageText } from "./words.js";

/**
 * Show why there is no design.
 * @param {HTMLElement} element
 * @param {object} job a search without a design, or an explanation
 * @param {object | null} explaining the explanation, where it is the job itself
 */
export async function nothingView(element, job, explaining) {
  const why = h("section", { class: "card stack" }), ways = h("section", { class: "card stack" });
  element.replaceChildren(why, ways);
  if (explaining) {
    why.remove();
    return tell(ways, job, await get(`/jobs/${job.id}/result`), { heading: "h2" });
  }
  const record = await get(`/jobs/${job.id}/result`);
  const told = record.explanation ?? {};
  const conflicts = told.conflicts ?? [];
  why.append(h("h2", {}, "Nothing is feasible"),
    h("p", {}, record.certificate?.kind === "global" ? "This is proven: no combination of parts and sizes holds all limits." : "No design was found that holds all limits."),
    conflicts.length ? h("p", {}, "The nearest that was found misses:") : h("p", {}, sentence(told.message)),
    h("ul", { class: "misses" }, conflicts.map((conflict) => h("li", {}, asWords(conflict.sentence)))));
  await seek(ways, job);
}

/**
 * @typedef {object} Ways
 * @property {string} heading tag of the heading
 * @property {boolean} [begin] whether they are looked for without being asked, behind what others wait for
 * @property {(job: object) => void} [asked] is told the job that looks for them
 * @property {() => void} [told] is told when they are shown
 * @property {(patch: object) => (() => void) | null} [apply] what is done for a change in place of a new study
 */

/**
 * Find the explanation of a job, or ask for it; it is asked once.
 * @param {HTMLElement} ways
 * @param {object} job
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
      fault.textContent = sentence(error.message);
    }
  };
  ways.replaceChildren(h(how.heading, {}, "What would help?"), h("p", {}, "The smallest changes that make it feasible can be searched; that takes some seconds to minutes."),
    maySubmit() ? h("p", {}, h("button", { type: "button", class: "primary", onclick: begin }, "Find ways out")) : null, fault);
  if (how.begin && maySubmit()) await begin();
}

function follow(ways, job, explaining, how) {
  const stage = h("p", { role: "status" }, stageText(explaining.progress));
  const show = async (found) => {
    how.told?.();
    if (found.state === "done") tell(ways, job, await get(`/jobs/${found.id}/result`), how);
    else ways.replaceChildren(h(how.heading, {}, "Ways out"), h("p", {}, outcomeText(found)), h("p", {}, h("a", { href: `/jobs/${found.id}` }, "Look at it")));
  };
  if (!LIVE.includes(explaining.state)) return show(explaining);
  ways.replaceChildren(h(how.heading, {}, "Looking for ways out"), h("progress", { "aria-label": "Ways out are searched" }), stage);
  return listen([explaining.id], async (kind, told) => {
    if (kind === "progress") stage.textContent = stageText(told);
    if (kind === "end") show(await get(`/jobs/${explaining.id}`));
  });
}

function tell(ways, job, found, how) {
  const proven = (way) => h("span", { class: `badge ${way.proven ? "good" : ""}` }, way.proven ? "proven" : "not proven to be the least");
  const excluded = found.conflict.join(", ").replaceAll("_", " ");
  const several = `Together these cannot hold: ${excluded}${found.minimal ? "; without any one of them the others could" : ""}.`;
  const conflict = h("p", {}, found.conflict.length > 1 ? several : found.conflict.length ? `This cannot hold, whatever is done about other limits: ${excluded}.` : sentence(found.message));
  const apply = (way) => {
    if (!maySubmit() || !Object.keys(way.patch ?? {}).length) return null;
    const own = how.apply?.(way.patch);
    if (own) return h("button", { type: "button", onclick: own }, "Apply");
    return h("a", { class: how.apply ? "button" : "button primary", href: `/new?from=${job.id}#patch=${encodeURIComponent(JSON.stringify(way.patch))}` }, "Apply");
  };
  ways.replaceChildren(h(how.heading, {}, "Ways out"), conflict,
    found.ways.length ? h("ul", { class: "ways" }, found.ways.map((way) => h("li", {}, h("div", {}, h("p", {}, asWords(way.sentence)), proven(way)), apply(way))))
      : h("p", {}, found.feasible ? "All limits can hold together." : "No single change was found that helps."),
    found.interrupted ? h("p", { class: "note" }, `Interrupted: ${found.interrupted}`) : "");
}
