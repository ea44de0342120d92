// Beside the form: what is missing, what it costs, the start, and the study as text.

import { maySubmit } from "./api.js";
import { figure, h, words } from "./dom.js";
import { curlText, pythonText, yamlText } from "./spec.js";

/**
 * @typedef {import("./fields.js").Field} Field
 * @typedef {import("./answers.js").Problem} Problem
 * @typedef {import("./spec.js").Asked} Asked
 */

/** @type {Record<string, (body: Asked) => string>} */
const TEXTS = { "spec.yaml": (body) => yamlText(body.request), HTTP: curlText, Python: pythonText };

/**
 * Make the column beside the form.
 * @param {{start: () => void, spec: () => Asked, fieldAt: (path: (string | number)[]) => Field | undefined}} page
 */
export function sideView({ start, spec, fieldAt }) {
  let shown = "spec.yaml";
  const state = h("h2", { role: "status" }, "Checking …");
  const points = h("ul", { class: "checks" });
  const go = h("button", { type: "button", class: "primary", disabled: true, onclick: start }, "Find designs");
  const cost = h("p", { class: "note" });
  const refusal = h("p", { class: "fault", role: "alert" });
  const code = h("pre", { tabindex: "0", "aria-label": "The study as text" });
  const tabs = Object.keys(TEXTS).map((name) => h("button", { type: "button", class: "small", "aria-pressed": String(name === shown), onclick: () => {
    shown = name;
    tabs.forEach((tab) => tab.setAttribute("aria-pressed", String(tab.textContent === name)));
    view.code();
  } }, name));
  const copy = h("button", { type: "button", class: "small", onclick: async () => {
    try {
      await navigator.clipboard.writeText(code.textContent);
      copy.textContent = "Copied";
    } catch {
      getSelection()?.selectAllChildren(code);
      copy.textContent = "Selected";
    }
    setTimeout(() => { copy.textContent = "Copy"; }, 1500);
  } }, "Copy");

  /** @type {(mark: string, kind: string, text: string, path?: string[]) => HTMLElement} */
  const line = (mark, kind, text, path) => {
    const field = path && fieldAt(path);
    const said = field ? h("a", { href: `#${field.input.id}`, onclick: (/** @type {Event} */ event) => {
      event.preventDefault();
      field.element.closest("details")?.setAttribute("open", "");
      field.input.focus();
    } }, text) : text;
    return h("li", {}, h("span", { class: kind, "aria-hidden": "true" }, mark), h("span", {}, said));
  };

  const view = {
    element: h("aside", { class: "side" },
      h("section", { class: "card" }, state, points, maySubmit() ? h("div", { class: "go" }, go) : null, cost, refusal),
      h("section", { class: "card" }, h("div", { class: "row" }, h("span", { class: "row grow", role: "group", "aria-label": "Form" }, tabs), copy), code)),
    code() { code.textContent = TEXTS[shown](spec()); },
    checking() { state.classList.add("soft"); },
    /** @param {boolean} busy */
    busy(busy) { go.disabled = busy; go.textContent = busy ? "Starting …" : "Find designs"; },
    /** @param {string} text */
    refused(text) { refusal.textContent = text; },
    /**
     * @param {import("./answers.js").CheckAnswer} answer
     * @param {Map<Field, Problem>} at what is wrong at a field
     * @param {Problem[]} left what is wrong elsewhere
     * @param {{objectives: number, stated: number, slots: string[]}} facts
     */
    show(answer, at, left, facts) {
      refusal.textContent = "";
      state.classList.remove("soft");
      const fields = [...at.keys()], missing = fields.filter((one) => one.value === "" && one.needed), wrong = fields.filter((one) => !missing.includes(one));
      const other = left.filter((problem) => problem.path.length);
      const loose = left.filter((problem) => !problem.path.length);
      const faults = wrong.length + other.length + loose.length;
      state.textContent = answer.ready && facts.objectives ? "Ready" : faults ? `${faults} to correct` : missing.length ? `${missing.length} more needed` : "Choose an objective";
      state.className = answer.ready && facts.objectives ? "good" : faults ? "fault-text" : "";
      points.replaceChildren(
        ...wrong.map((field) => line("✗", "fault", words(field.row.name), field.path)),
        ...[...other, ...loose].map((problem) => line("✗", "fault", problem.message)),
        ...(answer.remarks).map((remark) => line("○", "note", remark.message)),
        ...missing.map((field) => line("○", "note", words(field.row.name), field.path)),
        ...(answer.ready ? [line("✓", "good", `${facts.stated} requirements stated, all others by default`), facts.slots.length ? line("✓", "good", `Searched among parts: ${facts.slots.join(", ")}`) : ""] : []));
      cost.textContent = answer.combinations ? `${figure(answer.combinations)} combinations of parts and counts. You can close the page; the job goes on.` : "";
      go.disabled = !facts.objectives || faults > 0;
    },
  };
  return view;
}
