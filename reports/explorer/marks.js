// Shapes of groups: told apart by form as well as by colour.

import { s } from "./dom.js";

/** @type {((r: number) => string)[]} */
const SHAPES = [
  (r) => `M${-r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0z`,
  (r) => {
    const a = 0.86 * r;
    return `M${-a} ${-a}h${2 * a}v${2 * a}h${-2 * a}z`;
  },
  (r) => {
    const a = 1.22 * r;
    return `M0 ${-a}L${a} 0L0 ${a}L${-a} 0z`;
  },
  (r) => {
    const a = 1.15 * r;
    return `M0 ${-a}L${a} ${0.85 * a}H${-a}z`;
  },
  (r) => {
    const a = 1.15 * r;
    return `M0 ${a}L${a} ${-0.85 * a}H${-a}z`;
  },
  (r) => {
    const [a, b] = [1.15 * r, 0.42 * r];
    const [out, wide] = [a - b, 2 * b];
    return [
      `M${-b} ${-a}h${wide}v${out}h${out}v${wide}h${-out}v${out}`,
      `h${-wide}v${-out}h${-out}v${-wide}h${out}z`,
    ].join("");
  },
];

/**
 * Return the outline of a group's shape around (0, 0).
 * @param {number} group
 * @param {number} size
 */
export const shape = (group, size) => SHAPES[group % SHAPES.length](size);

/**
 * Return the mark of a group for a line of text.
 * @param {number} group
 * @param {number} rest
 */
export const glyph = (group, rest) =>
  s(
    "svg",
    { class: "glyph", width: 14, height: 14, viewBox: "-7 -7 14 14", "aria-hidden": "true" },
    s("path", { d: shape(group, 5), class: colourClass(group, rest) }),
  );

/**
 * Return the class that gives a group its colour: others are grey, where there are no groups all is of one colour.
 * @param {number} group
 * @param {number} rest
 */
export const colourClass = (group, rest) => (group === rest ? "g g-rest" : rest === -2 ? "g g1" : `g g${group}`);
