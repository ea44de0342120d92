// What the columns of a table mean: as their headings say, or as somebody chooses.

import { get } from "./api.js";
import { h, unitText, words } from "./dom.js";

/**
 * @typedef {import("./answers.js").BatchCheck} BatchCheck
 * @typedef {import("./answers.js").Problem} Problem
 * @typedef {import("./records.js").DeclarationRow} DeclarationRow
 */

const CARRY = "carry";
const STRUCTURE = ["family", "options", "limits", "fix", "parts"];
/** @type {[label: string, sections: string[]][]} */
const GROUPS = [["Requirements", ["needed", "limit", "assumption"]], ["Options", ["option"]], ["Given sizes, counts and parts", ["variable", "count", "choice", "part"]]];
const SHOWN_CELLS = 3;
/** @type {Map<string, DeclarationRow[]>} */
const declared = new Map(); // family -> the rows of its declaration that a table may name

/**
 * Return what a table may say of a family, by name.
 * @param {string} family
 */
async function namesOf(family) {
  const known = declared.get(family) ?? (await get(`/families/${family}`)).rows.filter((row) => GROUPS.some(([, sections]) => sections.includes(row.section)));
  declared.set(family, known);
  return known;
}

/**
 * Return a card that asks what each column means.
 * @param {() => void} changed called when somebody has chosen
 */
export function columnsCard(changed) {
  const columns = h("ul", { class: "meanings" });
  const own = h("span", { class: "note" });
  const asked = h("details", { open: true }, h("summary", {}, h("h2", {}, "What the columns mean"), own), columns);
  const element = h("section", { class: "card", hidden: true }, asked);
  /** @type {Column[]} */
  let all = [];
  /** @type {string | null} */
  let families = null;

  /**
   * @param {string[]} header
   * @param {{cells: string[]}[]} rows
   */
  function bring(header, rows) {
    const before = new Map(all.map((one) => [one.title, one]));
    const same = header.length === all.length && header.every((title) => before.has(title));
    if (!same) {
      all = header.map((title, k) => new Column(title, k, changed));
      for (const one of all) one.as(before.get(one.title));
      families = null;
      columns.replaceChildren(...all.map((one) => one.element));
    }
    all.forEach((one, k) => one.cells(rows.map((row) => row.cells[k] ?? "")));
    element.hidden = false;
  }

  /**
   * Tell what the service understands, and offer the names of the families that rows name.
   * @param {BatchCheck | null} answer
   * @param {string[]} known
   */
  async function told(answer, known) {
    const names = new Map(answer?.columns.map((column) => [column.title, column.name]) ?? []);
    const offered = known.join(",");
    if (offered !== families) {
      families = offered;
      const rows = await Promise.all(known.map((family) => namesOf(family).catch(() => [])));
      const merged = new Map(rows.flat().map((row) => [row.name, row]));
      if (offered === families) for (const one of all) one.offer(merged);
    }
    for (const one of all) one.understood(answer ? names.get(one.title) ?? "" : one.likely());
    const mapped = Object.keys(request()).length, carried = answer ? answer.carried.length : 0;
    own.textContent = [`${all.length - carried} understood`, carried ? `${carried} carried along` : "", mapped ? `${mapped} chosen here` : ""].filter(Boolean).join(" · ");
    if (!answer) own.textContent = "";
  }

  /**
   * Show what is wrong with a heading at its column; tell whether it was one.
   * @param {Problem | null | undefined} problem
   */
  function fault(problem) {
    for (const one of all) one.fault("");
    const places = (/** @type {string} */ title) => [`mapping: ${title}:`, `, line 1, column ${title}:`, `, line 1: got '${title}'`, `, line 1: got "${title}"`];
    const found = all.find((one) => problem && (problem.value === one.title || places(one.title).some((text) => problem.message.includes(text))));
    if (!problem || !found) return false;
    const told = problem.value === null || problem.value === undefined ? "expected" : `got ${problem.value}; expected`;
    found.fault(`${told} ${problem.expected.replace(/ \(or '.*$/s, "")}`, problem.expected.split(" (or ")[0], problem.value !== found.title);
    asked.open = true;
    return true;
  }

  const request = () => Object.fromEntries(all.map((one) => [one.title, one.stated]).filter(([, stated]) => stated));
  return { element, bring, told, fault, request };
}

class Column {
  /**
   * @param {string} title
   * @param {number} k its place
   * @param {() => void} changed
   */
  constructor(title, k, changed) {
    this.title = title;
    this.changed = changed;
    this.name = ""; // as the service understands it
    /** @type {Map<string, DeclarationRow>} */
    this.rows = new Map();
    /** @type {string | undefined} */
    this.wanted = undefined;
    this.first = h("p", { class: "note cells" });
    this.said = h("option", { value: "" }, "as the heading says");
    /** @type {HTMLElement[]} */
    this.groups = [];
    this.choice = h("select", { id: `means-${k}`, "aria-label": `What ${title} means`, "aria-describedby": `means-${k}-fault`, onchange: () => { this.unit.value = ""; this.measured(); changed(); } },
      this.said, h("option", { value: CARRY }, "left out: carried along unread"));
    this.unit = h("input", { id: `unit-${k}`, class: "unit", "aria-label": `Unit of ${title}`, "aria-describedby": `means-${k}-fault`, autocomplete: "off", spellcheck: "false", oninput: changed });
    this.measure = h("label", { class: "row note", hidden: true }, "in", this.unit);
    this.wrong = h("p", { class: "fault", id: `means-${k}-fault` });
    this.mend = h("p", { class: "row" });
    this.element = h("li", {}, h("div", {}, h("p", { class: "heading-text" }, title), this.first), h("div", { class: "row means" }, this.choice, this.measure), this.wrong, this.mend);
  }

  /** @param {string[]} texts */
  cells(texts) { this.first.textContent = texts.slice(0, SHOWN_CELLS).map((text) => text || "–").join(" · "); }

  /**
   * Keep what was chosen for the same heading of an earlier file.
   * @param {Column | undefined} other
   */
  as(other) {
    if (!other?.stated) return;
    this.wanted = other.choice.value;
    this.unit.value = other.unit.value;
    this.rows = other.rows;
    this.offer(other.rows);
  }

  /** @param {Map<string, DeclarationRow>} rows */
  offer(rows) {
    const chosen = this.wanted ?? this.choice.value;
    this.rows = rows;
    for (const group of this.groups) group.remove();
    const named = (/** @type {DeclarationRow} */ row) => h("option", { value: row.name }, words(row.name), unitText(row.unit) ? `, ${unitText(row.unit)}` : "");
    const groups = GROUPS.map(([label, sections]) => ({ label, options: [...rows.values()].filter((row) => sections.includes(row.section)).map(named) }));
    groups.push({ label: "Several at once", options: STRUCTURE.map((name) => h("option", { value: name }, name)) });
    this.groups = groups.filter(({ options }) => options.length).map(({ label, options }) => h("optgroup", { label }, options));
    this.choice.append(...this.groups);
    this.choice.value = chosen;
    if (this.choice.selectedIndex < 0) this.choice.value = "";
    this.wanted = undefined;
    this.measured();
  }

  /** What the heading says, where the service cannot tell because another one is wrong. */
  likely() {
    const name = this.title.split(" [")[0].trim();
    return this.rows.has(name) || STRUCTURE.includes(name) ? name : "";
  }

  /**
   * Tell what the service makes of the column.
   * @param {string} name
   */
  understood(name) {
    if (this.choice.value === "") this.name = name;
    this.said.textContent = this.name ? `${words(this.name)}, as the heading says` : "carried along: no name of ours";
    this.element.classList.toggle("carried", this.choice.value === CARRY || (this.choice.value === "" && name === ""));
    this.measured();
  }

  /** Ask for a unit where what the column means has one. */
  measured() {
    const row = this.rows.get(this.choice.value || this.name);
    const measured = Boolean(row?.unit && row.unit !== "-");
    this.measure.hidden = !measured;
    this.unit.placeholder = row && measured ? /\[(.+)\]\s*$/.exec(this.title)?.[1] ?? row.unit : "";
  }

  /** What goes to the service; nothing where the heading says it all. */
  get stated() {
    const unit = this.measure.hidden ? "" : this.unit.value.trim();
    const name = this.choice.value || (unit ? this.name : "");
    return name && unit && name !== CARRY ? `${name} [${unit}]` : name;
  }

  /**
   * Show what is wrong with what the column means, or with its unit.
   * @param {string} text
   */
  fault(text, meant = "", measured = false) {
    this.wrong.textContent = text && text[0].toUpperCase() + text.slice(1);
    this.unit.setAttribute("aria-invalid", String(Boolean(text) && measured && !this.measure.hidden));
    this.choice.setAttribute("aria-invalid", String(Boolean(text)));
    this.element.classList.toggle("bad", Boolean(text));
    const take = (/** @type {string} */ value, /** @type {string} */ words) => h("button", { type: "button", class: "small", onclick: () => { this.wanted = value; this.offer(this.rows); this.changed(); this.choice.focus(); } }, words);
    const known = this.rows.has(meant) || STRUCTURE.includes(meant);
    this.mend.replaceChildren(...(text ? [...(known ? [take(meant, `It means ${words(meant)}`)] : []), take(CARRY, "Leave it out")] : []));
  }
}
