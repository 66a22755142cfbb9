/** Conversion of a design to text, for files and (compressed) for links. */

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
  const stream = new Blob([asText(state)]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
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
    return fromText(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'))).text());
  } catch {
    throw new Error('The link is incomplete. Copy it again, or use the design as a file.');
  }
}

function short(value) {
  return Number(value.toPrecision(DIGITS));
}
