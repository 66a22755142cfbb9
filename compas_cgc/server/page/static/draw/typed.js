/** Parsing of typed lengths, angles and coordinates. */

import { numberIn } from '../fields.js';

/**
 * Return the point given by a text.
 * @param {string} text a length; a length and an angle such as 5 < 30; or coordinates such as 3; 4, relative to the last point
 * @param {?number[]} last point
 * @param {?number[]} towards position of the pointer
 * @returns {?number[]} null where it says nothing
 */
export function typedPoint(text, last, towards) {
  const clean = text.trim().replace('°', '');
  // A comma without a space is a decimal sign.
  const place = clean.match(/^([-+\d.,e]+?)(?:\s*;\s*|,\s+|\s+)([-+\d.,e]+)$/i);
  if (place) {
    const [x, y] = place.slice(1).map(numberIn);
    return [x, y].every(Number.isFinite) ? [x + (last?.[0] ?? 0), y + (last?.[1] ?? 0)] : null;
  }
  const polar = clean.match(/^([\d.,e+-]+)(?:\s*<\s*(-?[\d.,]+))?$/i);
  if (!polar || !last) return null;
  const length = numberIn(polar[1]);
  const angle = polar[2] === undefined ? Math.atan2((towards?.[1] ?? last[1]) - last[1], (towards?.[0] ?? last[0] + 1) - last[0]) : (numberIn(polar[2]) * Math.PI) / 180;
  if (!(length > 0) || !Number.isFinite(angle)) return null;
  return [last[0] + length * Math.cos(angle), last[1] + length * Math.sin(angle)];
}
