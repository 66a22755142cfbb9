/** Designs kept in the browser, over a reload and from one day to the next. */

const NAME = 'compas_cgc';
const STORE = 'designs';
const TAB = 'compas_cgc.design';
const WAITS = 'compas_cgc.waits';
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
    this.take(this.id ?? crypto.getRandomValues(new Uint32Array(2)).join('-'));
    this.latest = { ...state, id: this.id, time: Date.now() };
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), 250);
  }

  /** Keep what waits. */
  async now() {
    clearTimeout(this.timer);
    const { latest } = this;
    if (!latest) return;
    await inStore('readwrite', (store) => store.put(latest)).catch(() => {});
    if (this.latest === latest) this.latest = null;
  }

  /** The page is being left, which nothing can put off: what is not in the store by now waits beside it. */
  hide() {
    sessionStorage.removeItem(WAITS);
    if (!this.latest) return;
    try {
      sessionStorage.setItem(WAITS, JSON.stringify(this.latest, (name, value) => (value instanceof File ? undefined : value)));
    } catch {
      // It is too large for that; the store may still get it.
    }
    this.now();
  }

  /** @returns {Promise<?import('../types.js').State>} what this tab has shown */
  async mine() {
    const waits = sessionStorage.getItem(WAITS);
    if (waits) {
      sessionStorage.removeItem(WAITS);
      const latest = JSON.parse(waits);
      const file = (await this.read(latest.id))?.data?.file;
      if (latest.data && file) latest.data.file = file;
      this.latest = latest;
      await this.now();
    }
    return this.id ? this.read(this.id) : null;
  }

  /** @param {string} id */
  async read(id) {
    return (await inStore('readonly', (store) => store.get(id)).catch(() => null)) ?? null;
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
