/** The colours of the package's pictures. */

export const REGIONS = ['#e8c48f', '#7fa6ad', '#cf8465', '#a7b58b', '#8d93b5', '#d9a5a0', '#b7a58f', '#6f8f86', '#e0d3b8'];
export const SIGNED = ['#08306b', '#2b7bba', '#a6cbe3', '#ffffff', '#f6b29a', '#d6403a', '#7f0d1a'];
export const NO_VALUE = '#b5b5b5';
export const SUPPORT = '#d62728';
export const ROUGH = '#f0a019';

const STOPS = SIGNED.map(parse);
const OF_REGIONS = REGIONS.map(parse);
const NONE = parse(NO_VALUE);

/**
 * Return red, green and blue in 0..1 (sRGB).
 * @param {string} hex
 * @returns {number[]}
 */
export function parse(hex) {
  return [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255);
}

/**
 * Return the colour of a region.
 * @param {number} region
 * @returns {string}
 */
export function regionColour(region) {
  return REGIONS[region % REGIONS.length];
}

/**
 * Return the colour of a region as channels.
 * @param {number} region
 * @returns {number[]} red, green and blue in 0..1 (sRGB)
 */
export function regionChannels(region) {
  return OF_REGIONS[region % OF_REGIONS.length];
}

/**
 * Return the colour of a value from -limit (blue) over 0 (white) to limit (red), grey for NaN.
 * @param {number} value
 * @param {number} limit
 * @returns {number[]} red, green and blue in 0..1 (sRGB)
 */
export function signedColour(value, limit) {
  if (!Number.isFinite(value)) return NONE;
  const place = (Math.max(-1, Math.min(1, value / limit)) + 1) * 0.5 * (STOPS.length - 1);
  const low = Math.min(STOPS.length - 2, Math.floor(place));
  return STOPS[low].map((from, channel) => from + (place - low) * (STOPS[low + 1][channel] - from));
}

/**
 * Return a colour channel in linear space, as used by three.js.
 * @param {number} channel sRGB in 0..1
 * @returns {number}
 */
export function linear(channel) {
  return channel <= 0.04045 ? channel / 12.92 : ((channel + 0.055) / 1.055) ** 2.4;
}
