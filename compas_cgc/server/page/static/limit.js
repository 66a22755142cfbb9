/** The largest K that the supports carry, looked for by the server and marked on the sliders. */

import { capital } from './words.js';

const CLOSE = 0.05; // of the limit that is looked for; a mark on a slider is no finer

/** One search at a time. */
export class Limit {
  /**
   * @param {HTMLElement} said
   * @param {import('./api.js').Api} api
   * @param {import('./regions.js').Regions} regions
   * @param {() => any} request what a solve would ask for, with the goals of the model alone
   */
  constructor(said, api, regions, request) {
    this.said = said;
    this.api = api;
    this.regions = regions;
    this.request = request;
    /** @type {?AbortController} */
    this.search = null;
  }

  /** Forget what was found, as the supports are others. */
  clear() {
    this.search?.abort();
    this.regions.mark(null);
    this.said.hidden = true;
  }

  async find() {
    this.clear();
    const search = new AbortController();
    this.search = search;
    this.said.textContent = 'Looking for the largest K …';
    this.said.hidden = false;
    try {
      const { unknown, method, settings, ...problem } = this.request();
      const found = await this.api.build({ ...problem, task: 'limits', settings: { tolerance: CLOSE } }, search.signal);
      this.api.forget(found.id).catch(() => {});
      if (this.search !== search) return;
      this.regions.mark(found.status === 'found' ? this.regions.targets.map((K) => (K ? K * found.factor : null)) : null);
      this.said.textContent = capital(found.message);
    } catch (error) {
      if (error.name !== 'AbortError') this.said.textContent = capital(error.message);
    }
  }
}
