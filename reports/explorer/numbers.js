// How numbers are shown: as reports/numbers.py prints them, with a thin space between thousands.

const THIN = "\u202f";
const WIDE = 30; // between the least and the largest number of a column, beyond which each has its own digits
const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

const trimmed = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);

/** @param {string} digits */
function grouped(digits) {
  const [whole, rest] = digits.split(".");
  const parted = whole.length > 3 ? whole.replace(/(\d)(?=(\d{3})+$)/g, `$1${THIN}`) : whole;
  return rest === undefined ? parted : `${parted}.${rest}`;
}

/**
 * Return a number with so many significant digits.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 * @returns {string}
 */
export function number(value, digits = 5) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const sign = value < 0 ? "−" : "";
  const size = Math.abs(value);
  if (size === Infinity) return `${sign}∞`;
  if (size === 0) return "0";
  if (Number.isInteger(size) && size < 1e6) return sign + grouped(String(size));
  const [mantissa, power] = size.toExponential(digits - 1).split("e");
  const exponent = Number(power);
  if (exponent >= -4 && exponent < 6) {
    return sign + grouped(trimmed(size.toFixed(Math.max(0, digits - 1 - exponent))));
  }
  const raised = String(exponent).replace(/[-\d]/g, (figure) => RAISED[figure]);
  return `${sign}${trimmed(mantissa)}·10${raised}`;
}

/**
 * Return how the numbers of a column are shown: all with the decimals that the one that needs most of them has.
 * @param {(number | null)[]} values
 * @param {number} digits
 * @returns {(value: number | null) => string}
 */
export function columnNumbers(values, digits) {
  const sizes = values.filter((value) => value).map(Math.abs);
  const wide = Math.max(...sizes) > WIDE * Math.min(...sizes);
  const places = Math.max(0, ...values.map((value) => number(value, digits).split(".")[1]?.length ?? 0));
  const plain = sizes.every((size) => size >= 1e-4 && size < 1e6);
  if (wide || !plain || !places) return (value) => number(value, digits);
  return (value) => (value ? (value < 0 ? "−" : "") + grouped(Math.abs(value).toFixed(places)) : number(value));
}

/**
 * Return a number with its unit.
 * @param {number | null | undefined} value
 * @param {string} unit
 * @param {number} [digits]
 */
export function amount(value, unit, digits = 5) {
  const text = number(value, digits);
  return !unit || text === "–" ? text : text + (unit === "°" ? unit : `\u00a0${unit}`);
}

/**
 * Return a share in per cent, with a place more near the limit.
 * @param {number | null} share
 */
export function percent(share) {
  if (share === null || share === undefined) return "–";
  const close = share >= 0.995 && share < 1.005 && share !== 1;
  return `${number(Number((100 * share).toFixed(close ? 2 : 1)))}\u00a0%`;
}

/**
 * Return a change in per cent with its sign.
 * @param {number} change
 */
export function signed(change) {
  const size = Math.abs(change);
  return `${change > 0 ? "+" : "−"}${number(Number(size.toPrecision(2)), 2)}\u00a0%`;
}
