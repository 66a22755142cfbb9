/** Saving of the design as a file or link, and of the view as a picture. */

import { asFragment, asText, packed } from './design/packing.js';
import { hand } from './download.js';

/** Copy an address; without permission, put it into the address bar and return false. */
async function copied(address) {
  try {
    await navigator.clipboard.writeText(address);
    return true;
  } catch {
    history.replaceState(null, '', address);
    return false;
  }
}

/**
 * Connect the menu.
 * @param {HTMLDetailsElement} menu
 * @param {{state: () => import('./types.js').State, whole: () => any, api: import('./api.js').Api, picture: () => Promise<?Blob>}} source
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
    if (!(await copied(address))) return 'The link is in the address bar. It contains the whole design.';
    return `Link copied (${Math.ceil(address.length / 1000)},000 characters). It contains the whole design; nothing is stored elsewhere.`;
  });
  for (const mode of ['copy', 'view']) {
    act(`#share-${mode}`, async () => {
      const { api } = source;
      const { id, ...whole } = source.whole();
      const before = (await api.designs()).find((own) => own.id === id)?.revision ?? 0;
      await api.store(id, whole.name, await packed(whole), before);
      const { token } = await api.link(id, mode);
      const there = await copied(`${location.origin}${location.pathname}#shared=${token}`);
      return `${there ? 'Link copied.' : 'The link is in the address bar.'} Whoever has it can ${mode === 'copy' ? 'edit a copy' : 'view the design'}, until you revoke it.`;
    });
  }
  act('#revoke', async () => {
    const { id } = source.whole();
    const known = (await source.api.designs()).some((own) => own.id === id);
    const count = known ? await source.api.revoke(id) : 0;
    return count ? `${count} link${count === 1 ? '' : 's'} revoked.` : 'There are no links to this design.';
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
