/** Dialog for the key of the server. */

/**
 * Return a function that opens the dialog.
 * @param {HTMLDialogElement} dialog
 * @returns {(again: boolean) => Promise<string>}
 */
export function keyDialog(dialog) {
  const field = dialog.querySelector('input');
  const text = dialog.querySelector('p');
  // The dialog cannot be cancelled, as nothing works without a key.
  dialog.addEventListener('cancel', (event) => event.preventDefault());
  return (again) => {
    text.textContent = again ? 'The key is wrong. Try again.' : 'The key was set when the server was started.';
    field.value = '';
    dialog.showModal();
    return new Promise((resolve) => {
      dialog.addEventListener('close', () => resolve(field.value), { once: true });
    });
  };
}
