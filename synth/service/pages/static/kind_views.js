// What kinds of jobs have found that are no front: each as curve, table or sentence.

import { API, get, sentence } from "./api.js";
import { numberIn, tableOf, tableView } from "./csv.js";
import { curveOf } from "./curve.js";
import { duration, figure, h, s, unitText, words } from "./dom.js";
import { percent, signed, usedShare } from "./numbers.js";
import { marksOf } from "./what_if_track.js";
import { count, outcomeText } from "./words.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./dom.js").Child} Child
 * @typedef {import("./records.js").Study} Study
 * @typedef {import("./records.js").Step} Step
 * @typedef {import("./records.js").Break} Break
 * @typedef {import("../../../../reports/explorer/record.js").FrontRecord} FrontRecord
 * @typedef {(job: Job, facts: import("./records.js").Summary) => Promise<(Node | null)[]>} View what a job has found, with the facts of it
 * @typedef {{name: string, kind: string, prices: Record<string, Cells>}} PriceLine what one requirement or limit costs in each objective
 * @typedef {Record<string, string>} Cells of a row of CSV, by heading
 */

const SHOWN = 12; // rows of a table before the rest is unfolded
const USED = 90; // pixels of a bar that is used in full

/** @type {Record<string, View>} */
const VIEWS = { whatif: whatIfView, prices: pricesView, near_equals: nearView, rate: rateView, verify: verifyView, report: reportView };

/**
 * Tell whether there is a view for a job.
 * @param {Job} job
 */
export const hasView = (job) => job.kind in VIEWS && Boolean(job.summary);

/**
 * Show what a job has found.
 * @param {HTMLElement} element
 * @param {Job} job
 */
export async function kindView(element, job) {
  element.replaceChildren(...(await VIEWS[job.kind](job, job.summary ?? {})).filter((one) => one !== null));
}

/**
 * @param {string} title
 * @param {...Child} children
 */
const card = (title, ...children) => h("section", { class: "card stack" }, title ? h("h2", {}, title) : null, children);
/**
 * @param {string} kind
 * @param {string} mark
 * @param {string} text
 */
const badge = (kind, mark, text) => h("span", { class: `badge ${kind}` }, h("span", { "aria-hidden": "true" }, mark), text);
/** @param {string} text */
const arrows = (text) => words(text).replaceAll("->", "→");
/**
 * @param {string} kind
 * @param {string} mark
 * @param {string} word
 * @param {string} text
 * @param {...Child} more
 */
const verdict = (kind, mark, word, text, ...more) => h("section", { class: `card verdict ${kind}` }, h("p", {}, badge(kind, mark, word), " ", h("b", {}, text)), more);

/**
 * Return a table of which the first rows stand open.
 * @template R
 * @param {string} label
 * @param {import("./csv.js").FoundColumn<R>[]} columns
 * @param {R[]} rows
 * @param {(row: R) => string} [kind] class of a row
 */
function folded(label, columns, rows, kind) {
  if (rows.length <= SHOWN + 3) return tableView(label, columns, rows, kind);
  return [tableView(label, columns, rows.slice(0, SHOWN), kind), h("details", { class: "more" }, h("summary", {}, `${rows.length - SHOWN} more`), tableView(`${label}, the rest`, columns, rows.slice(SHOWN), kind))];
}

// ---- what if ----------------------------------------------------------------------------------------------------------

/** @type {Record<string, [kind: string, mark: string, text: string]>} */
const STANDS = { optimal: ["good", "✓", "proven"], feasible: ["", "✓", "not proven"], infeasible: ["warn", "!", "nothing fits"], not_found: ["warn", "?", "none found"], not_solved: ["", "–", "no answer in time"] };

/** @type {View} */
async function whatIfView(job, facts) {
  const [study, table] = await Promise.all([/** @type {Promise<Study>} */ (get(`/jobs/${job.id}/result`)), tableOf(job.id, "whatif.csv")]);
  const along = study.varied[study.along ?? 0], others = study.varied.filter((one) => one !== along);
  const place = study.varied.indexOf(along);
  /** @param {string} name */
  const column = (name) => table.columns.find((one) => one.name === name)?.key ?? name;
  const objectives = Object.entries(study.objectives).map(([name, sense]) => ({ name, sense, unit: study.units[name], key: column(name) }));
  /** @type {Map<Step, (number | null)[]>} */
  const best = new Map();
  for (const step of study.steps) {
    const rows = table.rows.filter((row) => row.step === String(step.number));
    best.set(step, objectives.map(({ key, sense }) => {
      const values = rows.map((row) => row[key]).filter((cell) => cell !== "" && cell !== undefined).map(Number);
      return values.length ? (sense === "max" ? Math.max : Math.min)(...values) : null;
    }));
  }
  const numeric = study.steps.every((step) => typeof step.values[place] === "number");
  const found = numeric && !others.length ? marksOf(study) : { marks: [], barren: [] };
  /** @param {Step} step */
  const other = (step) => step.values.filter((_, k) => k !== place).map((value, k) => `${words(others[k].label)} ${figure(Number(value))} ${unitText(others[k].unit)}`.trim()).join(", ");
  /** @param {number} k */
  const series = (k) => {
    /** @type {Map<string, [number, number | null][]>} */
    const lines = new Map();
    for (const step of study.steps) lines.set(other(step), [...(lines.get(other(step)) ?? []), [Number(step.values[place]), best.get(step)?.[k] ?? null]]);
    return [...lines].map(([label, points]) => ({ label, points: points.sort((a, b) => a[0] - b[0]) })).filter(({ points }) => points.some(([, y]) => y !== null));
  };
  const across = { name: along.label, unit: along.unit };
  const curves = numeric ? objectives.map((objective, k) => ({ ...objective, lines: series(k) })).filter(({ lines }) => lines.length).map(({ name, unit, sense, lines }) =>
    curveOf(across, { name, unit, note: sense === "max" ? "the largest there is" : "the least there is" }, lines, { ...found, marks: found.marks.filter((mark) => !mark.objective || mark.objective === name) })) : [];
  /** @param {Step} step */
  const stated = (step) => step.values.map((value, k) => (Array.isArray(value) ? value.join(", ") : typeof value === "number" ? `${figure(value)} ${unitText(study.varied[k].unit)}`.trim() : value));
  const seen = new Set();
  /** @param {Break} one */
  const once = (one) => one.kind !== "feasible" || others.length > 0 || !(seen.has(Boolean(one.before)) || !seen.add(Boolean(one.before)));
  const breaks = study.breaks.filter(once).sort((a, b) => a.value - b.value);
  const ends = found.marks.filter((mark) => mark.ends).map((mark) => mark.text.split(":")[0]);
  return [
    card(`${words(along.label)}${others.length ? ` and ${others.map((one) => words(one.label)).join(", ")}` : ""}: ${count(study.steps.length, "value")}`,
      h("p", {}, [facts.feasible_steps === facts.steps ? "There are designs at every value." : `There are designs at ${facts.feasible_steps} of ${facts.steps} values.`, ...ends.map((text) => `${text}.`), facts.breaks ? `${count(facts.breaks, "change")} of the best parts or counts between them.` : ""].filter(Boolean).join(" ")),
      study.interrupted ? h("p", { class: "note" }, `Interrupted: ${study.interrupted}`) : null,
      curves.length ? h("div", { class: "curves" }, curves) : null),
    breaks.length ? card("Where something changes", folded("Where something changes", [
      { title: words(along.label), unit: along.unit, cell: (one) => one.value },
      { title: "for", words: true, cell: (one) => (one.kind === "feasible" ? "all" : `${study.objectives[one.objective] === "max" ? "largest" : "least"} ${words(one.objective)}`) },
      { title: "what changes there", long: true, cell: (one) => arrows(one.change) },
      { title: "proven", words: true, cell: (one) => (one.proven ? "yes" : "no") },
    ], breaks)) : null,
    card("Values", tableView("Values", [
      ...study.varied.map((one, k) => ({ title: words(one.label), words: typeof study.steps[0]?.values[k] !== "number", cell: (/** @type {Step} */ step) => stated(step)[k] })),
      { title: "stands", cell: (/** @type {Step} */ step) => badge(...(STANDS[step.status] ?? ["", "○", words(step.status)])) },
      ...objectives.map((objective, k) => ({ title: `${objective.sense === "max" ? "largest" : "least"} ${words(objective.name)}`, unit: objective.unit, cell: (/** @type {Step} */ step) => best.get(step)?.[k] })),
      { title: "why there is none", long: true, cell: (/** @type {Step} */ step) => h("span", { class: "note" }, step.front?.designs.length ? "" : words(step.reason)) },
    ].filter((one) => one.title !== "why there is none" || study.steps.some((step) => step.reason && !step.front?.designs.length)), study.steps)),
  ];
}

// ---- prices -----------------------------------------------------------------------------------------------------------

/**
 * Return the front that prices are of as the explorer has it; null where it is not there any more.
 * @param {Job} job
 */
async function frontOf(job) {
  try {
    const asked = await get(`/jobs/${job.id}/request`);
    return asked.family ? null : /** @type {FrontRecord} */ (await get(`/jobs/${asked.of}/files/explorer.json`));
  } catch {
    return null;
  }
}

/**
 * Return how much one step of something is in its unit; nothing where it has none.
 * @param {FrontRecord | null} front
 * @param {number} share
 */
function stepsOf(front, share) {
  const asked = new Map([...(front?.asked ?? []), ...(front?.assumed ?? [])].map((one) => [one.label, one]));
  const limits = new Map((front?.limits ?? []).map((one, k) => [one.label, k]));
  const objectives = new Map((front?.quantities ?? []).map((one, k) => [one.name, { unit: one.unit, k }]));
  const designs = new Map((front?.designs ?? []).map((design) => [String(design.rank), design]));
  /**
   * @param {unknown} value
   * @param {string | undefined} unit
   */
  const told = (value, unit) => (typeof value === "number" && unit ? `${signed(value)}\u00a0${unit}` : "");
  return {
    /**
     * @param {PriceLine} line
     * @param {string} design
     */
    of({ kind, name }, design) {
      const k = limits.get(words(name)) ?? -1, stated = asked.get(words(name));
      const [value, unit] = kind === "limit" ? [designs.get(design)?.sides[k]?.[1], front?.limits[k]?.unit] : [stated?.value, stated?.unit];
      return typeof value === "number" ? told(share * value, unit) : "";
    },
    /**
     * @param {string} name
     * @param {string} design
     * @param {number} percents
     */
    change(name, design, percents) {
      const { unit, k } = objectives.get(name) ?? { unit: "", k: -1 };
      return told(((designs.get(design)?.v[k] ?? NaN) * percents) / 100, unit);
    },
  };
}

/** @type {View} */
async function pricesView(job, facts) {
  const [{ rows }, front] = await Promise.all([tableOf(job.id, "prices.csv"), frontOf(job)]);
  const step = String(facts.step ?? "1 %");
  const moved = step.includes("%") ? parseFloat(step) : 100 * parseFloat(step); // per cent; prices are told for one
  const own = rows.filter((row) => row.status !== "no influence");
  const designs = [...new Set(own.map((row) => row.design))];
  const objectives = [...new Set(own.map((row) => row.objective))];
  const steps = stepsOf(front, moved / 100), lacking = (facts.asked ?? 0) - (facts.designs ?? 0);
  /**
   * @param {string | undefined} value
   * @param {string} name
   * @param {string} design
   */
  const change = (value, name, design) => (value === "" || value === undefined ? h("span", { class: "note" }, "not told") : Math.abs(Number(value)) < 5e-4 ? "0" : [`${signed(moved * Number(value))} %`, h("span", { class: "note in-unit" }, steps.change(name, design, moved * Number(value)))]);
  /** @param {string} design */
  const view = (design) => {
    /** @type {Map<string, PriceLine>} */
    const lines = new Map();
    for (const row of own.filter((row) => row.design === design)) lines.set(row.quantity, { name: row.quantity, kind: row.kind, prices: { ...lines.get(row.quantity)?.prices, [row.objective]: row } });
    /** @param {PriceLine} line */
    const size = (line) => Math.max(...objectives.map((name) => Math.max(Math.abs(Number(line.prices[name]?.up || 0)), Math.abs(Number(line.prices[name]?.down || 0)))));
    const order = [...lines.values()].filter((line) => size(line) >= 5e-4).sort((a, b) => size(b) - size(a));
    /** @param {PriceLine} line */
    const remark = (line) => [...new Set(objectives.map((name) => line.prices[name]).filter((row) => row && row.status !== "confirmed").flatMap((row) => (row.reason || row.status).split("; ").map((text) => remarked(text, step))))].join("; ");
    if (!order.length) return h("p", {}, "Nothing that was asked has a price here: no limit holds this design back.");
    return folded(`Prices of design ${design}`, [
      { title: "requirement or limit", words: true, cell: (line) => [words(line.name), h("span", { class: "note in-unit" }, steps.of(line, design))] },
      ...objectives.flatMap((name) => [
        { title: `${words(name)}: ${step} more`, right: true, cell: (/** @type {PriceLine} */ line) => change(line.prices[name]?.up, name, design) },
        { title: `${words(name)}: ${step} less`, right: true, cell: (/** @type {PriceLine} */ line) => change(line.prices[name]?.down && String(-Number(line.prices[name].down)), name, design) },
      ]),
      { title: "remark", long: true, cell: (line) => h("span", { class: "note" }, remark(line)) },
    ], order);
  };
  return [
    card("", h("p", {}, `What ${step} more, or less, of each requirement and limit changes in ${objectives.map(words).join(" and ")}: what holds a design back has a price. Those that change nothing are left out.`)),
    ...designs.map((design) => card(`Design ${design}`, view(design))),
    lacking > 0 ? h("p", { class: "note" }, `${lacking} designs were not reached in the time.`) : null,
  ];
}

/**
 * Return a reason in few words: which other parts a step asks for.
 * @param {string} text
 * @param {string} step
 */
const remarked = (text, step) => arrows(text.replace(/^(up|down)wards .*? these parts cannot keep all limits, others can: /, (_, way) => `other parts with ${step} ${way === "up" ? "more" : "less"}: `)
  .replace(/^(up|down)wards holds for (.*)$/, (_, way, share) => `${way === "up" ? "more" : "less"} holds for ${share}`).replace(/^upwards /, "more: ").replace(/^downwards /, "less: "));

// ---- near equals ------------------------------------------------------------------------------------------------------

/** @type {View} */
async function nearView(job, facts) {
  const { columns, rows } = await tableOf(job.id, "near_equals.csv");
  const changes = columns.filter(({ name }) => name.startsWith("change: "));
  const objectives = changes.map(({ name }) => columns.find((column) => column.name === name.slice(8))).filter((column) => column !== undefined);
  return [
    verdict(facts.complete ? "good" : "warn", facts.complete ? "✓" : "!", facts.complete ? "complete" : "not complete", sentence(arrows(facts.sentence ?? outcomeText(job))), facts.interrupted ? h("p", { class: "note" }, `Interrupted: ${facts.interrupted}`) : null),
    rows.length ? card("Nearly as good", tableView("Nearly as good", [
      { title: "what differs", words: true, cell: (row) => arrows(row.differences) },
      ...changes.map(({ key, name }) => ({ title: `change of ${words(name.slice(8))}`, right: true, cell: (/** @type {Cells} */ row) => (Number(row.number) ? `${signed(Number(row[key]))}\u00a0%` : "–") })),
      ...objectives.map(({ key, name, unit }) => ({ title: words(name), unit, cell: (/** @type {Cells} */ row) => row[key] })),
      { title: "design", words: true, cell: (row) => h("a", { href: `${API}/jobs/${job.id}/files/design_${String(row.number).padStart(2, "0")}.yaml`, download: true }, "YAML") },
    ], rows, (row) => (Number(row.number) ? "" : "chosen"))) : null,
  ];
}

// ---- rating -----------------------------------------------------------------------------------------------------------

/** @param {number} share */
function bar(share) {
  const tone = share > 1 + 1e-9 ? "bad" : share >= 0.999 ? "hot" : "";
  return s("svg", { class: `used ${tone}`, width: USED + 30, height: 12, viewBox: `0 0 ${USED + 30} 12`, "aria-hidden": "true" }, s("rect", { class: "base", x: 0, y: 3, width: USED, height: 6, rx: 1 }),
    s("rect", { class: "fill", x: 0, y: 3, width: Math.min(USED + 28, Math.max(0, USED * share)), height: 6, rx: 1 }), s("path", { class: "end", d: `M${USED} 0v12` }));
}

/** @type {View} */
async function rateView(job, facts) {
  const [designs, limits] = await Promise.all([tableOf(job.id, "rating.csv"), tableOf(job.id, "robust.csv")]);
  const where = limits.columns.filter(({ name }) => name.startsWith("worst at: "));
  const all = facts.holding === facts.rated;
  /** @param {string} text */
  const holds = (text) => ({ yes: badge("good", "✓", "holds"), no: badge("bad", "✗", "does not hold") }[text] ?? badge("warn", "!", "not shown"));
  /** @param {Cells} row */
  const at = (row) => where.filter(({ key }) => row[key] !== "").map(({ key, name, unit }) => `${words(name.slice(10))} ${figure(Number(row[key]))} ${unitText(unit)}`.trim()).join(", ");
  /** @param {number} value */
  const share = (value) => percent(value < 1 ? Math.floor(1e4 * value) / 1e4 : 1, 4); // what is not all is never shown as all
  /** @param {Cells} row */
  const chance = (row) => (row.yield === "" ? "" : `${share(Number(row.yield))} (${share(Number(row["yield low"]))} to ${share(Number(row["yield high"]))})`);
  return [
    verdict(all ? "good" : "warn", all ? "✓" : "!", `${facts.holding} of ${facts.rated} hold`, sentence(facts.sentence), facts.interrupted ? h("p", { class: "note" }, `Interrupted: ${facts.interrupted}`) : null),
    card("Over the whole range", tableView("How designs stand what scatters", [
      { title: "design", cell: (row) => row.rank },
      { title: "over the range", cell: (row) => holds(row.robust) },
      { title: "yield", words: true, cell: chance },
      { title: "worst limit", words: true, cell: (row) => words(row["worst limit"]) },
      { title: "used", right: true, cell: (row) => usedShare(numberIn(row["worst utilisation"])) },
      { title: "worst at", words: true, cell: (row) => row["worst at"] },
    ], designs.rows)),
    ...designs.rows.map((design) => {
      const rows = limits.rows.filter((row) => row.rank === design.rank && row.utilisation !== "").sort((a, b) => Number(b.utilisation) - Number(a.utilisation));
      return card(`Design ${design.rank}: how far each limit is used at its worst`, folded(`Limits of design ${design.rank}`, [
        { title: "limit", words: true, cell: (row) => words(row.limit) },
        { title: "over the range", cell: (row) => holds(row.robust) },
        { title: "used", words: true, cell: (row) => h("span", { class: "share-used" }, bar(Number(row.utilisation)), usedShare(numberIn(row.utilisation))) },
        { title: "value", cell: (row) => row.value },
        { title: "limit", cell: (row) => row["limit value"] },
        { title: "unit", words: true, cell: (row) => unitText(row.unit) || "–" },
        { title: "worst at", words: true, cell: at },
      ], rows, (row) => (row.robust === "no" ? "missed" : "")));
    }),
  ];
}

// ---- verification -----------------------------------------------------------------------------------------------------

/** @type {Record<string, [kind: string, mark: string]>} */
const VERDICTS = { holds: ["good", "✓"], "does not hold": ["bad", "✗"], fails: ["bad", "✗"] };

/** @type {View} */
async function verifyView(job) {
  const found = /** @type {import("./records.js").Verification} */ (await get(`/jobs/${job.id}/result`));
  const [kind, mark] = found.holds ? VERDICTS.holds : VERDICTS[words(found.verdict)] ?? ["warn", "!"];
  const facts = [["designs looked at", found.designs], ["proof", words(found.certificate)], ["gap that was claimed", found.claimed_gap === null ? null : percent(found.claimed_gap)], ["gap that was proven again", found.proven_gap === null ? null : percent(found.proven_gap)],
    ["boxes of the proof", figure(found.nodes)], ["time", typeof found.seconds === "number" ? duration(found.seconds) : null]].filter(([, value]) => value !== null && value !== undefined && value !== "");
  /**
   * @param {string} title
   * @param {string[]} entries
   */
  const list = (title, entries) => (entries?.length ? card(title, h("ul", { class: "misses" }, entries.map((entry) => h("li", {}, sentence(arrows(typeof entry === "string" ? entry : JSON.stringify(entry))))))) : null);
  return [
    verdict(kind, mark, words(found.verdict), sentence(arrows(found.sentence.replace(new RegExp(`^${found.verdict}: `), "").replace(/ \(\d+ boxes, [^()]*\)$/, "")))),
    list("What is not right", found.findings), list("What stays open", found.open),
    card("How it was checked", h("dl", { class: "facts" }, facts.map(([name, value]) => [h("dt", {}, name), h("dd", {}, String(value))])), h("p", { class: "note" }, "By code that shares nothing with the search: designs are computed anew, and bounds are proven by another method.")),
  ];
}

// ---- report -----------------------------------------------------------------------------------------------------------

/** @type {View} */
async function reportView(job, facts) {
  const { files = [], notes } = facts;
  return [
    card(count(files.length, "file"), h("ul", { class: "written" }, files.map((name) => h("li", {}, h("a", { href: `${API}/jobs/${job.id}/files/${name}`, download: name.split("/").at(-1) }, name)))),
      notes?.length ? h("ul", { class: "note" }, notes.map((note) => h("li", {}, sentence(note)))) : null),
  ];
}
