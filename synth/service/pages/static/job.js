// A job: watched while it is worked at, and what it has found.

import { ask, faultCard, get, listen, maySubmit, messageOf, sentence } from "./api.js";
import { batchView } from "./batch_view.js";
import { byId, day, duration, h, say, when, words } from "./dom.js";
import { frontView } from "./front_view.js";
import { filesCard } from "./files_card.js";
import { furtherCard } from "./further_card.js";
import { hasView, kindView } from "./kind_views.js";
import { nothingView } from "./nothing_view.js";
import { sizesView } from "./sizes_card.js";
import { watchView } from "./watch_view.js";
import { KINDS, LIVE, badge, outcomeText } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./records.js").Progress} Progress
 */

const place = byId("job");
const { job: id = "", explorer = "" } = place.dataset;
const RESUMABLE = ["cancelled", "failed", "stopped"];
/** @type {Job} */
let job;
/** @type {Record<string, string>} */
let titles = {};
/** @type {{show: (job: Job) => void, loaded?: Promise<void>} | null} */
let content = null;
/** @type {(() => void) | null} */
let stop = null;
/** @type {Awaited<ReturnType<typeof filesCard>> | null} */
let files = null;
let shown = { id, moved: "" }; // whose front is shown, and with which values other than those of the job

const head = h("div", { class: "job-head" });
const below = h("div");
const fault = h("p", { class: "fault", role: "alert" });

async function begin() {
  try {
    job = await get(`/jobs/${id}`);
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
    return;
  }
  place.replaceChildren(head, fault, below);
  get("/families").then(({ families }) => { titles = Object.fromEntries(families.map((family) => [family.name, family.title])); heading(); }, () => {});
  show();
}

/** Show a job; who waits for the page is told when all of it is there. */
async function show() {
  heading();
  place.setAttribute("aria-busy", "true");
  if (LIVE.includes(job.state)) {
    stop ??= listen([id], heard, (seen) => {
      job = seen;
      heading();
      content?.show(job);
    });
    content = job.kind === "batch" ? batchView(below, job) : watchView(below, job);
    await content.loaded;
  } else {
    stop?.();
    stop = content = null;
    await ended();
  }
  place.setAttribute("aria-busy", "false");
}

/**
 * @param {string} kind
 * @param {import("./records.js").Happening} told
 */
async function heard(kind, told) {
  if (told.state === "deleted") gone();
  else if (kind === "progress") {
    job = { ...job, state: told.state, progress: { ...(told.columns ? {} : kept(job.progress)), ...told } };
    heading();
    content?.show(job);
  } else if (kind === "started" || kind === "end") {
    const before = job.state;
    job = await get(`/jobs/${id}`);
    if (LIVE.includes(before) && !LIVE.includes(job.state)) {
      say(outcomeText(job));
      show();
    } else heading();
  }
}

/**
 * The designs that were known last are shown until others are told.
 * @param {Progress | null} progress
 */
const kept = (progress) => (progress?.columns ? { columns: progress.columns, points: progress.points } : {});

const gone = () => place.replaceChildren(h("section", { class: "card" }, h("p", {}, "This job was removed."), h("p", {}, h("a", { href: "/" }, "To the studies"))));

/**
 * Until when a job is kept that nobody looks at any more.
 * @param {Job} told
 */
const keptUntil = (told) => (told.pinned || told.expires === null ? "" : ` · kept until ${day(told.expires)} unless it is used`);

function heading() {
  const live = LIVE.includes(job.state);
  const family = job.families.length === 1 ? titles[job.families[0]] ?? words(job.families[0]) : `${job.families.length} families`;
  const took = job.started && job.ended ? ` · took ${duration(job.ended - job.started)}` : "";
  const buttons = maySubmit() ? [
    live ? h("button", { type: "button", class: "danger", onclick: () => act("POST", "/cancel") }, "Cancel") : null,
    RESUMABLE.includes(job.state) ? h("button", { type: "button", class: "primary", onclick: () => act("POST", "/resume") }, "Resume") : null,
    ["synthesis", "explain", "compare"].includes(job.kind) && !live ? h("a", { class: "button", href: `/new?from=${shown.id}` }, "Change and ask again") : null,
    h("button", { type: "button", "aria-pressed": String(job.pinned), title: "Pinned jobs are kept for good", onclick: () => act("PATCH", "", { pinned: !job.pinned }) }, job.pinned ? "Kept for good" : "Keep for good"),
    live || job.pinned ? null : h("button", { type: "button", onclick: remove }, "Delete"),
  ] : [];
  head.replaceChildren(
    h("div", { class: "heading" }, h("h1", {}, job.title), h("div", { class: "row" }, buttons)),
    h("p", { class: "row note" }, badge(job), h("span", {}, KINDS[job.kind] ?? words(job.kind), " · ", family, " · ", when(job.created), took, keptUntil(job)),
      shown.moved ? h("b", {}, `Shown with ${shown.moved}`) : null,
      job.parent ? h("a", { href: `/jobs/${job.parent}` }, "what it follows from") : null));
  document.title = `${live ? "… " : ""}${shown.moved ? `${shown.moved}: ` : ""}${job.title} · clutchsynth`;
}

/**
 * @param {string} method
 * @param {string} path
 * @param {object} [body]
 */
async function act(method, path, body) {
  fault.textContent = "";
  try {
    if (path === "/cancel") job = await get(`/jobs/${id}`); // it may have ended just now: then there is nothing to cancel
    if (path !== "/cancel" || LIVE.includes(job.state)) job = /** @type {Job} */ (await ask(method, `/jobs/${id}${path}`, body));
    if (path === "/resume") show();
    else if (path === "/cancel" && !LIVE.includes(job.state)) show();
    else heading();
  } catch (error) {
    fault.textContent = messageOf(error);
    job = await get(`/jobs/${id}`).catch(() => job);
    heading();
  }
}

function remove() {
  const dialog = h("dialog", { class: "card stack", "aria-labelledby": "sure" },
    h("h2", { id: "sure" }, "Delete this job?"), h("p", { class: "note" }, "Its result and its files go with it."),
    h("p", { class: "row" }, h("button", { type: "button", class: "danger", onclick: async () => {
      try {
        await ask("DELETE", `/jobs/${id}`);
        location.assign("/");
      } catch (error) {
        dialog.close();
        fault.textContent = messageOf(error);
      }
    } }, "Delete"), h("button", { type: "button", autofocus: true, onclick: () => dialog.close() }, "Keep it")));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/** @type {Record<string, string>} */
const ENDS = {
  cancelled: "The job was cancelled. Resume begins it again; rows of a batch that were answered stay.",
  stopped: "The job was stopped at its limit of time or memory. What was found until then is kept.",
  failed: "The job has failed.",
};

/** Show what a job has found, or why it has found nothing. */
async function ended() {
  const parts = [];
  if (job.state !== "done") {
    parts.push(h("section", { class: "card" }, h("h2", {}, badge(job)), h("p", {}, ENDS[job.state] ?? ""),
      job.error ? h("p", { class: "fault" }, sentence(job.error.message)) : null,
      job.error && job.error.problems.length > 1 ? h("ul", { class: "fault" }, job.error.problems.map((problem) => h("li", {}, problem.message))) : null));
  }
  const slot = h("div");
  below.replaceChildren(...parts, slot);
  try {
    const further = await furtherCard(job);
    if (job.kind === "batch") await batchView(slot, job).loaded;
    else if (job.kind === "explain") await nothingView(slot, job, job);
    else if (job.kind === "compare" || (job.kind === "synthesis" && (job.summary?.designs || ["infeasible", "not_found"].includes(job.summary?.outcome ?? "")))) {
      await frontView(slot, job, explorer, (other, rank, moved) => {
        further.shown(other, rank);
        if (moved === undefined || other.id === shown.id) return;
        shown = { id: other.id, moved };
        heading();
        files?.show(shown);
      });
    }
    else if (job.kind === "size_range" && job.summary?.variants) await sizesView(slot, job);
    else if (hasView(job)) await kindView(slot, job);
    else slot.replaceChildren(...(job.summary ? [facts()] : []));
    below.append(further.element);
    files = await filesCard(below, job);
    if (shown.id !== id) files.show(shown);
  } catch (error) {
    slot.replaceChildren(faultCard(error, () => ended()));
  }
}

function facts() {
  const told = Object.entries(job.summary ?? {}).filter(([, value]) => ["string", "number", "boolean"].includes(typeof value) && value !== "");
  return h("section", { class: "card" }, h("h2", {}, outcomeText(job)), h("dl", { class: "facts" },
    told.map(([name, value]) => [h("dt", {}, words(name)), h("dd", {}, typeof value === "boolean" ? (value ? "yes" : "no") : String(value))])));
}

begin();
