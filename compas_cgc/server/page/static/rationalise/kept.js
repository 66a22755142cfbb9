/** What a tab keeps of the dialog for a reload of the page: the file, whose job goes on meanwhile, and its settings. */

import { newId } from '../api.js';
import { Store } from '../design/store.js';

const TAB = 'compas_cgc.rationalise';
const MAX_FILES = 4;
const files = new Store('compas_cgc.rationalise', 'files', MAX_FILES);

/** @typedef {{stored: string, open: boolean, job: ?{id: string, settings: object}}} Kept id of the file, whether the dialog was open, and the job */

/**
 * Store a file.
 * @param {File} file
 * @returns {Promise<?string>} its id; null in browsers without storage
 */
export async function storeFile(file) {
  const id = newId();
  const done = await files.run('readwrite', (store) => store.put({ id, file, time: Date.now() })).catch(() => null);
  await files.all();
  return done && id;
}

/**
 * @param {string} id
 * @returns {Promise<?File>}
 */
export async function storedFile(id) {
  return (await files.read(id))?.file ?? null;
}

/** @param {?Kept} kept null clears it */
export function keep(kept) {
  if (kept) sessionStorage.setItem(TAB, JSON.stringify(kept));
  else sessionStorage.removeItem(TAB);
}

/** @returns {?Kept} */
export function kept() {
  return JSON.parse(sessionStorage.getItem(TAB) ?? 'null');
}
