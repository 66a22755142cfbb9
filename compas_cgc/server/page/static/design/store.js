/** Records in the browser. */

/** Records by their id, with the time of their last change. Browsers without storage (private windows) are not an error. */
export class Store {
  /**
   * @param {string} database
   * @param {string} name
   * @param {number} most records that are kept
   */
  constructor(database, name, most) {
    this.database = database;
    this.name = name;
    this.most = most;
  }

  /** @returns {Promise<IDBDatabase>} */
  opened() {
    return new Promise((resolve, reject) => {
      const asked = indexedDB.open(this.database, 1);
      asked.onupgradeneeded = () => asked.result.createObjectStore(this.name, { keyPath: 'id' });
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
  async run(mode, act) {
    const database = await this.opened();
    try {
      return await new Promise((resolve, reject) => {
        const asked = act(database.transaction(this.name, mode).objectStore(this.name));
        asked.onsuccess = () => resolve(asked.result);
        asked.onerror = () => reject(asked.error);
      });
    } finally {
      database.close();
    }
  }

  /** @param {string} id */
  async read(id) {
    return (await this.run('readonly', (store) => store.get(id)).catch(() => null)) ?? null;
  }

  /** @returns {Promise<any[]>} all records, the newest first; the oldest of too many are deleted */
  async all() {
    const found = (await this.run('readonly', (store) => store.getAll()).catch(() => [])).sort((a, b) => b.time - a.time);
    for (const { id } of found.slice(this.most)) this.drop(id);
    return found.slice(0, this.most);
  }

  /** @param {string} id */
  async drop(id) {
    await this.run('readwrite', (store) => store.delete(id)).catch(() => {});
  }
}
