// A search that is under way: its stage, and the designs it knows already.

import { duration, figure, h, withFigures } from "./dom.js";
import { plotOf } from "./plot.js";
import { STAGE_ORDER, STEPS, stageText } from "./words.js";

/** @typedef {import("./answers.js").JobAnswer} Job */

/**
 * Show a job while it waits and is worked at.
 * @param {HTMLElement} element
 * @param {Job} job
 */
export function watchView(element, job) {
  let shown = job;
  const stage = h("h2", { role: "status" });
  const bar = h("progress", { "aria-label": "Share that is done" });
  const steps = h("ol", { class: "steps", "aria-hidden": "true" });
  const facts = h("p", { class: "note number" });
  const plot = h("div");
  const tick = setInterval(() => (element.contains(stage) ? count() : clearInterval(tick)), 500);

  function count() {
    const told = shown.progress ?? {};
    const parts = [
      shown.started ? `${duration(Math.max(0, Date.now() / 1000 - shown.started))} so far` : "waits for a worker",
      told.combinations ? `${figure(told.combinations)} combinations` : "",
      told.incumbents ? `${figure(told.incumbents)} designs known` : "",
      withFigures(told.message ?? ""),
    ];
    facts.textContent = parts.filter(Boolean).join(" · ");
  }

  const view = {
    /** @param {Job} job */
    show(job) {
      shown = job;
      const told = job.progress;
      const text = job.state === "open" ? "Waits for a worker" : stageText(told);
      if (stage.textContent !== text) stage.textContent = text;
      const done = told?.done ?? 0;
      if (done > 0 && done < 1) bar.value = done;
      else bar.removeAttribute("value");
      const at = STAGE_ORDER.indexOf(told?.stage ?? "");
      steps.hidden = at < 0;
      steps.replaceChildren(...STAGE_ORDER.map((name, k) => h("li", { class: k < at ? "past" : k === at ? "now" : "" }, STEPS[name])));
      count();
      if (told?.points?.length) plot.replaceChildren(plotOf((told.columns ?? []).map(column), told.points.map((values) => ({ values })), { label: "Designs known so far" }));
    },
  };
  element.replaceChildren(h("section", { class: "card stack" }, stage, bar, steps, facts, h("p", { class: "note" }, "You can close the page; the job goes on.")), plot);
  view.show(job);
  return view;
}

/**
 * Return a heading such as `mass [kg]` as a column.
 * @param {string} heading
 */
export function column(heading) {
  const [name, unit = ""] = heading.split(" [");
  return { name, unit: unit.replace("]", "") };
}
