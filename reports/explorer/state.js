// What is chosen, filtered and compared: one object, and its text for an address.

/**
 * @typedef {object} State
 * @property {string} x column across
 * @property {string} y column up
 * @property {string} by column that gives colour and shape
 * @property {number} selected index of the design that the panel shows
 * @property {number} hovered -1 for none
 * @property {number[]} pins designs that are compared
 * @property {Map<string, [number, number]>} ranges what is kept, by column
 * @property {Set<number>} off groups that are hidden
 * @property {[string, number]} sort column of the table, 1 or -1
 * @property {Set<string> | null} columns of the table, null for the usual ones
 */

/** @returns {State} */
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
 * @param {ReturnType<typeof import("./model.js").modelOf>} model
 * @param {string} text
 * @returns {State}
 */
export function readState(model, text) {
  const state = firstState(model);
  const told = new URLSearchParams(text);
  const keys = new Set(model.axes.map((c) => c.key));
  for (const name of ["x", "y"]) if (keys.has(told.get(name))) state[name] = told.get(name);
  if (told.get("by") === "" || model.groupable.some((c) => c.key === told.get("by"))) state.by = told.get("by");
  const indexOf = (rank) => model.record.designs.findIndex((d) => String(d.rank) === rank);
  const chosen = indexOf(told.get("design"));
  if (chosen >= 0) state.selected = chosen;
  state.pins = [...new Set((told.get("compare") ?? "").split("-").map(indexOf))].filter((i) => i >= 0).slice(0, 4);
  for (const entry of told.getAll("keep")) {
    const [key, low, high] = entry.split("~");
    const range = [low === "" ? -Infinity : Number(low), high === "" ? Infinity : Number(high)];
    if (keys.has(key) && range.every((v) => !Number.isNaN(v))) state.ranges.set(key, range);
  }
  return state;
}

/** Return the text of a state: only what is not as it was at first. */
export function stateText({ model, state }) {
  const first = firstState(model);
  const told = new URLSearchParams();
  for (const name of ["x", "y", "by"]) if (state[name] !== first[name]) told.set(name, state[name]);
  const rank = (i) => model.record.designs[i].rank;
  if (state.selected !== first.selected && state.selected >= 0) told.set("design", String(rank(state.selected)));
  if (state.pins.length) told.set("compare", state.pins.map(rank).join("-"));
  const short = (v) => (Number.isFinite(v) ? String(Number(v.toPrecision(6))) : "");
  for (const [key, [low, high]] of state.ranges) told.append("keep", `${key}~${short(low)}~${short(high)}`);
  return told.toString();
}
