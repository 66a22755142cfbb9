/** The largest feasible K for the supports, computed by the server and marked on the sliders. */

import { LOST } from './api.js';
import { capital } from './words.js';

const TOLERANCE = 0.05; // relative accuracy of the limit, comparable to the resolution of a slider

/** One search at a time. */
export class Limit {
  /**
   * @param {HTMLElement} said
   * @param {import('./api.js').Api} api
   * @param {import('./regions.js').Regions} regions
   * @param {() => any} request returns the request of a solve, with the goals of the model only
   */
  constructor(said, api, regions, request) {
    this.said = said;
    this.api = api;
    this.regions = regions;
    this.request = request;
    /** @type {?AbortController} */
    this.search = null;
  }

  /** Clear the result when the supports change. */
  clear() {
    this.search?.abort();
    this.regions.mark(null);
    this.said.hidden = true;
  }

  /** Search, and mark what is found. */
  async find() {
    this.clear();
    const search = new AbortController();
    this.search = search;
    this.said.textContent = 'Computing the largest feasible K …';
    this.said.hidden = false;
    try {
      const { unknown, method, settings, ...problem } = this.request();
      const found = await this.api.build({ ...problem, task: 'limits', settings: { tolerance: TOLERANCE } }, search.signal, {
        lost: () => this.search === search && (this.said.textContent = LOST),
      });
      this.api.forget(found.id).catch(() => {});
      if (this.search !== search) return;
      this.regions.mark(found.status === 'found' ? this.regions.targets.map((K) => (K ? K * found.factor : null)) : null);
      this.said.textContent = capital(found.message);
    } catch (error) {
      if (error.name !== 'AbortError') this.said.textContent = capital(error.message);
    }
  }
}
