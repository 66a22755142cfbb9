/** The jobs of one design on the server. */

import { newId } from '../api.js';

/** @typedef {any} Told result of a rationalisation: its report, and the surface with its panels */
/** @typedef {{file: File, kind: string, name: string, stored: ?string, surface: any}} Design with the id under which its file is stored */

/** One job runs at a time. Results are kept by their settings, until the design is left. */
export class Jobs {
  /** @param {import('../api.js').Api} api */
  constructor(api) {
    this.api = api;
    /** @type {Map<string, Told>} */
    this.results = new Map();
    /** @type {Set<string>} ids of all jobs with a result; that of a job that was stopped is not kept */
    this.ids = new Set();
    /** @type {?{id: string, settings: object, abort: AbortController}} */
    this.run = null;
    this.stopped = false; // whether the last job was stopped
  }

  /**
   * Return the result of settings.
   * @param {object} settings
   * @returns {Told | undefined}
   */
  known(settings) {
    return this.results.get(JSON.stringify(settings));
  }

  /**
   * Run a job to its end, in the place of the running one.
   * @param {Design} design
   * @param {object} settings
   * @param {string | undefined} id of a job that was submitted before
   * @param {{progress: (status: any) => void, lost: () => void}} told
   * @returns {Promise<?Told>} null if another job took its place, or it was given up
   */
  async start({ file, kind, name }, settings, id, { progress, lost }) {
    this.halt();
    const run = { id: id ?? newId(), settings, abort: new AbortController() };
    const runs = () => this.run === run;
    [this.run, this.stopped] = [run, false];
    const options = { task: 'rationalise', name: name.slice(0, 100), settings };
    try {
      const told = await this.api.buildFrom(file, kind, options, run.abort.signal, {
        id: run.id,
        progress: (status) => runs() && progress(status),
        lost: () => runs() && lost(),
      });
      if (!runs()) return null;
      this.ids.add(told.id);
      // One that was stopped is not the result of its settings.
      if (told.status !== 'cancelled') this.results.set(JSON.stringify(settings), told);
      return told;
    } catch (error) {
      if (!runs()) return null;
      throw error;
    } finally {
      if (runs()) this.run = null;
    }
  }

  /**
   * Stop the running job with its best surface so far.
   * @returns {Promise<boolean>} false if it has ended meanwhile, or the server does not respond
   */
  async stop() {
    if (!this.run) return false;
    this.stopped = true;
    return this.api.cancel(this.run.id).then(
      () => true,
      () => false,
    );
  }

  /** Give up the running job. */
  halt() {
    this.run?.abort.abort();
    this.run = null;
  }

  /**
   * Return id and settings of the running job, or else of a result.
   * @param {?Told} told
   * @returns {?{id: string, settings: object}}
   */
  last(told) {
    if (this.run) return { id: this.run.id, settings: this.run.settings };
    const settings = [...this.results].find(([, own]) => own === told)?.[0];
    return settings ? { id: told.id, settings: JSON.parse(settings) } : null;
  }

  /**
   * Delete all results on the server.
   * @param {string} [but] id of the job that stays
   */
  forget(but) {
    for (const id of this.ids) if (id !== but) this.api.forget(id).catch(() => {});
    this.ids.clear();
    this.results.clear();
  }

  /**
   * Return the largest distances by number of moulds, of results with given settings but for this number.
   * @param {object} settings
   */
  distances(settings) {
    const rest = (/** @type {any} */ { moulds, within, ...own }) => JSON.stringify(own);
    const found = [...this.results].map(([key, told]) => ({ settings: JSON.parse(key), told }));
    const alike = found.filter((own) => rest(own.settings) === rest(settings));
    return new Map(alike.map((own) => [own.settings.moulds ?? own.told.moulds, own.told.distance.max]));
  }
}
