// Cases of the rule of numbers, as synth/text/numbers.py has them, in the characters of pages.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

import { columnNumbers, number, percent, amount, signed, usedShare } from "../../synth/ui/numbers.js";

const cases = JSON.parse(readFileSync(new URL("../../synth/text/number_cases.json", import.meta.url), "utf-8"));

/** @param {string} text */
const page = (text) => text.replaceAll("-", "−").replaceAll(/(?<=\d) (?=\d)/g, "\u202f").replaceAll(" %", "\u00a0%");

test("numbers", () => {
  for (const [value, digits, text] of cases.numbers) assert.equal(number(value, digits), page(text), `${value}`);
});

test("per cents", () => {
  for (const [share, digits, text] of cases.shares) assert.equal(percent(share, digits), page(text), `${share}`);
});

test("columns", () => {
  for (const [values, digits, texts] of cases.columns) {
    assert.deepEqual(values.map(columnNumbers(values, digits)), texts.map(page), `${values}`);
  }
});

test("numbers that are missing", () => {
  for (const missing of [null, undefined]) {
    assert.deepEqual([number(missing), amount(missing, "mm"), percent(missing), usedShare(missing)], Array(4).fill("–"));
    assert.equal(signed(missing), "–");
  }
  assert.equal(number(NaN), "not known");
  assert.equal(amount(-Infinity, "mm"), "−∞\u00a0mm");
});

test("signs, units and limits", () => {
  assert.deepEqual([signed(0.0514), signed(-12.5, 2), signed(0)], ["+0.0514", "−13", "0"]);
  assert.deepEqual([amount(90, "°"), amount(12000, "N·m"), amount(3, "")], ["90°", "12\u202f000\u00a0N·m", "3"]);
  assert.deepEqual([0.5, 1, 1.00004, 1.234].map(usedShare), ["50\u00a0%", "100\u00a0%", "100.004\u00a0%", "123\u00a0%"]);
});
