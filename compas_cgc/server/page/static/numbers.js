/** Formatting of numbers. */

const SUPERSCRIPT = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };

/**
 * Return a number with some digits, with a power of ten if it is very small or large.
 * @param {?number} value
 * @param {number} [digits]
 * @returns {string}
 */
export function readable(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits))).replace('-', '−');
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
  return `${String(Number(mantissa)).replace('-', '−')}\u00a0·\u00a0${power(Number(exponent))}`;
}

/**
 * Return a power of ten.
 * @param {number} exponent
 * @returns {string}
 */
export function power(exponent) {
  return `10${[...String(exponent)].map((sign) => SUPERSCRIPT[sign]).join('')}`;
}

/**
 * Return a time.
 * @param {?number} seconds
 * @returns {string}
 */
export function duration(seconds) {
  if (seconds === null || seconds === undefined) return '–';
  return seconds < 1 ? `${Math.max(1, Math.round(1000 * seconds))} ms` : `${seconds.toFixed(1)} s`;
}

/**
 * Return the smallest round number not below a value, for the ends of legends.
 * @param {number} size
 * @returns {number}
 */
export function roundAbove(size) {
  if (!(size > 0)) return 1;
  const decade = 10 ** Math.floor(Math.log10(size));
  const step = [1, 1.2, 1.6, 2, 3, 4, 5, 6, 8, 10].find((each) => each * decade >= size * (1 - 1e-9)) ?? 10;
  return Number((step * decade).toPrecision(3));
}

/**
 * Return the largest absolute value of numbers, of which some may be unknown.
 * @param {ArrayLike<?number>} values
 * @returns {number}
 */
export function largest(values) {
  return Array.prototype.reduce.call(values, (high, value) => (Number.isFinite(value) ? Math.max(high, Math.abs(value)) : high), 0);
}
