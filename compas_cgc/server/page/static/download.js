/** Results as files. */

const SUFFIXES = { compas: 'json' };

/**
 * Save a file with the browser.
 * @param {Blob} blob
 * @param {string} name
 */
export function hand(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/**
 * Fetch a result and save it as a file; a plain link could not send the key.
 * @param {import('./api.js').Api} api
 * @param {string} id of the job
 * @param {string} format
 * @param {import('./model.js').Model} model its .3dm file is the one into which the result is merged
 */
export async function download(api, id, format, model) {
  hand(await api.download(id, format, format === '3dm' ? model.file : null), `${model.name} K.${SUFFIXES[format] ?? format}`);
}
