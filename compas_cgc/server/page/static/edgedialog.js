/** Dialog for the edge length of the mesh of curves or surfaces. */

import { numberOf, showNumber } from './fields.js';

/**
 * Return a function that opens the dialog.
 * @param {HTMLDialogElement} dialog
 * @returns {(text: string) => Promise<?number>} null where there shall be none
 */
export function edgeDialog(dialog) {
  const field = dialog.querySelector('input');
  dialog.querySelector('#edge-cancel').addEventListener('click', () => dialog.close(''));
  return (text) => {
    dialog.querySelector('#edge-text').textContent = text;
    showNumber(field);
    dialog.returnValue = '';
    dialog.showModal();
    return new Promise((resolve) => {
      dialog.addEventListener('close', () => resolve(dialog.returnValue === 'go' && numberOf(field) > 0 ? numberOf(field) : null), { once: true });
    });
  };
}
