/** Snapping of the pointer to points, lines, axis directions from the last point, or the grid. */

import { isAt, segmentsOf } from './plan.js';

/**
 * Return the smallest grid step of at least a given size.
 * @param {number} size
 * @returns {number}
 */
export function roundStep(size) {
  const decade = 10 ** Math.floor(Math.log10(size));
  return decade * [1, 2, 5, 10].find((each) => each * decade >= size * 0.999);
}

/**
 * Return the snapped position of the pointer.
 * @param {number[]} at
 * @param {import('./plan.js').Plan} plan
 * @param {number[][]} draft points of the current line
 * @param {{reach: number, step: number, skip?: number[][]}} how snapping distance, grid step, and the places of points to exclude
 * @returns {{at: number[], on: string}} on: point, line, straight or grid
 */
export function snapped(at, plan, draft, { reach, step, skip = [] }) {
  const isSkipped = isAt(skip);
  const points = [...draft, ...plan.lines.filter((line) => !line.circle).flatMap(({ points: all }) => all), ...plan.columns.map(({ x, y }) => [x, y])];
  const near = nearest(
    points.filter((point) => !isSkipped(point)),
    at,
  );
  if (near && apart(near, at) <= reach) return { at: near, on: 'point' };
  const grid = at.map((value) => Math.round(value / step) * step);
  const feet = plan.lines
    .filter((line) => !line.points.some(isSkipped))
    .flatMap(segmentsOf)
    .map(([a, b]) => foot(at, a, b, step));
  const on = nearest(feet, at);
  if (on && apart(on, at) <= 0.8 * reach) return { at: on, on: 'line' };
  const [last, first] = [draft.at(-1), draft[0]];
  const straight = [...grid];
  let aligned = false;
  for (const from of [first, last]) {
    if (!from) continue;
    for (const axis of [0, 1]) {
      if (Math.abs(at[axis] - from[axis]) <= 0.7 * reach) {
        straight[axis] = from[axis];
        aligned = true;
      }
    }
  }
  return { at: straight, on: aligned ? 'straight' : 'grid' };
}

/** Return the point on a segment nearest to a point, at a rounded distance from its start. */
function foot(at, a, b, step) {
  const along = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(...along) || 1;
  const place = ((at[0] - a[0]) * along[0] + (at[1] - a[1]) * along[1]) / length;
  const round = Math.max(0, Math.min(length, Math.round(place / step) * step));
  return [a[0] + (along[0] * round) / length, a[1] + (along[1] * round) / length];
}

function nearest(points, at) {
  return points.reduce((best, point) => (!best || apart(point, at) < apart(best, at) ? point : best), null);
}

function apart(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
