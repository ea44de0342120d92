// Axes: round ticks, by logarithms where values span much, as in reports/front_plot.py.

const WIDE_RANGE = 20; // largest over smallest value from which on an axis is logarithmic
const ROOM = 0.06; // beside the outermost values, as a share of the axis

/**
 * @typedef {object} Axis
 * @property {boolean} log
 * @property {number[]} ticks
 * @property {(value: number) => number} share where on the axis a value lies, from 0 to 1
 * @property {(share: number) => number} at the value that lies there
 */

const roundStep = (/** @type {number} */ size) => {
  const power = 10 ** Math.floor(Math.log10(size));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= size * 0.999) ?? 10 * power;
};

/**
 * Return an axis on which all values have room.
 * @param {number[]} values
 * @param {number} [most] ticks
 * @param {number} [room]
 * @returns {Axis}
 */
export function axisOf(values, most = 6, room = ROOM) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) [low, high] = [0, 1];
  return low > 0 && high / low >= WIDE_RANGE ? logarithmic(low, high, most, room) : linear(low, high, most, room);
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} most
 * @param {number} room
 * @returns {Axis}
 */
function linear(low, high, most, room) {
  const span = high - low || Math.abs(high) * 0.2 || 1;
  const middle = high === low ? span / 2 : 0;
  const ends = [low - middle - room * span, high + middle + room * span];
  if (low >= 0 && ends[0] < 0) ends[0] = 0;
  const step = roundStep((ends[1] - ends[0]) / most);
  const ticks = [];
  for (let k = Math.ceil(ends[0] / step - 1e-9); k * step <= ends[1] * (1 + 1e-12); k += 1) {
    ticks.push(Number((k * step).toPrecision(12)));
  }
  const width = ends[1] - ends[0];
  return { log: false, ticks, share: (v) => (v - ends[0]) / width, at: (u) => ends[0] + u * width };
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} most
 * @param {number} room
 * @returns {Axis}
 */
function logarithmic(low, high, most, room) {
  const span = Math.log(high / low);
  const start = Math.log(low) - room * span;
  const width = span * (1 + 2 * room);
  const share = (/** @type {number} */ v) => (Math.log(v) - start) / width;
  const decades = (width / Math.LN10) * 1.0001;
  const steps = [[1, 2, 3, 5, 7], [1, 2, 5], [1, 3], [1]].find((each) => each.length * decades <= most * 1.7) ?? [1];
  const ticks = [];
  for (let power = Math.floor(start / Math.LN10); power <= Math.ceil((start + width) / Math.LN10); power += 1) {
    for (const step of steps) {
      const tick = Number((step * 10 ** power).toPrecision(6));
      if (share(tick) >= 0 && share(tick) <= 1) ticks.push(tick);
    }
  }
  return { log: true, ticks, share, at: (u) => Math.exp(start + u * width) };
}

/**
 * Return the range between two values.
 * @param {number} a
 * @param {number} b
 * @returns {import("./record.js").Range}
 */
export const rangeOf = (a, b) => (a <= b ? [a, b] : [b, a]);
