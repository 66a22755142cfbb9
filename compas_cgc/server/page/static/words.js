/** Sentences. */

/**
 * Return a text with a capital.
 * @param {string} text
 * @returns {string}
 */
export function capitalised(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/**
 * Return a sentence with a capital and a full stop.
 * @param {string} text
 * @returns {string}
 */
export function capital(text) {
  const trimmed = text.trim();
  return capitalised(trimmed) + (/[.!?]$/.test(trimmed) ? '' : '.');
}
