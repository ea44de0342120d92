// A batch: how its rows stand, and what each has found.

import { faultCard, get } from "./api.js";
import { duration, h, words } from "./dom.js";
import { LIVE, ROWS, count } from "./words.js";

const PERIOD = 3000; // ms between two looks at the rows while they are answered
const SHOWN_CELLS = 4;

/** Show a batch, while it is worked at and after. */
export function batchView(element, job) {
  let shown = job, status = "", cursors = [null], looked = 0;
  const bar = h("div", { class: "shares", role: "img" });
  const legend = h("ul", { class: "row legend" });
  const facts = h("p", { class: "note number", role: "status" });
  const table = h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Rows" });
  const pager = h("p", { class: "row" });

  async function rows() {
    const asked = new URLSearchParams({ limit: "50" });
    if (status) asked.set("status", status);
    if (cursors.at(-1)) asked.set("cursor", cursors.at(-1));
    looked = Date.now();
    try {
      draw(await get(`/jobs/${job.id}/rows?${asked}`));
    } catch (error) {
      table.replaceChildren(faultCard(error, rows));
    }
  }

  function draw(page) {
    const heads = page.header.slice(0, SHOWN_CELLS);
    const more = page.header.length - heads.length;
    table.replaceChildren(h("table", {}, h("caption", {}, more > 0 ? `The first ${heads.length} of ${page.header.length} columns; all are in rows.csv.` : ""),
      h("thead", {}, h("tr", {}, ["Line", ...heads, "Stands", "Best design, or why there is none"].map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, page.rows.map((row) => h("tr", {}, h("td", { class: "number" }, row.line), heads.map((_, k) => h("td", {}, row.cells[k] ?? "")),
        h("td", {}, mark(row.status)), h("td", { class: "best" }, row.best_design ? words(row.best_design) : row.explanation || "–", row.remarks ? h("p", { class: "note" }, row.remarks) : null))))));
    if (!page.rows.length) table.replaceChildren(h("p", { class: "note" }, LIVE.includes(shown.state) ? "No row is answered yet." : "No rows."));
    pager.replaceChildren(
      cursors.length > 1 ? h("button", { type: "button", class: "small", onclick: () => { cursors.pop(); rows(); } }, "Earlier rows") : "",
      page.next ? h("button", { type: "button", class: "small", onclick: () => { cursors.push(page.next); rows(); } }, "Later rows") : "");
  }

  const mark = (name) => {
    const [text, kind] = ROWS[name] ?? [words(name || "open"), ""];
    return h("span", { class: `badge ${kind}` }, text);
  };

  const view = {
    show(job) {
      shown = job;
      const told = job.progress ?? {};
      const facted = job.summary?.status ?? { ...(told.bad ? { bad_input: told.bad } : {}), ...told.status };
      const total = job.summary?.rows ?? told.rows ?? job.rows;
      const done = Object.values(facted).reduce((sum, number) => sum + number, 0);
      const parts = Object.entries(facted).filter(([, number]) => number);
      if (total > done) parts.push(["waiting", total - done]);
      bar.replaceChildren(...parts.map(([name, number]) => share(name, number)));
      bar.setAttribute("aria-label", parts.map(([name, number]) => `${number} ${label(name)}`).join(", ") || "nothing yet");
      legend.replaceChildren(...parts.map(([name, number]) => h("li", {}, name === "waiting" ? h("span", { class: "badge" }, `${number} waiting`)
        : h("button", { type: "button", class: "small", "aria-pressed": String(status === name), onclick: () => { status = status === name ? "" : name; cursors = [null]; view.show(shown); rows(); } }, h("span", { class: `dot ${ROWS[name]?.[1] ?? ""}`, "aria-hidden": "true" }), `${number} ${label(name)}`))));
      const seconds = job.started ? (job.ended ?? Date.now() / 1000) - job.started : 0;
      const rate = seconds > 1 && done ? done / seconds : 0;
      facts.textContent = [total ? `${done} of ${count(total, "row")}` : "The table is read", rate ? `${rate >= 1 ? `${rate.toFixed(1)} rows a second` : `${(60 * rate).toFixed(1)} rows a minute`}` : "",
        rate && total > done && LIVE.includes(job.state) ? `about ${duration((total - done) / rate)} left` : ""].filter(Boolean).join(" · ");
      if (LIVE.includes(job.state) && total && Date.now() - looked > PERIOD) rows();
    },
  };
  element.replaceChildren(h("section", { class: "card stack" }, h("h2", {}, "Rows"), bar, legend, facts), h("section", { class: "card" }, table, pager));
  view.show(job);
  if (!looked) rows();
  return view;
}

const label = (name) => (name === "waiting" ? "waiting" : (ROWS[name]?.[0] ?? words(name)).toLowerCase());

function share(name, number) {
  const part = h("span", { class: `share ${name === "waiting" ? "waiting" : ROWS[name]?.[1] ?? ""}`, title: `${number} ${label(name)}` });
  part.style.flexGrow = String(number);
  return part;
}
