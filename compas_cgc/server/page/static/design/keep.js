/** Storage of designs in the browser. */

import { Store } from './store.js';

const TAB = 'compas_cgc.design';
const WAITS = 'compas_cgc.waits';
const MAX_DESIGNS = 12;
const designs = new Store('compas_cgc', 'designs', MAX_DESIGNS);

function newId() {
  return crypto.getRandomValues(new Uint32Array(2)).join('-');
}

/**
 * Store a state, under a new id if another tab has changed the design since.
 * @param {any} state with the revision `base` that it follows
 * @returns {Promise<{id: string, revision: number}>} what is stored
 */
async function written({ base, ...state }) {
  const database = await designs.opened();
  try {
    return await new Promise((resolve, reject) => {
      const transaction = database.transaction(designs.name, 'readwrite');
      const store = transaction.objectStore(designs.name);
      const asked = store.get(state.id);
      let stored = null;
      asked.onsuccess = () => {
        const found = asked.result;
        // The same state may have been stored while the page was closing.
        const foreign = found && (found.revision ?? 0) !== base && found.time !== state.time;
        stored = { ...state, id: foreign ? newId() : state.id, revision: foreign ? 1 : (found?.revision ?? 0) + 1 };
        store.put(stored);
      };
      transaction.oncomplete = () => resolve(stored);
      transaction.onabort = () => reject(transaction.error);
      transaction.onerror = () => reject(transaction.error);
    });
  } finally {
    database.close();
  }
}

/**
 * Each tab stores its design under a separate id. If two tabs have the same one, the second to change it goes on under a new id, so that
 * no change is lost.
 */
export class Keep {
  constructor() {
    this.timer = 0;
    this.id = sessionStorage.getItem(TAB);
    this.revision = 0; // of the design as this tab knows it
    /** @type {() => object} what is stored beside the state, when it is stored */
    this.more = () => ({});
    this.parted = () => {}; // called when the design goes on under a new id
  }

  /**
   * Store a state after a short delay.
   * @param {import('../types.js').State} state
   */
  put(state) {
    if (!this.id) this.take(newId(), 0);
    this.latest = { ...state, id: this.id, time: Date.now(), base: this.revision };
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), 250);
  }

  /** Store the pending state. */
  async now() {
    clearTimeout(this.timer);
    const { latest } = this;
    if (!latest) return;
    this.latest = null;
    const stored = await written({ ...this.more(), ...latest, base: Math.max(latest.base, this.revision) }).catch(() => null);
    // Another design may be shown meanwhile.
    if (!stored || this.id !== latest.id) return;
    this.take(stored.id, stored.revision);
    if (stored.id === latest.id) return;
    if (this.latest) Object.assign(this.latest, { id: stored.id, base: stored.revision });
    this.parted();
  }

  /** The page is closing, so asynchronous storage may not finish: store the pending state in the session storage. */
  hide() {
    sessionStorage.removeItem(WAITS);
    if (!this.latest) return;
    try {
      sessionStorage.setItem(WAITS, JSON.stringify(this.latest, (name, value) => (value instanceof File ? undefined : value)));
    } catch {
      // The state is too large for that; the store may still finish.
    }
    this.now();
  }

  /** @returns {Promise<import('../types.js').State[]>} all that is kept, the newest first */
  all() {
    return designs.all();
  }

  /** @param {string} id */
  drop(id) {
    return designs.drop(id);
  }

  /** @returns {Promise<?import('../types.js').State>} what this tab has shown */
  async mine() {
    const waits = sessionStorage.getItem(WAITS);
    if (waits) {
      sessionStorage.removeItem(WAITS);
      const latest = JSON.parse(waits);
      const file = (await designs.read(latest.id))?.data?.file;
      if (latest.data && file) latest.data.file = file;
      this.latest = latest;
      this.revision = latest.base;
      await this.now();
    }
    const found = this.id ? await designs.read(this.id) : null;
    this.revision = found?.revision ?? 0;
    return found;
  }

  /** Another design is shown from now on. */
  leave() {
    this.now();
    this.id = null;
    this.revision = 0;
    sessionStorage.removeItem(TAB);
  }

  /**
   * @param {string} id of the design that this tab continues
   * @param {number} [revision]
   */
  take(id, revision = 0) {
    this.id = id;
    this.revision = revision;
    sessionStorage.setItem(TAB, id);
  }
}
