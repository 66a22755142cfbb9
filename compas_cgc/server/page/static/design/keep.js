/** Designs kept in the browser, over a reload and from one day to the next. */

const NAME = 'compas_cgc';
const STORE = 'designs';
const TAB = 'compas_cgc.design';
const MOST = 12; // designs

/** @returns {Promise<IDBDatabase>} */
function opened() {
  return new Promise((resolve, reject) => {
    const asked = indexedDB.open(NAME, 1);
    asked.onupgradeneeded = () => asked.result.createObjectStore(STORE, { keyPath: 'id' });
    asked.onsuccess = () => resolve(asked.result);
    asked.onerror = () => reject(asked.error);
  });
}

/**
 * Do something in the store.
 * @param {IDBTransactionMode} mode
 * @param {(store: IDBObjectStore) => IDBRequest} act
 * @returns {Promise<any>}
 */
async function inStore(mode, act) {
  const database = await opened();
  try {
    return await new Promise((resolve, reject) => {
      const asked = act(database.transaction(STORE, mode).objectStore(STORE));
      asked.onsuccess = () => resolve(asked.result);
      asked.onerror = () => reject(asked.error);
    });
  } finally {
    database.close();
  }
}

/** What a tab shows is kept under a name of its own. A browser that keeps nothing (a private window) is no fault. */
export class Keep {
  constructor() {
    this.timer = 0;
    this.id = sessionStorage.getItem(TAB);
  }

  /**
   * Keep a state soon.
   * @param {import('../types.js').State} state
   */
  put(state) {
    this.latest = state;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), 250);
  }

  /** Keep what waits. */
  async now() {
    clearTimeout(this.timer);
    const { latest } = this;
    if (!latest) return;
    this.latest = null;
    this.id ??= crypto.getRandomValues(new Uint32Array(2)).join('-');
    sessionStorage.setItem(TAB, this.id);
    await inStore('readwrite', (store) => store.put({ ...latest, id: this.id, time: Date.now() })).catch(() => {});
  }

  /** @returns {Promise<?import('../types.js').State>} what this tab has shown */
  async mine() {
    if (!this.id) return null;
    return (await inStore('readonly', (store) => store.get(this.id)).catch(() => null)) ?? null;
  }

  /** @returns {Promise<import('../types.js').State[]>} all that is kept, the newest first; the oldest of too many are let go */
  async all() {
    const found = (await inStore('readonly', (store) => store.getAll()).catch(() => [])).sort((a, b) => b.time - a.time);
    for (const { id } of found.slice(MOST)) this.drop(id);
    return found.slice(0, MOST);
  }

  /** @param {string} id */
  async drop(id) {
    await inStore('readwrite', (store) => store.delete(id)).catch(() => {});
  }

  /** From now on something else is shown. */
  leave() {
    this.now();
    this.id = null;
    sessionStorage.removeItem(TAB);
  }

  /** @param {string} id of what this tab goes on with */
  take(id) {
    this.id = id;
    sessionStorage.setItem(TAB, id);
  }
}
