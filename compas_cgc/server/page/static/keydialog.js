/** Asks for the server's key. */

/**
 * Make a function that asks for the key.
 * @param {HTMLDialogElement} dialog
 * @returns {(again: boolean) => Promise<string>}
 */
export function keyDialog(dialog) {
  const field = dialog.querySelector('input');
  const text = dialog.querySelector('p');
  // Without a key nothing works, so there is nothing to go back to.
  dialog.addEventListener('cancel', (event) => event.preventDefault());
  return (again) => {
    text.textContent = again ? 'That was not it. Try once more.' : 'It was given when the server was started.';
    field.value = '';
    dialog.showModal();
    return new Promise((resolve) => {
      dialog.addEventListener('close', () => resolve(field.value), { once: true });
    });
  };
}
