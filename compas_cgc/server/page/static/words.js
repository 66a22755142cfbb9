/** Sentences. */

// Replacements of terms for scripts by labels of the page.
/** @type {[RegExp, string][]} */
const SAID = [
  [/ ?\((?:mesh\.|--|CGCMesh|compas)[^()]*(?:\([^()]*\)[^()]*)*\)/g, ''],
  [/supports "boundary" fixes the whole boundary/g, 'choose “Whole edge” under Supports'],
  [/mesh\.set_supports\('boundary'\) or --supports boundary fixes the whole boundary/g, 'choose “Whole edge” under Supports'],
  [/a list of vertices as supports/g, 'with the tools Point and Side'],
  [/\(goals=\[Above\([^()]*\)\] prevents this\)/g, '(“Nothing lower than” prevents this)'],
  [/; try tolerance=([\d.e-]+)/g, '; try to fit it within $1 under Settings'],
  [/, as targets\b/g, ' with the sliders'],
  [/; install it: pip install '[^']*'/g, '; the administrator of the server can install it'],
];

const MINUS = /(?<=^|[\s(])-(?=\d)/g; // hyphens that are signs of numbers

/**
 * Return a message without terms for scripts and command lines.
 * @param {string} text
 * @returns {string}
 */
export function plain(text) {
  return SAID.reduce((said, [pattern, word]) => said.replace(pattern, word), text);
}

/**
 * Return a text with an initial capital.
 * @param {string} text
 * @returns {string}
 */
export function capitalised(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/**
 * Return a number with what it counts, such as “1 mould” or “2 moulds”.
 * @param {number} number
 * @param {string} what
 * @returns {string}
 */
export function counted(number, what) {
  return `${number} ${what}${number === 1 ? '' : 's'}`;
}

/**
 * Return a message with an initial capital and a full stop, in the terms of the page.
 * @param {string} text
 * @returns {string}
 */
export function capital(text) {
  const trimmed = plain(text).trim().replace(MINUS, '−');
  return capitalised(trimmed) + (/[.!?…]$/.test(trimmed) ? '' : '.');
}
