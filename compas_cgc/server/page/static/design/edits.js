/** Changes of a design: each function returns a new design and does not modify the old one. */

/** @typedef {import('../types.js').Data} Data */

import { lifted } from '../mesh/lift.js';
import { regionsOf } from '../mesh/graph.js';

/** @type {WeakMap<number[], number[]>} a choice of supports together with the columns, so that the same choice is the same array */
const WITH_COLUMNS = new WeakMap();

/**
 * Return the supported vertices: those of the choice, and the drawn columns unless supports were chosen one by one.
 * @param {Data} data
 * @returns {number[]} vertices
 */
export function heldIn({ columns = [], supports, support_choice: choice }) {
  const own = supports[choice];
  const more = choice === 'hand' ? [] : columns.filter((vertex) => vertex >= 0 && !own.includes(vertex));
  if (!more.length) return own;
  if (!WITH_COLUMNS.has(own)) WITH_COLUMNS.set(own, [...own, ...more].sort((a, b) => a - b));
  return WITH_COLUMNS.get(own);
}

/**
 * Support or release vertices.
 * @param {Data} data
 * @param {number[]} vertices
 * @param {boolean} hold
 * @returns {Data}
 */
export function withHeld(data, vertices, hold) {
  const held = new Set(heldIn(data));
  for (const vertex of vertices) {
    if (hold) held.add(vertex);
    else held.delete(vertex);
  }
  const hand = [...held].sort((a, b) => a - b);
  return raised({ ...data, supports: { ...data.supports, hand }, support_choice: 'hand' });
}

/**
 * Select one of the choices of supports; heights of vertices that are not supported now are kept for later.
 * @param {Data} data
 * @param {string} choice
 * @returns {Data}
 */
export function withChoice(data, choice) {
  return raised({ ...data, support_choice: choice });
}

/**
 * Set the height of supports above their drawn position.
 * @param {Data} data
 * @param {number[]} vertices
 * @param {number} height
 * @returns {Data}
 */
export function withHeight(data, vertices, height) {
  const heights = { ...data.heights };
  for (const vertex of vertices) {
    if (height) heights[vertex] = height;
    else delete heights[vertex];
  }
  return raised({ ...data, heights });
}

/** @param {Data} data */
function raised(data) {
  const before = data.ground ?? data.vertices;
  const held = heldIn(data);
  if (!held.some((vertex) => data.heights?.[vertex])) return data.ground ? { ...data, vertices: before, ground: undefined } : data;
  return { ...data, ground: before, vertices: lifted(before, held, data.heights) };
}

/**
 * Add a crease.
 * @param {Data} data
 * @param {number[]} path vertices along edges
 * @returns {Data}
 */
export function withCrease(data, path) {
  return divided(data, [...data.creases, path]);
}

/**
 * Remove a crease.
 * @param {Data} data
 * @param {number} vertex on it
 * @returns {Data}
 */
export function withoutCrease(data, vertex) {
  return divided(
    data,
    data.creases.filter((path) => !path.includes(vertex)),
  );
}

/** Renumber the regions; each keeps K, law, name and colour of the old region with the largest overlap. */
function divided(data, creases) {
  const regions = regionsOf(Uint32Array.from(data.faces.flat()), creases, data.vertices.length);
  const count = Math.max(...regions) + 1;
  const shares = Array.from({ length: count }, () => new Map());
  regions.forEach((region, face) => {
    const old = data.regions[face];
    shares[region].set(old, (shares[region].get(old) ?? 0) + 1);
  });
  const from = shares.map((share) => [...share].sort((a, b) => b[1] - a[1])[0][0]);
  // The largest part of a divided region keeps the name.
  const heir = from.map((old, region) => regions.length && from.every((other, k) => other !== old || size(shares, k, old) <= size(shares, region, old)));
  const kept = (list) => from.map((old, region) => (heir[region] ? (list?.[old] ?? null) : null));
  return {
    ...data,
    creases,
    regions,
    targets: from.map((old) => data.targets[old]),
    laws: Object.fromEntries(from.flatMap((old, region) => (data.laws?.[old] ? [[region, data.laws[old]]] : []))),
    names: kept(data.names),
    colours: kept(data.colours),
    problems: [],
  };
}

function size(shares, region, old) {
  return shares[region].get(old) ?? 0;
}

/**
 * Name a region.
 * @param {Data} data
 * @param {number} region
 * @param {string} name
 * @returns {Data}
 */
export function withName(data, region, name) {
  return { ...data, names: data.targets.map((_, each) => (each === region ? name.trim() || null : (data.names?.[each] ?? null))) };
}

/**
 * Colour a region.
 * @param {Data} data
 * @param {number} region
 * @param {string} colour hex
 * @returns {Data}
 */
export function withColour(data, region, colour) {
  return { ...data, colours: data.targets.map((_, each) => (each === region ? colour : (data.colours?.[each] ?? null))) };
}

/**
 * Give a region a law other than constant K, or constant K again.
 * @param {Data} data
 * @param {number} region
 * @param {string} law such as minimal or H = 0.1, empty for constant K
 * @returns {Data}
 */
export function withLaw(data, region, law) {
  const { [region]: _, ...laws } = data.laws ?? {};
  const targets = data.targets.map((K, each) => (each === region ? (K ?? 0) : K));
  return { ...data, targets, laws: law.trim() ? { ...laws, [region]: law.trim() } : laws };
}

/**
 * Change the goals.
 * @param {Data} data
 * @param {import('../types.js').Goals} goals some of rise, found, edge, above, below, boxes
 * @returns {Data}
 */
export function withGoals(data, goals) {
  return { ...data, wishes: { ...data.wishes, ...goals } };
}
