// Numbers as people read them: the rule of synth/text/numbers.py in the characters of pages. Both are tested on
// synth/text/number_cases.json.

const THIN = "\u202f";
const MINUS = "−";
const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const WIDE = 30; // ratio of the largest to the least number of a column from which on each has its own decimals
const DIGITS = 4; // significant
export const FULL_DIGITS = 6; // where a limit is violated, two texts would be equal, or a number was typed
const SHARE_DIGITS = 3; // of per cents and factors
const LEAST_PER_CENT = 0.001; // shown as a bound below it

/** @param {string} text */
const trimmed = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);

/** @param {string} digits */
function grouped(digits) {
  const [whole, rest] = digits.split(".");
  const parted = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, THIN) : whole;
  return rest === undefined ? parted : `${parted}.${rest}`;
}

/** @param {number} power */
const raised = (power) => String(power).replace("-", "⁻").replace(/\d/g, (figure) => RAISED[Number(figure)]);

/**
 * Sign, digits without groups and power of ten of a number; the sign is that of pages.
 * @param {number | null | undefined} value
 * @param {number} [digits] significant digits; digits before the point are never replaced by zeros
 * @returns {{sign: string, digits: string, power: number}}
 */
export function shown(value, digits = DIGITS) {
  if (value === null || value === undefined) return { sign: "", digits: "–", power: 0 };
  if (Number.isNaN(value)) return { sign: "", digits: "not known", power: 0 };
  const sign = value < 0 ? MINUS : "";
  const size = Math.abs(value);
  if (size === Infinity) return { sign, digits: "∞", power: 0 };
  if (size === 0) return { sign: "", digits: "0", power: 0 };
  const [mantissa, power] = size.toExponential(digits - 1).split("e");
  const exponent = Number(power);
  if (exponent < -4 || exponent > 6) return { sign, digits: trimmed(mantissa), power: exponent };
  return { sign, digits: trimmed(size.toFixed(Math.max(0, digits - 1 - exponent))), power: 0 };
}

/**
 * Number as text.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export function number(value, digits = DIGITS) {
  const told = shown(value, digits);
  return told.sign + grouped(told.digits) + (told.power ? `·10${raised(told.power)}` : "");
}

/**
 * Number with its unit; an unknown one has none.
 * @param {number | null | undefined} value
 * @param {string} unit
 * @param {number} [digits]
 */
export function amount(value, unit, digits = DIGITS) {
  const text = number(value, digits);
  const known = value !== null && value !== undefined && !Number.isNaN(value);
  return unit && known ? text + (unit === "°" ? unit : `\u00a0${unit}`) : text;
}

/**
 * Share in per cent.
 * @param {number | null | undefined} share
 * @param {number} [digits]
 */
export function percent(share, digits = SHARE_DIGITS) {
  if (share === null || share === undefined || Number.isNaN(share)) return number(share);
  const size = Math.abs(100 * share);
  if (size > 0 && size < LEAST_PER_CENT) {
    return `${share > 0 ? "< " : `> ${MINUS}`}${LEAST_PER_CENT}\u00a0%`;
  }
  return `${number(100 * share, digits)}\u00a0%`;
}

/**
 * Used share of a limit, in per cent: more digits where a violated limit would be shown as used in full.
 * @param {number | null | undefined} share
 */
export function usedShare(share) {
  const text = percent(share);
  return typeof share === "number" && share > 1 && text === percent(1) ? percent(share, FULL_DIGITS) : text;
}

/**
 * Number with its sign, a plus too.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export const signed = (value, digits = SHARE_DIGITS) =>
  (typeof value === "number" && value > 0 ? "+" : "") + number(value, digits);

/**
 * How the numbers of a column are shown: with the same decimals, those needed as far as the largest has them.
 * @param {(number | null | undefined)[]} values
 * @param {number} [digits]
 * @returns {(value: number | null | undefined) => string}
 */
export function columnNumbers(values, digits = DIGITS) {
  const own = (/** @type {number | null | undefined} */ value) => number(value, digits);
  const known = /** @type {number[]} */ (values.filter((value) => value && Number.isFinite(value)));
  const each = known.map((value) => shown(value, digits));
  const sizes = known.map(Math.abs);
  const largest = Math.max(...sizes);
  if (!known.length || largest > WIDE * Math.min(...sizes) || each.some(({ power }) => power)) return own;
  const needed = Math.max(...each.map((one) => one.digits.split(".")[1]?.length ?? 0));
  const places = Math.min(needed, Math.max(0, digits - 1 - Math.floor(Math.log10(largest))));
  return (value) => {
    if (!value || !Number.isFinite(value)) return own(value);
    return (value < 0 ? MINUS : "") + grouped(Math.abs(value).toFixed(places));
  };
}
