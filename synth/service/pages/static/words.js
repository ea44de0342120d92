// How jobs stand, in words.

import { asWords, h, words } from "./dom.js";
import { number } from "./numbers.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./records.js").Progress} Progress
 */

export const LIVE = ["open", "running"];
/** @type {Record<string, string>} */
export const KINDS = {
  synthesis: "Study", compare: "Comparison", whatif: "What if", explain: "Ways out", prices: "Prices", near_equals: "Near equals", rate: "Rating",
  verify: "Verification", report: "Report", batch: "Batch", size_range: "Size range",
};
/** @type {Record<string, string>} */
const STAGES = {
  bounds: "Bounding what is possible", coarse: "Looking for first designs", extremes: "Finding the ends of the front", front: "Filling the front", first: "Looking for the design that comes nearest to the best",
  report: "Working out the designs", explanation: "Looking for what stands in the way", "ways out": "Looking for ways out",
};
export const STAGE_ORDER = ["bounds", "coarse", "extremes", "front", "first", "report"];
/** @type {Record<string, string>} */
export const STEPS = { bounds: "bounds", coarse: "first designs", extremes: "ends of the front", front: "between them", first: "the best compromise", report: "results" };

/**
 * @param {number} some
 * @param {string} one
 */
const count = (some, one, many = `${one}s`) => `${number(some)} ${some === 1 ? one : many}`;
export { count };

/**
 * Return what a job is doing.
 * @param {Progress | null | undefined} progress
 */
export const stageText = (progress) => (progress?.stage ? STAGES[progress.stage] ?? asWords(progress.stage) : "Starting");

/**
 * Return how much of a job is done, from 0 to 1; null where nobody knows.
 * @param {Job} job
 */
export function share(job) {
  const told = job.progress;
  if (!told) return null;
  const done = told.done ?? 0;
  if (told.rows) return done / told.rows;
  return done > 0 && done <= 1 ? done : null;
}

/**
 * Return how a job stands, in a few words.
 * @param {Job} job
 */
export function outcomeText(job) {
  const facts = job.summary ?? {}, asked = facts.asked ?? facts.designs ?? 0;
  if (job.state === "open") return "Waits for a worker";
  if (job.state === "running") return job.kind === "batch" && job.progress?.rows ? `${number(job.progress.done)} of ${count(job.progress.rows, "row")}` : stageText(job.progress);
  if (job.state === "failed") return job.error?.message ?? "Failed";
  if (job.kind === "batch" && facts.rows) {
    const status = facts.status ?? {};
    const names = [...Object.keys(ROWS).filter((name) => status[name]), ...Object.keys(status).filter((name) => !ROWS[name])];
    const parts = names.map((name) => `${number(status[name])} ${ROWS[name]?.[0].toLowerCase() ?? words(name)}`);
    return `${count(facts.rows, "row")}: ${parts.join(", ")}`;
  }
  if (job.state === "cancelled") return "Cancelled";
  const found = facts.designs ? count(facts.designs, "design") : "";
  if (job.state === "stopped") return found ? `Stopped at a limit, ${found} kept` : "Stopped at a limit of time or memory";
  if (["rate", "near_equals"].includes(job.kind) && facts.sentence) return facts.sentence[0].toUpperCase() + facts.sentence.slice(1);
  if (job.kind === "prices" && facts.designs) return `Prices of ${asked > facts.designs ? `${facts.designs} of ` : ""}${count(asked, "design")}`;
  if (job.kind === "report" && facts.files) return count(facts.files.length, "file");
  if (job.kind === "verify" && job.outcome) return job.outcome === "holds" ? "Holds when it is checked again" : words(job.outcome[0].toUpperCase() + job.outcome.slice(1));
  if (job.kind === "whatif" && facts.steps) return `Designs at ${facts.feasible_steps} of ${count(facts.steps, "value")}`;
  if (job.outcome === "infeasible") return job.kind === "explain" ? count(facts.ways ?? 0, "way out", "ways out") : "Nothing is feasible";
  if (job.outcome === "not_found") return "No design was found";
  if (job.outcome === "not_solved") return "No answer within the time";
  if (job.kind === "size_range" && facts.variants) return `${count(facts.variants, "size")} for all rows that can be served`;
  if (found) return `${found}, ${facts.certificate === "global" && !facts.interrupted ? "proven" : "not proven to be the best"}`;
  return "Done";
}

/** @type {Record<string, [text: string, kind: string, mark: string]>} */
const BADGES = {
  open: ["Waiting", "", "○"], running: ["Running", "live", "●"], done: ["Done", "good", "✓"], failed: ["Failed", "bad", "✗"],
  cancelled: ["Cancelled", "", "–"], stopped: ["Stopped", "warn", "■"],
};

/**
 * Return the state of a job as a badge: a word and a mark, not a colour alone.
 * @param {Job} job
 */
export function badge(job) {
  const outcome = job.outcome ?? "";
  const [text, kind, mark] = job.state === "done" && ["infeasible", "not_found"].includes(outcome) && ["synthesis", "compare", "whatif"].includes(job.kind) ? [ROWS[outcome][0], "warn", "!"]
    : BADGES[job.state] ?? [words(job.state), "", "○"];
  return h("span", { class: `badge ${kind}` }, h("span", { "aria-hidden": "true" }, mark), text);
}

// Of rows of a batch: words, the class of their share in the bar and of their badge, and a mark.
/** @type {Record<string, [text: string, kind: string, mark: string]>} */
export const ROWS = {
  optimal: ["Optimal", "good", "✓"], feasible: ["Feasible", "fair", "✓"], infeasible: ["Not feasible", "warn", "!"], not_found: ["None found", "warn", "?"], not_solved: ["Not solved", "soft", "○"],
  refused: ["Refused", "warn", "–"], bad_input: ["Faulty", "bad", "✗"], failed: ["Failed", "bad", "✗"],
};

/**
 * Return how a row stands, as a badge.
 * @param {string} status
 */
export function rowBadge(status) {
  const known = words(status || "waiting");
  const [text, kind, mark] = ROWS[status] ?? [known[0].toUpperCase() + known.slice(1), "", "○"];
  return h("span", { class: `badge ${kind}` }, h("span", { "aria-hidden": "true" }, mark), text);
}
