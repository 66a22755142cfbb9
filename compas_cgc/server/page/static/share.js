/** Saving of the design as a file or link, and of the view as a picture. */

import { asFragment, asText } from './design/packing.js';
import { hand } from './download.js';

/**
 * Connect the menu.
 * @param {HTMLDetailsElement} menu
 * @param {{state: () => import('./types.js').State, picture: () => Promise<?Blob>}} source
 */
export function shareMenu(menu, source) {
  const said = menu.querySelector('#share-said');
  const act = (id, work) => {
    menu.querySelector(id).addEventListener('click', async () => {
      try {
        said.textContent = await work(source.state());
      } catch (error) {
        said.textContent = error.message;
      }
    });
  };
  act('#save-file', (state) => {
    hand(new Blob([asText(state)], { type: 'application/json' }), `${state.name || 'Roof'}.json`);
    return 'Saved. Drop the file on this page to open it again.';
  });
  act('#save-link', async (state) => {
    const address = `${location.origin}${location.pathname}#design=${await asFragment(state)}`;
    try {
      await navigator.clipboard.writeText(address);
    } catch {
      // Without permission to copy, put the link into the address bar.
      history.replaceState(null, '', address);
      return 'The link is in the address bar. It contains the whole design.';
    }
    return `Link copied (${Math.ceil(address.length / 1000)},000 characters). It contains the whole design; nothing is stored elsewhere.`;
  });
  act('#save-picture', async (state) => {
    const picture = await source.picture();
    if (!picture) return 'There is no surface to show yet.';
    hand(picture, `${state.name || 'Roof'}.png`);
    return 'Saved.';
  });
  document.addEventListener('pointerdown', ({ target }) => {
    if (!menu.contains(/** @type {Node} */ (target))) menu.open = false;
  });
  menu.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape') return;
    menu.open = false;
    menu.querySelector('summary').focus();
  });
}
