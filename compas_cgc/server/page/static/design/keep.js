/** Storage of designs in the browser. */

const NAME = 'compas_cgc';
const STORE = 'designs';
const TAB = 'compas_cgc.design';
const WAITS = 'compas_cgc.waits';
const MAX_DESIGNS = 12;

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
 * Run a request on the store.
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

/** Each tab stores its design under a separate id. Browsers without storage (private windows) are not an error. */
export class Keep {
  constructor() {
    this.timer = 0;
    this.id = sessionStorage.getItem(TAB);
  }

  /**
   * Store a state after a short delay.
   * @param {import('../types.js').State} state
   */
  put(state) {
    this.take(this.id ?? crypto.getRandomValues(new Uint32Array(2)).join('-'));
    this.latest = { ...state, id: this.id, time: Date.now() };
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), 250);
  }

  /** Store the pending state. */
  async now() {
    clearTimeout(this.timer);
    const { latest } = this;
    if (!latest) return;
    await inStore('readwrite', (store) => store.put(latest)).catch(() => {});
    if (this.latest === latest) this.latest = null;
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
    for (const { id } of found.slice(MAX_DESIGNS)) this.drop(id);
    return found.slice(0, MAX_DESIGNS);
  }

  /** @param {string} id */
  async drop(id) {
    await inStore('readwrite', (store) => store.delete(id)).catch(() => {});
  }

  /** Another design is shown from now on. */
  leave() {
    this.now();
    this.id = null;
    sessionStorage.removeItem(TAB);
  }

  /** @param {string} id of the design that this tab continues */
  take(id) {
    this.id = id;
    sessionStorage.setItem(TAB, id);
  }
}
