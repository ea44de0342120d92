// What can be asked of a front beyond it, and what was asked of a job already.

import { get, listen, maySubmit, messageOf, post } from "./api.js";
import { firstOf, h } from "./dom.js";
import { KINDS, LIVE, badge, outcomeText } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./records.js").Spec} Spec
 * @typedef {import("./answers.js").Requests & {rate: {of: string}}} Requests
 * @typedef {{text: (rank: number, single: boolean) => string, note: string, of: (job: Job, request: Spec) => boolean}} Offer
 * @typedef {{[K in keyof Requests]: Offer & {kind: K, request: (job: Job, rank: number) => Omit<Requests[K], "of">}}[keyof Requests]} Ask
 */

const SHOWN = 5; // jobs before the rest is unfolded
const MOST = 50; // jobs that are told
const ALL = 20; // designs whose prices are asked together; of more only the chosen one
const AGAIN = ["cancelled", "failed", "stopped"];

/**
 * What can be asked: the kind, what its button says, what comes of it, and its request.
 * @type {Ask[]}
 */
const ASKS = [
  { kind: "prices", text: (rank, single) => (single ? `Prices of design ${rank}` : "Prices"), note: "What one per cent more or less of each requirement and limit would change.",
    request: (job, rank) => (many(job) ? { design: [rank] } : {}), of: (job) => job.kind === "synthesis" },
  { kind: "near_equals", text: (rank) => `Near equals of design ${rank}`, note: "Other parts, counts or choices that are nearly as good.",
    request: (_, rank) => ({ design: rank }), of: (job) => job.kind === "synthesis" },
  { kind: "rate", text: () => "Rating", note: "How the designs stand what scatters, over the whole range that was declared.",
    request: () => ({}), of: (job, request) => job.kind === "synthesis" && Boolean(request.robust) },
  { kind: "verify", text: () => "Check again independently", note: "By code that shares nothing with the search.", request: () => ({}), of: () => true },
  { kind: "report", text: (rank) => `Full report, sheet of design ${rank}`, note: "Every number with formula, inserted values and source.",
    request: (_, rank) => ({ design: [rank], length: "full" }), of: (job) => job.kind === "synthesis" },
];

/** @param {Job} job */
const many = (job) => (job.summary?.designs ?? 0) > ALL;

/**
 * Make the card.
 * @param {Job} job one that has ended
 * @returns {Promise<{element: HTMLElement, shown: (job: Job, rank: number | null) => void}>}
 */
export async function furtherCard(job) {
  const element = h("section", { class: "card stack further", hidden: true });
  const front = ["synthesis", "compare"].includes(job.kind) && Boolean(job.summary?.designs);
  const request = front && maySubmit() ? await get(`/jobs/${job.id}/request`) : null;
  const beside = job.kind === "batch" ? ["size_range"] : front ? [] : ["explain"]; // what the page shows itself
  const offered = request ? ASKS.filter((ask) => ask.of(job, request)) : [];
  const fault = h("p", { class: "fault", role: "alert" });
  const list = h("div", { class: "followed" });
  const buttons = offered.map((ask) => h("button", { type: "button", onclick: () => asked(ask) }));
  const asks = h("ul", { class: "ask-list" }, offered.map((ask, k) => h("li", {}, buttons[k], h("span", { class: "note" }, ask.note))));
  const lacking = h("p", { class: "note", hidden: true }, "There is no design with these values that could be asked about.");
  let of = job, rank = 1, stop = () => {};
  /** @type {Job[]} */
  let known = [];

  /**
   * Take note of what is shown: what is asked is asked of that.
   * @param {Job} other
   * @param {number | null} chosen
   */
  function shown(other, chosen) {
    if (other.id !== of.id) load();
    of = other;
    rank = chosen ?? rank;
    lacking.hidden = Boolean(of.summary?.designs);
    asks.hidden = !lacking.hidden;
    offered.forEach((ask, k) => {
      buttons[k].textContent = ask.text(rank, many(of));
    });
  }

  /** @param {Ask} ask */
  async function asked(ask) {
    fault.textContent = "";
    const body = { kind: ask.kind, request: { of: of.id, ...ask.request(of, rank) }, title: `${ask.text(rank, many(of))}: ${of.title}`.slice(0, 200), parent: job.id };
    try {
      const made = await post("/jobs", body, { "Idempotency-Key": `further-${ask.kind}-${of.id}-${rank}` });
      if (AGAIN.includes(made.state)) await post(`/jobs/${made.id}/resume`);
      await load();
      firstOf(list, `a[href="/jobs/${made.id}"]`)?.focus();
    } catch (error) {
      fault.textContent = messageOf(error);
    }
  }

  async function load() {
    known = (await get(`/jobs?parent=${job.id}&limit=${MOST}`)).jobs.filter((one) => !beside.includes(one.kind));
    draw();
    stop();
    const live = known.filter((one) => LIVE.includes(one.state)).map((one) => one.id);
    stop = live.length ? listen(live, heard, (job) => exchanged(job)) : () => {};
  }

  /**
   * @param {string} kind
   * @param {import("./records.js").Happening} told
   */
  async function heard(kind, told) {
    const one = known.find((one) => one.id === told.job);
    if (!one || told.state === "deleted" || !["progress", "started", "end"].includes(kind)) return;
    exchanged(kind === "progress" ? { ...one, state: told.state, progress: told } : await get(`/jobs/${told.job}`).catch(() => one));
  }

  /** @param {Job} job */
  function exchanged(job) {
    known = known.map((one) => (one.id === job.id ? job : one));
    draw();
  }

  /**
   * Return a job as one line; what it shares with the title of the page is left out.
   * @param {Job} one
   */
  function line(one) {
    const title = one.title.replace(`: ${job.title}`, "").replace(`, ${job.title}`, "");
    const kind = KINDS[one.kind] ?? one.kind;
    return h("li", {}, h("span", { class: "state" }, badge(one)), h("a", { href: `/jobs/${one.id}` }, title || kind), h("span", { class: "note" }, title.toLowerCase().startsWith(kind.toLowerCase()) ? "" : `${kind} · `, outcomeText(one)));
  }

  function draw() {
    const focused = list.contains(document.activeElement) ? document.activeElement?.getAttribute("href") : null, open = list.querySelector("details")?.open ?? false;
    const rest = known.slice(SHOWN);
    element.hidden = !offered.length && !known.length;
    list.replaceChildren(...(known.length ? [offered.length ? h("h3", {}, "What followed") : h("h2", {}, "What followed"), h("ul", {}, known.slice(0, SHOWN).map(line)),
      rest.length ? h("details", { class: "more", open }, h("summary", {}, `${rest.length} more`), h("ul", {}, rest.map(line))) : ""] : []));
    if (focused) firstOf(list, `a[href="${focused}"]`)?.focus();
  }

  element.replaceChildren(...(offered.length ? [h("h2", {}, "Ask further"), asks, lacking, fault] : []), list);
  shown(job, null);
  await load();
  return { element, shown };
}
