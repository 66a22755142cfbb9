/** The door to the dialog for freeform designs, whose modules are loaded when it is first used. */

import { keep, kept } from './kept.js';

/**
 * Return functions that open the dialog, offer files to it, and go on with what this tab kept of it, or leave that.
 * @param {HTMLDialogElement} dialog
 * @param {import('../api.js').Api} api
 * @param {{open: (data: import('../types.js').Data) => Promise<void>, say: (text: string) => void}} page shows roofs, and errors
 * @returns {{show: () => Promise<void>, offer: (file: File, dropped: boolean) => boolean, resume: () => void, leave: () => void}}
 */
export function rationaliseDoor(dialog, api, { open, say }) {
  const kinds = dialog.querySelector('input').dataset.designs.split(' ');
  /** @type {?Promise<import('./dialog.js').Rationaliser>} */
  let made = null;
  let left = kept();
  // The page before deletes its job unless it is requested again.
  if (left?.job) api.status(left.job.id).catch(() => {});
  const leave = () => {
    if (left?.job) api.forget(left.job.id).catch(() => {});
    left = null;
    keep(null);
  };
  const enter = async (file) => {
    try {
      made ??= import('./dialog.js').then(({ Rationaliser }) => new Rationaliser(dialog, api, kinds, open));
      const rationaliser = await made;
      rationaliser.show();
      if (file) {
        leave();
        await rationaliser.take(file);
      } else if (left) {
        const before = left;
        left = null;
        await rationaliser.resume(before);
      }
    } catch (error) {
      say(error.message);
    }
  };
  return {
    show: () => enter(null),
    // Files that the page reads, too, are taken only where they were dropped on the open dialog.
    offer(file, dropped) {
      if (!dialog.open && (dropped || !kinds.includes(file.name.split('.').pop().toLowerCase()))) return false;
      enter(file);
      return true;
    },
    resume: () => left?.open && enter(null),
    leave,
  };
}
