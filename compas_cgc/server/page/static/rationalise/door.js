/** The door to the dialog for freeform designs, whose modules are loaded when it is first used. */

/**
 * Return functions that open the dialog, and that offer files to it.
 * @param {HTMLDialogElement} dialog
 * @param {import('../api.js').Api} api
 * @param {{open: (data: import('../types.js').Data) => Promise<void>, say: (text: string) => void}} page shows roofs, and errors
 * @returns {{show: () => Promise<void>, offer: (file: File, dropped: boolean) => boolean}}
 */
export function rationaliseDoor(dialog, api, { open, say }) {
  const kinds = dialog.querySelector('input').dataset.designs.split(' ');
  /** @type {?Promise<import('./dialog.js').Rationaliser>} */
  let made = null;
  const enter = async (file) => {
    try {
      made ??= import('./dialog.js').then(({ Rationaliser }) => new Rationaliser(dialog, api, kinds, open));
      const rationaliser = await made;
      rationaliser.show();
      if (file) await rationaliser.take(file);
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
  };
}
