/** Plans of a rationalised design. */

import { signedColour } from '../colours.js';
import { lengthScale, limitOf, mouldColour } from './found.js';

const MARGIN = 10; // around the surface [pixel]
const FOOT = 36; // room for the scale bar and the legend [pixel]
const STEEP = 0.5; // share of the vertical in the mean normal below which an elevation is drawn
const CLOSED = 0.3; // length of the mean normal, of unit normals, below which the surface closes
const BAR = [1, 2, 5];
const BAR_PART = 0.3; // of the width, length of the scale bar at most

/**
 * Draw the panels of a result in the colours of their moulds, or the distance from the design.
 * @param {HTMLCanvasElement} canvas
 * @param {import('./jobs.js').Told} told
 * @param {'moulds' | 'distance'} by
 * @param {string} unit
 * @returns {string} what is drawn: plan, elevation, or view of a surface that closes
 */
export function drawPlan(canvas, told, by, unit) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const { name, right, up, back } = axesOf(told);
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  [canvas.width, canvas.height] = [Math.round(ratio * width), Math.round(ratio * height)];
  const pen = canvas.getContext('2d');
  if (!pen || !width || !height) return name;
  pen.scale(ratio, ratio);
  const along = (axis) => told.vertices.map((point) => axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2]);
  const [xs, ys, depths] = [along(right), along(up), along(back)];
  const [left, farRight, low, high] = [least(xs), most(xs), least(ys), most(ys)];
  const scale = Math.min((width - 2 * MARGIN) / (farRight - left || 1), (height - MARGIN - FOOT) / (high - low || 1));
  const [dx, dy] = [(width - scale * (farRight - left)) / 2, (height - FOOT + MARGIN - scale * (high - low)) / 2];
  const at = told.vertices.map((_, k) => [dx + scale * (xs[k] - left), dy + scale * (high - ys[k])]);
  const limit = limitOf(told);
  const colour = (face) => {
    if (by === 'moulds') return mouldColour(told.classes[told.panel_of_face[face]]);
    const mean = told.faces[face].reduce((sum, vertex) => sum + told.distances[vertex] / 3, 0);
    return `rgb(${signedColour(mean, limit).map((channel) => Math.round(255 * channel))})`;
  };
  // The nearest faces are drawn last.
  const depth = told.faces.map((corners) => corners.reduce((sum, vertex) => sum + depths[vertex], 0));
  const order = told.faces.map((_, face) => face).sort((a, b) => depth[a] - depth[b]);
  pen.lineJoin = 'round';
  pen.lineWidth = 0.8;
  for (const face of order) {
    pen.beginPath();
    for (const vertex of told.faces[face]) pen.lineTo(at[vertex][0], at[vertex][1]);
    pen.closePath();
    pen.fillStyle = pen.strokeStyle = colour(face);
    pen.fill();
    // Without it, gaps between the triangles show.
    pen.stroke();
  }
  const style = getComputedStyle(canvas);
  pen.strokeStyle = style.getPropertyValue('--line3d').trim();
  pen.globalAlpha = by === 'moulds' ? 0.75 : 0.25;
  pen.beginPath();
  if (name !== 'View') {
    for (const [a, b] of told.seams) {
      pen.moveTo(at[a][0], at[a][1]);
      pen.lineTo(at[b][0], at[b][1]);
    }
  }
  pen.stroke();
  pen.globalAlpha = 1;
  drawBar(pen, { width, height, scale, unit, colour: style.color });
  return name;
}

/** Draw a scale bar of a round length. */
function drawBar(pen, { width, height, scale, unit, colour }) {
  const longest = (BAR_PART * width) / scale;
  const decade = 10 ** Math.floor(Math.log10(longest));
  const length = BAR.map((own) => own * decade).findLast((own) => own <= longest);
  const { text } = lengthScale(unit, length);
  const [x, y] = [width - MARGIN - scale * length, height - 6.5];
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = 1;
  pen.beginPath();
  pen.moveTo(x, y - 4);
  pen.lineTo(x, y);
  pen.lineTo(x + scale * length, y);
  pen.lineTo(x + scale * length, y - 4);
  pen.stroke();
  pen.font = '12px system-ui, sans-serif';
  pen.textAlign = 'right';
  pen.fillText(text(length), x - 6, y + 0.5);
}

/**
 * Check whether the normals point upwards in the mean, so that positive distances are above the design.
 * @param {import('./jobs.js').Told} told
 * @returns {boolean}
 */
export function isUpwards(told) {
  return normalsOf(told).sum[2] > 0;
}

/** Return the sum of the normals of all faces, and that of their sizes. */
function normalsOf({ vertices, faces }) {
  const sum = [0, 0, 0];
  let area = 0;
  for (const [a, b, c] of faces) {
    const [u, v] = [b, c].map((other) => [0, 1, 2].map((axis) => vertices[other][axis] - vertices[a][axis]));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    normal.forEach((value, axis) => (sum[axis] += value));
    area += Math.hypot(...normal);
  }
  return { sum, area };
}

/** Return the axes along which most of a surface is seen. */
function axesOf(told) {
  const { sum, area } = normalsOf(told);
  const size = Math.hypot(...sum);
  if (size < CLOSED * area) return viewFrom([0.41, -0.82, 0.41], 'View');
  if (Math.abs(sum[2]) >= STEEP * size) return { name: 'Plan', right: [1, 0, 0], up: [0, 1, 0], back: [0, 0, 1] };
  return viewFrom([sum[0], sum[1], 0], 'Elevation');
}

function viewFrom(direction, name) {
  const back = unitOf(direction);
  const right = unitOf([-back[1], back[0], 0]);
  const up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]];
  return { name, right, up, back };
}

function unitOf(vector) {
  const size = Math.hypot(...vector);
  return vector.map((value) => value / size);
}

function least(values) {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}

function most(values) {
  return values.reduce((a, b) => Math.max(a, b), -Infinity);
}
