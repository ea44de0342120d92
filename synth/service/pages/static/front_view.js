// A front: drawn by the explorer where the server has it, else as certificate, points and table.

import { API, get, maySubmit } from "./api.js";
import { figure, h, unitText, words } from "./dom.js";
import { percent } from "./numbers.js";
import { asTyped } from "./as_typed.js";
import { nothingView, seek } from "./nothing_view.js";
import { plotOf } from "./plot.js";
import { whatIf } from "./what_if.js";
import { count } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./answers.js").DesignPage} DesignPage
 * @typedef {import("./answers.js").ColumnAnswer} Column
 * @typedef {import("../../../../reports/explorer/record.js").Design} Design
 * @typedef {import("../../../../reports/explorer/record.js").FrontRecord} FrontRecord
 * @typedef {import("./records.js").Front} Front
 * @typedef {(job: Job, rank: number | null, moved?: string) => void} Heard
 */

const RECORD = "explorer.json"; // what the explorer draws, as the server renders it
const DRAWING = "_drawing.svg";
const BESIDE = ["score", "status", "gap", "alternatives"];
const MOST = 200, SHOWN = 14;

/**
 * Show a front.
 * @param {HTMLElement} element
 * @param {Job} job
 * @param {string} explorer address of the module that draws fronts, empty where there is none
 * @param {Heard} heard is told whose front is shown, which design of it is chosen, and with which
 *   values it was asked where they are others than those of the page
 */
export async function frontView(element, job, explorer, heard) {
  element.replaceChildren(h("p", { class: "note" }, "Loading the front …"));
  if (explorer && (await explored(element, job, explorer, heard))) return;
  if (["infeasible", "not_found"].includes(job.summary?.outcome ?? "")) return nothingView(element, job, null);
  const [record, page] = await Promise.all([/** @type {Promise<Front>} */ (get(`/jobs/${job.id}/result`)), get(`/jobs/${job.id}/designs?limit=${MOST}`)]);
  const objectives = Object.keys(record.objectives).flatMap((name) => page.columns.find((column) => column.name === name) ?? []);
  const table = tableCard(job, page, objectives);
  const points = page.designs.map((design) => ({ rank: design.rank, note: design.note, values: objectives.map(({ name }) => Number(design[name])) }));
  element.replaceChildren(certificate(job, record),
    ...(points.length > 1 ? [plotOf(objectives, points, { label: "The front", choose: (design) => table.choose(design.rank) })] : []), table.element);
}

/**
 * Let the explorer draw; tell whether it could: else the page draws the front itself.
 * @param {HTMLElement} element
 * @param {Job} job
 * @param {string} explorer
 * @param {Heard} heard
 */
async function explored(element, job, explorer, heard) {
  const { files } = await get(`/jobs/${job.id}/files`);
  if (!files.some((file) => file.name === RECORD)) return false;
  /** @type {[typeof import("../../../../reports/explorer/explorer.js"), FrontRecord, import("./records.js").Spec, unknown]} */
  let drawn;
  try {
    drawn = await Promise.all([import(explorer), /** @type {Promise<FrontRecord>} */ (get(`/jobs/${job.id}/files/${RECORD}`)), get(`/jobs/${job.id}/request`), styled(explorer.replace(/\.js$/, ".css"))]);
  } catch {
    return false;
  }
  const [{ mount }, found, request] = drawn;
  const record = asTyped(found, request.requirements);
  const slot = h("div", { class: "explored" });
  element.replaceChildren(slot);
  const told = { explorer: "", moved: movedOf(location.hash.slice(1)) };
  const tell = () => {
    const text = [told.explorer, told.moved].filter(Boolean).join("&");
    history.replaceState(null, "", text ? `#${text}` : location.pathname);
  };
  /** @type {import("./what_if.js").Page} */
  const page = { job, record, request, state: location.hash.slice(1), onState: (text) => { told.moved = text; tell(); }, onJob: (other, what) => { shown = other; heard(shown, null, what); } };
  const endings = [...new Set(files.map((file) => /^design_\d+(.+)$/.exec(file.name)?.[1]).filter((ending) => ending !== undefined))];
  const digits = files.map((file) => /^design_(\d+)/.exec(file.name)?.[1].length).find(Boolean) ?? 2;
  const nameOf = (/** @type {Design} */ design, /** @type {string} */ ending) => `design_${String(design.rank).padStart(digits, "0")}${ending}`;
  const once = keeping();
  let shown = job;
  /** @type {import("./what_if.js").Strip | undefined} */
  let strip;
  /** @type {Promise<unknown> | undefined} */
  let ready;
  mount(slot, record, {
    heading: false,
    state: page.state,
    onState: (text) => { told.explorer = text; tell(); },
    onSelect: (design) => heard(shown, design?.rank ?? null),
    downloads: (design) => endings.map((ending) => {
      const name = nameOf(design, ending);
      return { label: name, href: `${API}/jobs/${shown.id}/files/${name}`, download: name };
    }),
    // A record with all drawings would be ten times as large, and a slider would wait for it.
    ...(endings.includes(DRAWING) ? { picture: (design) => once(`/jobs/${shown.id}/files/${nameOf(design, DRAWING)}`) } : {}),
    ...(maySubmit() && job.kind === "synthesis" && record.designs.length ? {
      whatIf: (place, handle) => { ready = whatIf(place, handle, page).then((made) => { strip = made ?? undefined; }, () => place.setAttribute("hidden", "")); },
    } : {}),
    ways: (place) => {
      if (record.designs.length) strip?.ways(place);
      else if (job.kind === "synthesis") ready = seek(place, job, { heading: "h3" });
    },
  });
  await ready;
  return true;
}

/** Return a way to get each file once, however often it is shown; what failed is asked for again. */
function keeping() {
  /** @type {Map<string, Promise<string>>} */
  const kept = new Map();
  return (/** @type {string} */ path) => {
    const found = kept.get(path) ?? /** @type {Promise<string>} */ (get(path)).catch((fault) => { kept.delete(path); throw fault; });
    kept.set(path, found);
    return found;
  };
}

/**
 * Load a style sheet; what is drawn before it is there has the wrong size.
 * @param {string} href
 */
const styled = (href) => new Promise((done) => {
  document.head.append(h("link", { rel: "stylesheet", href, onload: done, onerror: done }));
});

/**
 * Return what the text of an address says of values that were moved.
 * @param {string} text
 */
const movedOf = (text) => new URLSearchParams(text).getAll("if").map((entry) => `if=${encodeURIComponent(entry)}`).join("&");

/**
 * @param {Job} job
 * @param {Front} record
 */
function certificate(job, record) {
  const told = record.certificate ?? { kind: "", gap: null };
  const designs = count(job.summary?.designs ?? 0, "design");
  const proven = told.kind === "global" && !record.interrupted;
  const gap = typeof told.gap === "number" ? `, to within ${percent(told.gap)}` : "";
  return h("section", { class: `card certificate ${proven ? "proven" : ""}` },
    h("h2", {}, proven ? `${designs}, proven` : `${designs}, not proven to be the best`),
    h("p", {}, proven ? `No combination of the parts that were searched is better in all objectives${gap}.` : "They hold all limits. Better ones may exist: the search ended before it had excluded them.",
      told.combinations ? ` ${figure(told.combinations)} combinations: ${figure(told.excluded_by_bound ?? 0)} excluded by bounds, ${figure(told.solved ?? 0)} solved.` : ""),
    record.interrupted ? h("p", { class: "note" }, `Interrupted: ${record.interrupted}`) : null,
    h("p", { class: "note" }, "The proof covers the formulas, limits and catalogue rows of this study, not the world outside them."));
}

/**
 * @param {Job} job
 * @param {DesignPage} page
 * @param {Column[]} objectives
 */
function tableCard(job, page, objectives) {
  const shown = page.columns.filter(({ name }) => !BESIDE.includes(name)).slice(0, SHOWN);
  const numeric = new Set(shown.filter(({ name }) => page.designs.some((design) => typeof design[name] === "number")).map(({ name }) => name));
  /** @type {Map<number, HTMLElement>} */
  const lines = new Map();
  let order = { name: "rank", down: false };
  const body = h("tbody");
  const heads = shown.map((column) => h("th", { scope: "col", class: numeric.has(column.name) ? "right" : "" },
    h("button", { type: "button", class: "sort", onclick: () => sort(column.name) }, words(column.name), unitText(column.unit) ? h("span", { class: "unit" }, ` ${unitText(column.unit)}`) : null)));

  /** @param {string} name */
  function sort(name) {
    order = { name, down: order.name === name && !order.down };
    const rest = [...page.designs].sort((a, b) => (a[name] === b[name] ? a.rank - b.rank : (a[name] ?? "") < (b[name] ?? "") ? -1 : 1));
    if (order.down) rest.reverse();
    body.replaceChildren(...rest.flatMap((design) => lines.get(design.rank) ?? []));
    shown.forEach((column, k) => heads[k].setAttribute("aria-sort", column.name === name ? (order.down ? "descending" : "ascending") : "none"));
  }

  for (const design of page.designs) {
    const sheet = `${API}/jobs/${job.id}/files/design_${String(design.rank).padStart(2, "0")}.yaml`;
    lines.set(design.rank, h("tr", { tabindex: "-1" }, shown.map(({ name }) => h("td", { class: [numeric.has(name) ? "right" : "", objectives.some((own) => own.name === name) ? "main" : ""].join(" ") }, figure(design[name]))),
      h("td", {}, h("a", { href: sheet, download: true, "aria-label": `Design ${design.rank} as YAML` }, "YAML"))));
  }
  sort("rank");
  if (order.down) sort("rank");
  const hidden = page.columns.length - shown.length - BESIDE.length;
  return {
    element: h("section", { class: "card" }, h("h2", {}, count(page.total, "design")), h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Designs" },
      h("table", {}, h("thead", {}, h("tr", {}, heads, h("th", { scope: "col" }, "File"))), body)),
      hidden > 0 ? h("p", { class: "note" }, `${hidden} more quantities of each design are in designs.csv and the report.`) : null),
    /** @param {number} rank */
    choose(rank) {
      for (const [own, line] of lines) line.classList.toggle("chosen", own === rank);
      lines.get(rank)?.focus();
    },
  };
}
