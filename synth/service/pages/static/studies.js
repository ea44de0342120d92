// The list of studies: found by words and states, watched by one stream.

import { faultCard, get, listen, maySubmit, messageOf, post } from "./api.js";
import { asWords, byId, h, when, words } from "./dom.js";
import { KINDS, LIVE, badge, outcomeText, share } from "./words.js";

/** @typedef {import("./answers.js").JobAnswer} Job */

/** @type {[name: string, states: string[]][]} */
const FILTERS = [["All", []], ["Running", LIVE], ["Done", ["done"]], ["Ended early", ["failed", "cancelled", "stopped"]]];
const PATIENCE = 250, MOST_WATCHED = 50;
const place = byId("studies");
const address = new URLSearchParams(location.search);
/** @type {{text: string, filter: number, followed: boolean, next: string | null, titles: Record<string, string>, stop: (() => void) | null, asked: number}} */
const state = { text: address.get("q") ?? "", filter: Math.max(0, FILTERS.findIndex(([name]) => name === address.get("state"))), followed: address.get("followed") === "yes", next: null, titles: {}, stop: null, asked: 0 };

/** @type {Map<string, Row>} */
const rows = new Map(); // of the list, by job
const list = h("ul", { class: "studies card" });
const nothing = h("p", { class: "card note", hidden: true }, "No study fits. Another word, or another state?");
const more = h("button", { type: "button", hidden: true, onclick: () => load(true) }, "Show more");
const search = h("input", { type: "search", id: "search", placeholder: "Search a title", "aria-label": "Search a title", value: state.text, oninput: later });
const filters = h("div", { class: "row", role: "group", "aria-label": "State" }, FILTERS.map(([name], index) =>
  h("button", { type: "button", class: "small", "aria-pressed": String(index === state.filter), onclick: () => choose(index) }, name)));
const followed = h("button", { type: "button", class: "small", title: "Values of sliders, prices, ways out: what was asked of another study", "aria-pressed": String(state.followed), onclick: () => {
  state.followed = !state.followed;
  followed.setAttribute("aria-pressed", String(state.followed));
  load();
} }, "Also what followed");
const tools = h("div", { class: "tools row", hidden: true }, search, filters, followed);

let waiting = 0;
function later() {
  clearTimeout(waiting);
  waiting = window.setTimeout(() => { state.text = search.value.trim(); load(); }, PATIENCE);
}

/** @param {number} index */
function choose(index) {
  state.filter = index;
  [...filters.children].forEach((button, own) => button.setAttribute("aria-pressed", String(own === index)));
  load();
}

/** @param {boolean} more */
function query(more) {
  const asked = new URLSearchParams();
  for (const name of FILTERS[state.filter][1]) asked.append("state", name);
  if (state.text) asked.set("q", state.text);
  if (!state.followed) asked.set("follows", "false");
  const kept = new URLSearchParams();
  if (state.text) kept.set("q", state.text);
  if (state.filter) kept.set("state", FILTERS[state.filter][0]);
  if (state.followed) kept.set("followed", "yes");
  history.replaceState(null, "", kept.size ? `?${kept}` : location.pathname);
  if (more && state.next) asked.set("cursor", state.next);
  return asked;
}

async function load(further = false) {
  const number = (state.asked += 1);
  const asked = query(further);
  try {
    const pages = [await get(`/jobs?${asked}`)];
    if (!further) {
      asked.set("pinned", "true");
      pages.unshift(await get(`/jobs?${asked}`));
    }
    if (number !== state.asked) return;
    show(pages, further);
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
}

/**
 * @param {import("./answers.js").JobList[]} pages
 * @param {boolean} further
 */
function show(pages, further) {
  if (!further) {
    rows.clear();
    list.replaceChildren();
  }
  for (const job of pages.flatMap((page) => page.jobs)) {
    if (rows.has(job.id)) continue;
    const row = new Row(job);
    rows.set(job.id, row);
    list.append(row.element);
  }
  state.next = pages.at(-1)?.next ?? null;
  more.hidden = !state.next;
  const empty = !rows.size;
  const unasked = !state.text && !state.filter;
  list.hidden = empty;
  nothing.hidden = !empty || unasked;
  tools.hidden = empty && unasked;
  place.setAttribute("aria-busy", "false");
  if (!place.contains(list)) place.replaceChildren(tools, list, nothing, h("p", { class: "row more" }, more));
  welcome.hidden = !(empty && unasked);
  if (empty && unasked) greet();
  watch();
}

class Row {
  /** @param {Job} job */
  constructor(job) {
    this.job = job;
    this.state = h("span", { class: "state" });
    this.words = h("span", { class: "outcome" });
    this.bar = h("progress", { hidden: true, "aria-label": "Share that is done" });
    this.about = h("span", { class: "about note" });
    this.element = h("li", {},
      h("a", { class: "title", href: `/jobs/${job.id}` }, job.title),
      this.state,
      this.about,
      h("span", { class: "stands" }, this.words, this.bar));
    this.show(job);
    this.tell();
  }

  tell() {
    this.about.replaceChildren(...aboutOf(this.job));
  }

  /** @param {Job} job */
  show(job) {
    this.job = job;
    this.state.replaceChildren(badge(job));
    this.words.textContent = outcomeText(job);
    const done = share(job);
    this.bar.hidden = job.state !== "running";
    if (done === null) this.bar.removeAttribute("value");
    else this.bar.value = done;
  }
}

/** @param {Job} job */
const aboutOf = (job) => [`${job.pinned ? "Kept for good · " : ""}${KINDS[job.kind] ?? words(job.kind)}${familyText(job)} · `, when(job.created)];
/** @param {Job} job */
const familyText = (job) => (job.families.length === 1 ? ` · ${state.titles[job.families[0]] ?? words(job.families[0])}` : job.families.length ? ` · ${job.families.length} families` : "");

function watch() {
  state.stop?.();
  const live = [...rows.values()].filter((row) => LIVE.includes(row.job.state)).map((row) => row.job.id);
  if (!live.length) return;
  state.stop = listen(live.slice(0, MOST_WATCHED), async (kind, told) => {
    const row = rows.get(told.job);
    if (!row) return;
    if (told.state === "deleted") row.element.remove();
    else if (kind === "progress") row.show({ ...row.job, state: told.state, progress: told });
    else if (kind === "end" || kind === "started") row.show(await get(`/jobs/${told.job}`).catch(() => row.job));
  }, (job) => rows.get(job.id)?.show(job));
}

// ---- nobody has asked anything yet ----

const welcome = h("section", { class: "welcome", hidden: true });

async function greet() {
  place.append(welcome);
  if (welcome.childElementCount) return;
  const names = (place.dataset.examples ?? "").split(",");
  const [{ examples }] = await Promise.all([get("/examples"), named]);
  const offered = names.flatMap((name) => examples.find((example) => example.name === name) ?? []);
  welcome.replaceChildren(
    h("p", {}, "No studies yet. ", maySubmit() ? "State a duty, or run one of these as it stands:" : "Your token may look at studies, not ask for any."),
    maySubmit() ? h("ul", { class: "offers" }, offered.map(offer)) : h("span"));
}

/** @param {import("./answers.js").ExampleAnswer} example */
function offer(example) {
  const fault = h("p", { class: "fault", role: "alert" });
  const run = h("button", { type: "button", class: "primary", onclick: async () => {
    run.disabled = true;
    try {
      const title = words(example.name);
      const job = await post("/jobs", { kind: "synthesis", request: example.spec, title: title[0].toUpperCase() + title.slice(1) });
      location.assign(`/jobs/${job.id}`);
    } catch (error) {
      fault.textContent = messageOf(error);
      run.disabled = false;
    }
  } }, "Run it");
  const name = words(example.name);
  return h("li", { class: "card stack" }, h("h2", {}, name[0].toUpperCase() + name.slice(1)), h("p", { class: "note" }, state.titles[example.family] ?? ""),
    h("p", { class: "said" }, asWords(example.description)), h("p", { class: "row" }, run, h("a", { class: "button", href: `/new?example=${example.name}` }, "Look at it first")), fault);
}

document.addEventListener("visibilitychange", () => { if (!document.hidden) load(); });
const named = get("/families").then(({ families }) => {
  state.titles = Object.fromEntries(families.map((family) => [family.name, family.title]));
  for (const row of rows.values()) row.tell();
}, () => {});
load();
