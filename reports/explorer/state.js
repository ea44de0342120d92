// What is chosen, filtered and compared: one object, and its text for an address.

const AXES = /** @type {const} */ (["x", "y"]);
export const CHOSEN = /** @type {const} */ (["x", "y", "by"]);

/**
 * @typedef {object} State
 * @property {string} x column across
 * @property {string} y column up
 * @property {string} by column that gives colour and shape
 * @property {number} selected index of the design that the panel shows
 * @property {number} hovered -1 for none
 * @property {number[]} pins designs that are compared
 * @property {Map<string, Range>} ranges what is kept, by column
 * @property {Set<number>} off groups that are hidden
 * @property {[string, number]} sort column of the table, 1 or -1
 * @property {Set<string> | null} columns of the table, null for the usual ones
 */

/**
 * @typedef {import("./record.js").Model} Model
 * @typedef {import("./record.js").Range} Range
 */

/**
 * @param {Model} model
 * @returns {State}
 */
function firstState(model) {
  const [across, up] = [model.axes[0], model.axes[1] ?? model.axes[0]];
  return {
    x: across?.key ?? "",
    y: up?.key ?? "",
    by: model.groupBy,
    selected: model.knee >= 0 ? model.knee : model.count ? 0 : -1,
    hovered: -1,
    pins: [],
    ranges: new Map(),
    off: new Set(),
    sort: ["rank", 1],
    columns: null,
  };
}

/**
 * Return the state that a text tells, as far as it fits the model.
 * @param {Model} model
 * @param {string} text
 * @returns {State}
 */
export function readState(model, text) {
  const state = firstState(model);
  const told = new URLSearchParams(text);
  const keys = new Set(model.axes.map((c) => c.key));
  for (const name of AXES) {
    const key = told.get(name);
    if (key !== null && keys.has(key)) state[name] = key;
  }
  const by = told.get("by");
  if (by === "" || (by !== null && model.groupable.some((c) => c.key === by))) state.by = by;
  const indexOf = (/** @type {string | null} */ rank) => model.record.designs.findIndex((d) => String(d.rank) === rank);
  const chosen = indexOf(told.get("design"));
  if (chosen >= 0) state.selected = chosen;
  state.pins = [...new Set((told.get("compare") ?? "").split("-").map(indexOf))].filter((i) => i >= 0).slice(0, 4);
  for (const entry of told.getAll("keep")) {
    const [key, low, high] = entry.split("~");
    /** @type {Range} */
    const range = [low === "" ? -Infinity : Number(low), high === "" ? Infinity : Number(high)];
    if (keys.has(key) && range.every((v) => !Number.isNaN(v))) state.ranges.set(key, range);
  }
  return state;
}

/**
 * Return the text of a state: only what is not as it was at first.
 * @param {{model: Model, state: State}} shown
 */
export function stateText({ model, state }) {
  const first = firstState(model);
  const told = new URLSearchParams();
  for (const name of CHOSEN) if (state[name] !== first[name]) told.set(name, state[name]);
  const rank = (/** @type {number} */ i) => model.record.designs[i].rank;
  if (state.selected !== first.selected && state.selected >= 0) told.set("design", String(rank(state.selected)));
  if (state.pins.length) told.set("compare", state.pins.map(rank).join("-"));
  const short = (/** @type {number} */ v) => (Number.isFinite(v) ? String(Number(v.toPrecision(6))) : "");
  for (const [key, [low, high]] of state.ranges) told.append("keep", `${key}~${short(low)}~${short(high)}`);
  return told.toString();
}

/**
 * Tell whether a design passes what is filtered: its group is shown, and it lies in all ranges.
 * @param {{model: Model, state: State}} shown
 * @param {import("./record.js").Groups} groups
 * @param {number} i
 */
export function passes({ model, state }, groups, i) {
  if (state.off.has(groups.of[i])) return false;
  for (const [key, [low, high]] of state.ranges) {
    const value = model.axis(key).values[i];
    if (value === null || value < low || value > high) return false;
  }
  return true;
}
