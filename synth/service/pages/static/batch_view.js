// A batch: how its rows stand, and what each has found.

import { faultCard, get } from "./api.js";
import { asWords, duration, figure, firstOf, h, unitText, withFigures, words } from "./dom.js";
import { sizesCard } from "./sizes_card.js";
import { LIVE, ROWS, rowBadge } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./answers.js").RowAnswer} Row
 * @typedef {import("./answers.js").RowPage} RowPage
 */

const PERIOD = 3000; // ms between two looks at the rows while they are answered
const SHOWN_CELLS = 4;
const WAITING = "waiting"; // rows that nobody has answered yet: no status of a row

/**
 * Return what a row has found as people read it: names in words, units as they are written.
 * @param {string} text
 */
export const designText = (text) => withFigures(words(text).replaceAll(/(\d) ([A-Za-z%°][A-Za-z0-9*/()%°]*)(?=,|$)/g, (_, digit, unit) => `${digit} ${unitText(unit)}`));

/**
 * Return a design in words; the first of them lead to it.
 * @param {string} href
 * @param {string} text
 */
function designLink(href, text) {
  const [first, ...rest] = text.split(", ");
  return [h("a", { href }, first), rest.length ? `, ${rest.join(", ")}` : ""];
}

/**
 * Show a batch, while it is worked at and after.
 * @param {HTMLElement} element
 * @param {Job} job
 */
export function batchView(element, job) {
  const address = new URLSearchParams(location.search);
  let shown = job, status = address.get("status") ?? "", cursors = [""], looked = 0, asked = 0;
  if (!(status in ROWS)) status = "";
  const bar = h("div", { class: "shares", role: "img" });
  const legend = h("ul", { class: "row legend" });
  const facts = h("p", { class: "note number" });
  const table = h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Rows" });
  const chosen = h("h2", { tabindex: "-1" }, "All rows");
  const later = h("button", { type: "button", class: "small", hidden: true }, "Later rows");
  const earlier = h("button", { type: "button", class: "small", hidden: true, onclick: () => { cursors.pop(); rows().then(() => chosen.focus()); } }, "Earlier rows");
  const all = h("button", { type: "button", class: "small", hidden: true, onclick: () => choose("") }, "Show all rows");
  /** @type {Map<number, {line: HTMLElement, text: string}>} */
  const lines = new Map(); // of the table, by the line of the row
  /** @type {Map<string, {part: HTMLElement, said: HTMLElement, line: HTMLElement}>} */
  const marks = new Map(); // how rows stand -> its share in the bar, and its button

  async function rows() {
    const own = (asked += 1);
    const query = new URLSearchParams({ limit: "50" });
    if (status) query.set("status", status);
    const cursor = cursors.at(-1);
    if (cursor) query.set("cursor", cursor);
    looked = Date.now();
    try {
      const page = await get(`/jobs/${job.id}/rows?${query}`);
      if (own === asked) draw(page);
    } catch (error) {
      if (own === asked) table.replaceChildren(faultCard(error, rows));
    }
  }

  /** @param {string} name */
  function choose(name) {
    status = name;
    cursors = [""];
    history.replaceState(null, "", status ? `?status=${status}` : location.pathname);
    view.show(shown);
    rows();
  }

  /** @param {RowPage} page */
  function draw(page) {
    const heads = page.header.slice(0, SHOWN_CELLS), more = page.header.length - heads.length;
    chosen.textContent = status ? `Rows: ${label(status)}` : "All rows";
    all.hidden = !status;
    const same = page.rows.length > 0 && page.rows.length === lines.size && page.rows.every((row) => lines.has(row.line));
    if (same) page.rows.forEach((row) => renew(row, heads));
    else if (page.rows.length) {
      lines.clear();
      table.replaceChildren(h("table", { class: "rows" }, more > 0 ? h("caption", {}, `The first ${heads.length} of ${page.header.length} columns; all are in rows.csv and on the page of a row.`) : null,
        h("thead", {}, h("tr", {}, ["Line", "Stands", ...heads, "Best design, or why there is none"].map((name) => h("th", { scope: "col" }, name)))),
        h("tbody", {}, page.rows.map((row) => renew(row, heads)))));
    } else {
      lines.clear();
      table.replaceChildren(h("p", { class: "note" }, LIVE.includes(shown.state) ? "No row is answered yet." : "No rows."));
    }
    later.hidden = !page.next;
    later.onclick = () => { cursors.push(page.next ?? ""); rows().then(() => chosen.focus()); };
    earlier.hidden = cursors.length < 2;
  }

  /**
   * Return the line of a row; of one that stands there and has changed, only that line is another one.
   * @param {Row} row
   * @param {string[]} heads
   */
  function renew(row, heads) {
    const known = lines.get(row.line), text = JSON.stringify([row, LIVE.includes(shown.state)]);
    if (known?.text === text) return known.line;
    const waits = row.status === "not_solved" && LIVE.includes(shown.state);
    const line = h("tr", {}, h("th", { scope: "row", class: "number" }, h("a", { href: `/jobs/${job.id}/rows/${row.line}`, "aria-label": `Line ${row.line}` }, row.line)), h("td", {}, rowBadge(waits ? WAITING : row.status)), heads.map((_, k) => h("td", { class: "cell" }, row.cells[k] ?? "")),
      h("td", { class: "best" }, h("p", { class: "told" }, row.best_design ? designLink(`/jobs/${job.id}/rows/${row.line}#design`, designText(row.best_design)) : row.status === "bad_input" ? row.explanation : asWords(row.explanation) || "–"), row.remarks ? h("p", { class: "note remark", title: row.remarks }, row.remarks) : null));
    const focused = known?.line.contains(document.activeElement);
    known?.line.replaceWith(line);
    if (focused) firstOf(line, "a")?.focus();
    lines.set(row.line, { line, text });
    return line;
  }

  /**
   * Keep what somebody may point at; only numbers change.
   * @param {string} name
   * @param {number} number
   */
  function told(name, number) {
    const { part, said, line } = marks.get(name) ?? marked(name);
    part.style.flexGrow = String(number);
    part.title = said.textContent = `${figure(number)} ${label(name)}`;
    part.hidden = line.hidden = !number;
    line.querySelector("button")?.setAttribute("aria-pressed", String(status === name));
    return { part, line };
  }

  /** @param {string} name */
  function marked(name) {
    const part = h("span", { class: `share ${name === WAITING ? WAITING : ROWS[name]?.[1] ?? ""}` }), said = h("span");
    const dot = h("span", { class: `dot ${name === WAITING ? WAITING : ROWS[name]?.[1] ?? ""}`, "aria-hidden": "true" });
    const line = h("li", {}, name === WAITING ? h("span", { class: "badge" }, dot, said) : h("button", { type: "button", class: "small", onclick: () => choose(status === name ? "" : name) }, dot, said));
    marks.set(name, { part, said, line });
    bar.append(part);
    legend.append(line);
    return { part, said, line };
  }

  const view = {
    /** @type {Promise<void> | undefined} */
    loaded: undefined,
    /** @param {Job} job */
    show(job) {
      shown = job;
      const progress = job.progress ?? {};
      /** @type {Record<string, number>} */
      const parts = { ...(job.summary?.status ?? { ...(progress.bad ? { bad_input: progress.bad } : {}), ...progress.status }) };
      const total = job.summary?.rows ?? progress.rows ?? job.rows;
      const done = Object.values(parts).reduce((sum, number) => sum + number, 0);
      parts[WAITING] = Math.max(0, total - done);
      for (const name of new Set([...Object.keys(ROWS).filter((name) => parts[name]), ...Object.keys(parts), ...marks.keys()])) told(name, parts[name] ?? 0);
      const { part, line } = told(WAITING, parts[WAITING]);
      bar.append(part);
      legend.append(line);
      bar.setAttribute("aria-label", Object.entries(parts).filter(([, number]) => number).map(([name, number]) => `${number} ${label(name)}`).join(", ") || "nothing yet");
      const seconds = job.started ? (job.ended ?? Date.now() / 1000) - job.started : 0;
      const answered = done - (parts.bad_input ?? 0); // faulty rows take no time
      const rate = seconds > 1 && answered ? answered / seconds : 0;
      facts.textContent = [total ? `${figure(done)} of ${figure(total)} ${total === 1 ? "row" : "rows"}` : "The table is read", rate ? `${rate >= 1 ? `${figure(rate, 3)} rows a second` : `${figure(60 * rate, 3)} rows a minute`}` : "",
        rate && total > done && LIVE.includes(job.state) ? `about ${duration((total - done) / rate)} left` : ""].filter(Boolean).join(" · ");
      if (LIVE.includes(job.state) && total && Date.now() - looked > PERIOD) rows();
    },
  };
  element.replaceChildren(h("section", { class: "card stack" }, h("h2", {}, "How the rows stand"), bar, legend, facts),
    h("section", { class: "card stack" }, h("div", { class: "heading" }, chosen, all), table, h("p", { class: "row" }, earlier, later)), sizesCard(job));
  view.show(job);
  if (!looked) view.loaded = rows();
  return view;
}

/** @param {string} name */
const label = (name) => (name === WAITING ? WAITING : (ROWS[name]?.[0] ?? words(name)).toLowerCase());
