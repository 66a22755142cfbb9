/** A vertical section through a surface, with its dimensions. */

import { readable } from '../numbers.js';

const MARGIN = { left: 64, right: 16, top: 16, bottom: 30 };

/**
 * Cut a surface by the vertical plane through two points.
 * @param {ArrayLike<number>} xyz three per vertex
 * @param {ArrayLike<number>} faces
 * @param {number[]} a
 * @param {number[]} b
 * @returns {number[][][]} segments, each of two points [x, y, z, distance along the plane]
 */
export function cut(xyz, faces, a, b) {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
  const side = (v) => (xyz[3 * v] - a[0]) * along[1] - (xyz[3 * v + 1] - a[1]) * along[0] + 1e-12 * length;
  const found = [];
  for (let face = 0; face < faces.length; face += 3) {
    const ends = [];
    for (let k = 0; k < 3; k++) {
      const [u, v] = [faces[face + k], faces[face + ((k + 1) % 3)]];
      const [from, to] = [side(u), side(v)];
      if (from > 0 === to > 0) continue;
      const share = from / (from - to);
      const point = [0, 1, 2].map((axis) => xyz[3 * u + axis] + share * (xyz[3 * v + axis] - xyz[3 * u + axis]));
      ends.push([...point, (point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]]);
    }
    if (ends.length === 2) found.push(ends);
  }
  return found;
}

/**
 * Draw a section to scale.
 * @param {SVGSVGElement} svg
 * @param {number[][][]} segments
 * @param {string} unit
 * @returns {string} its dimensions in words
 */
export function drawSection(svg, segments, unit) {
  const points = segments.flat();
  const [low, high] = [3, 2].map((axis) => [Math.min(...points.map((p) => p[axis])), Math.max(...points.map((p) => p[axis]))]);
  const [span, rise] = [low[1] - low[0], high[1] - high[0]];
  const { clientWidth: width, clientHeight: height } = svg;
  const scale = Math.min((width - MARGIN.left - MARGIN.right) / (span || 1), (height - MARGIN.top - MARGIN.bottom) / (rise || 1e-9));
  const floor = height - MARGIN.bottom;
  const left = MARGIN.left + (width - MARGIN.left - MARGIN.right - span * scale) / 2;
  const at = (point) => `${(left + (point[3] - low[0]) * scale).toFixed(1)} ${(floor - (point[2] - high[0]) * scale).toFixed(1)}`;
  const make = (tag, attributes, text = '') => {
    const made = document.createElementNS(svg.namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    made.textContent = text;
    return made;
  };
  const words = (value) => `${readable(value, 4)}${unit ? ` ${unit}` : ''}`;
  const top = floor - rise * scale;
  const right = left + span * scale;
  svg.replaceChildren(
    make('path', { class: 'ground', d: `M${left - 8} ${floor}H${right + 8}` }),
    make('path', { class: 'cut', d: segments.map(([p, q]) => `M${at(p)}L${at(q)}`).join('') }),
    make('path', { class: 'size', d: `M${left} ${floor + 10}H${right}M${left} ${floor + 6}v8M${right} ${floor + 6}v8M${left - 12} ${floor}V${top}M${left - 16} ${floor}h8M${left - 16} ${top}h8` }),
    make('text', { x: (left + right) / 2, y: floor + 25, class: 'middle' }, words(span)),
    make('text', { x: left - 20, y: (floor + top) / 2 + 4, class: 'end' }, readable(rise, 4)),
  );
  const path = segments.reduce((sum, [p, q]) => sum + Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), 0);
  return `${words(span)} wide, ${words(rise)} high, ${words(path)} along the surface; heights from ${readable(high[0], 4)} to ${readable(high[1], 4)}`;
}
