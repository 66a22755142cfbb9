/** Sentences. */

/**
 * Return a sentence with a capital and a full stop.
 * @param {string} text
 * @returns {string}
 */
export function capital(text) {
  const trimmed = text.trim();
  return trimmed.charAt(0).toUpperCase() + trimmed.slice(1) + (/[.!?]$/.test(trimmed) ? '' : '.');
}
