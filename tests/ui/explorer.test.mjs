// Sorting, filters and the state in the address of the explorer, which need no page.

import assert from "node:assert/strict";
import test from "node:test";

import { explorerModule } from "./beside.mjs";

/** @type {typeof import("../../reports/explorer/model.js")} */
const { emptyModel, grouping, modelOf } = await explorerModule("model.js");
/** @type {typeof import("../../reports/explorer/state.js")} */
const { passes, readState, stateText } = await explorerModule("state.js");
/** @type {typeof import("../../reports/explorer/table.js")} */
const { sortedBy } = await explorerModule("table.js");
/** @typedef {import("../../reports/explorer/record.js").FrontRecord} FrontRecord */

/**
 * @param {number} rank
 * @param {(number | null)[]} v mass, cost and width
 * @param {string} steel
 * @param {string} [note]
 */
const design = (rank, v, steel, note = "") => ({
  rank, v, note, parts: { steel: `steels/${steel}` }, choices: {}, score: null, status: "optimal", gap: 0, why: "",
  used: [], sides: [], spec: {}, at_limit: [],
});

/**
 * @param {string} name
 * @param {"variable" | "derived"} kind
 */
const quantity = (name, kind) => ({ name, label: name, unit: "", kind, text: "", symbol: "", source: "" });

/** @param {string} name */
const part = (name) => ({ name, table: "steels", source: "", confidence: "", note: "" });

/** @type {FrontRecord} */
const record = {
  format: 1, program: "", title: "", family: "", facts: [], asked: [], assumed: [], nothing: null, limits: [], spec: {},
  objectives: { mass: "min", cost: "min" },
  certificate: {
    level: "good", word: "", sentence: "", head: "", gap: 0, details: [], combinations: 4, excluded: 0, solved: 4,
    unresolved: 0, offered: [], not_part: [],
  },
  quantities: [quantity("mass", "derived"), quantity("cost", "derived"), quantity("width", "variable")],
  parts: { "steels/A": part("A"), "steels/B": part("B") },
  designs: [
    design(1, [4, 1, 10], "A"), design(2, [2, 2, null], "B", "knee"), design(3, [1, 8, 30], "B"),
    design(4, [3, 1.5, 20], "A"),
  ],
};
const model = modelOf(record);

test("values are sorted in both directions, what is missing last, equal ones as they were", () => {
  assert.deepEqual(sortedBy([10, null, 30, 20], 1), [0, 3, 2, 1]);
  assert.deepEqual(sortedBy([10, null, 30, 20], -1), [2, 3, 0, 1]);
  assert.deepEqual(sortedBy(["B", "A", "B", "A"], 1), [1, 3, 0, 2]);
  assert.deepEqual(sortedBy([2, 2, 1], 1), [2, 0, 1]);
});

test("a model finds axes, groups, names and the knee", () => {
  assert.deepEqual(model.axes.map((c) => c.key), ["mass", "cost", "width"]);
  assert.equal(model.groupBy, "part:steel");
  assert.deepEqual(grouping(model.column("part:steel"), 4), { names: ["A", "B"], of: [0, 1, 1, 0], rest: -1 });
  assert.equal(model.knee, 1);
  assert.deepEqual(model.names, [["smallest cost"], ["knee"], ["smallest mass"], []]);
  assert.throws(() => model.axis("part:steel"));
});

test("filters leave what lies in all ranges and is of a group that is shown", () => {
  const state = readState(model, "");
  const groups = grouping(model.column(state.by), model.count);
  const kept = () => [0, 1, 2, 3].filter((i) => passes({ model, state }, groups, i));
  assert.deepEqual(kept(), [0, 1, 2, 3]);
  state.ranges.set("mass", [2, 3]);
  assert.deepEqual(kept(), [1, 3]);
  state.off.add(1);
  assert.deepEqual(kept(), [3]);
  state.off.clear();
  state.ranges.set("width", [-Infinity, Infinity]);
  assert.deepEqual(kept(), [3], "a value that is not known lies in no range");
});

test("the text of a state is read back as it was", () => {
  for (const text of ["", "x=cost&y=width", "by=&design=3", "compare=1-3", "keep=mass%7E2%7E3&keep=cost%7E%7E1.5"]) {
    assert.equal(stateText({ model, state: readState(model, text) }), text);
  }
});

test("what does not fit a model is left out of its state", () => {
  for (const text of ["x=nothing", "by=mass", "design=9", "compare=8-9", "keep=nothing~1~2", "keep=mass~a~b", "%%"]) {
    assert.equal(stateText({ model, state: readState(model, text) }), "", text);
  }
  const empty = emptyModel({ ...record, designs: [] }, model);
  assert.equal(readState(empty, "x=cost&design=1").x, "cost");
  assert.equal(readState(empty, "design=1").selected, -1);
});
