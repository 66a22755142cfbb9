/** Conversion of a design to text, for files and (compressed) for links. */

import { pack, unpack } from '../packed.js';

const DIGITS = 10; // of coordinates; the tenth of a roof of 100 m is a hundredth of a micrometre
const MARK = 'compas_cgc design';
const MAX_LENGTH = 1_500_000; // characters of a link that browsers accept

/**
 * Return a design as the text of a file.
 * @param {import('../types.js').State} state
 * @returns {string}
 */
export function asText({ stage, data, plan, name }) {
  const { file, ...rest } = data ?? /** @type {import('../types.js').Data} */ ({});
  const held = data && { ...rest, vertices: data.vertices.map((point) => point.map(short)), ground: data.ground?.map((point) => point.map(short)) };
  return JSON.stringify({ kind: MARK, version: 1, name, stage, plan, data: held });
}

/**
 * Return the design in the text of a file.
 * @param {string} text
 * @returns {import('../types.js').State}
 * @throws {Error} if the text is not a design
 */
export function fromText(text) {
  let found = null;
  try {
    found = JSON.parse(text);
  } catch {
    // Reported below.
  }
  if (found?.kind !== MARK || !(found.data || found.plan)) throw new Error('This file is not a saved design.');
  if (found.version > 1) throw new Error('This design was saved by a newer version of this page.');
  return found;
}

/**
 * Return a design as the fragment of an address.
 * @param {import('../types.js').State} state
 * @returns {Promise<string>}
 * @throws {Error} if the design is too large
 */
export async function asFragment(state) {
  const bytes = await deflated(asText(state));
  let text = '';
  for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  const packed = btoa(text).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  if (packed.length > MAX_LENGTH) throw new Error('This mesh is too large for a link. Save the design as a file and send that.');
  return packed;
}

/**
 * Return the design in the fragment of an address.
 * @param {string} packed
 * @returns {Promise<import('../types.js').State>}
 */
export async function fromFragment(packed) {
  try {
    const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), (sign) => sign.charCodeAt(0));
    return fromText(await inflated(bytes));
  } catch {
    throw new Error('The link is incomplete. Copy it again, or use the design as a file.');
  }
}

/**
 * Return a design with its solved surface, history and view, compressed for the server.
 * @param {import('../types.js').State} state
 * @returns {Promise<Uint8Array>}
 */
export function packed({ solution = null, states = [], at = 0, view = null, ...state }) {
  const held = solution && {
    ...solution,
    xyz: pack(solution.xyz, 'f8', [solution.xyz.length / 3, 3]),
    targets: pack(solution.targets, 'f8', [solution.targets.length]),
    curvature: pack(solution.curvature, 'f8', [solution.curvature.length]),
    faces: solution.faces && pack(solution.faces, 'i4', [solution.faces.length / 3, 3]),
  };
  // Meshes are the largest part, and most states share one.
  /** @type {any[]} */
  const shared = [];
  const reference = (name, value) => {
    if (value instanceof File) return undefined;
    if (!['vertices', 'ground', 'faces', 'regions'].includes(name) || !Array.isArray(value)) return value;
    if (!shared.includes(value)) shared.push(value);
    return { shared: shared.indexOf(value) };
  };
  const text = JSON.stringify({ state, states, at, view }, reference);
  return deflated(JSON.stringify({ kind: MARK, version: 2, content: JSON.parse(text), shared, solution: held }));
}

/**
 * Return the design in the bytes of :func:`packed`.
 * @param {Uint8Array} bytes
 * @returns {Promise<import('../types.js').State>}
 */
export async function unpacked(bytes) {
  let found = null;
  try {
    found = JSON.parse(await inflated(bytes));
  } catch {
    // Reported below.
  }
  if (found?.kind !== MARK || !found.content) throw new Error('The design on the server is damaged.');
  if (found.version > 2) throw new Error('This design was saved by a newer version of this page.');
  const whole = (value) => {
    if (typeof value !== 'object' || value === null) return value;
    if (Number.isInteger(value.shared)) return found.shared[value.shared];
    if (Array.isArray(value)) return value.map(whole);
    return Object.fromEntries(Object.entries(value).map(([name, own]) => [name, whole(own)]));
  };
  const { state, states, at, view } = whole(found.content);
  const held = found.solution;
  const solution = held && { ...held, xyz: unpack(held.xyz), targets: unpack(held.targets), curvature: unpack(held.curvature), faces: held.faces ? unpack(held.faces) : undefined };
  return { ...state, states, at, view, solution };
}

async function deflated(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** @returns {Promise<string>} */
function inflated(bytes) {
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'))).text();
}

function short(value) {
  return Number(value.toPrecision(DIGITS));
}
