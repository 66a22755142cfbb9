/** Results as files. */

const SUFFIXES = { compas: 'json' };

/**
 * Fetch a result and hand it to the browser as a file; a plain link could not send the key.
 * @param {import('./api.js').Api} api
 * @param {string} id of the job
 * @param {string} format
 * @param {import('./model.js').Model} model whose .3dm keeps all that is in it
 */
export async function download(api, id, format, model) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await api.download(id, format, format === '3dm' ? model.file : null));
  link.download = `${model.name} K.${SUFFIXES[format] ?? format}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
