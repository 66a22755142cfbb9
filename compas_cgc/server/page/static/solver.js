/** One solve at a time: a new solve replaces the running one. */

import { Refusal, isLost, newId } from './api.js';

const LIVE_AFTER = 1000; // duration of a solve above which its steps are drawn [ms]
const POLL = 200; // milliseconds
const RETRY = 1000; // time between two attempts to reach the server [ms]

/**
 * @typedef {object} Listener what is told about a solve
 * @property {(status: import('./types.js').Status) => void} progress
 * @property {(xyz: Float32Array) => void} surface
 * @property {(xyz: Float64Array) => void} arrived the solved surface, before its verdict
 * @property {(said: import('./types.js').Judged) => void} judged its verdict, before it is measured
 * @property {(result: ?import('./types.js').Result, status: import('./types.js').Status) => void} done
 * @property {(message: string, remedies?: import('./types.js').Remedy[]) => void} failed
 * @property {() => void} lost the server does not respond
 */

/** Runs solves on the server and reports their progress. */
export class Solver {
  /**
   * @param {import('./api.js').Api} api
   * @param {Listener} listener
   */
  constructor(api, listener) {
    this.api = api;
    this.listener = listener;
    this.run = null;
    this.finished = null;
  }

  /** Whether a solve is running. */
  get busy() {
    return this.run !== null;
  }

  /** Milliseconds since the running solve began. */
  get age() {
    return this.run ? performance.now() - this.run.begin : 0;
  }

  /**
   * Solve; the job of the last solve is deleted when this one has ended.
   * @param {object} request
   */
  async solve(request) {
    this.stop();
    const run = { id: newId(), abort: new AbortController(), begin: performance.now(), fetching: false };
    this.run = run;
    try {
      const { status, result } = await this.follow(run, { ...request, id: run.id, live: true });
      if (this.run !== run) return;
      this.run = null;
      const before = this.finished;
      this.finished = result ? run.id : null;
      this.listener.done(result, status);
      if (before) this.forget(before);
    } catch (error) {
      if (this.run !== run) return;
      this.run = null;
      this.listener.failed(error.message, error.remedies);
    }
  }

  /** Stop the running solve, keeping its surface. */
  async cancel() {
    if (!this.run) return;
    try {
      await this.api.cancel(this.run.id);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (!isLost(error)) return;
      this.stop();
      this.listener.failed(error.message);
    }
  }

  /** Cancel the running solve. */
  stop() {
    if (!this.run) return;
    const { id, abort } = this.run;
    this.run = null;
    abort.abort();
    this.forget(id);
  }

  /** Cancel and delete all jobs. */
  reset() {
    this.stop();
    if (this.finished) this.forget(this.finished);
    this.finished = null;
  }

  forget(id) {
    // Ignore errors: the job may not exist.
    this.api.forget(id).catch(() => {});
  }

  /** Follow a job to its end, through cut connections and restarts of the server, and return its status and surface. */
  async follow(run, request) {
    for (;;) {
      try {
        // The same job again, as its id and its content are the same.
        return await this.once(run, request);
      } catch (error) {
        if (run.abort.signal.aborted || !isLost(error)) throw error;
        if (this.run === run) this.listener.lost();
        await new Promise((resolve) => setTimeout(resolve, RETRY));
      }
    }
  }

  async once(run, request) {
    let [status, result] = [null, null];
    for await (const told of this.api.solving(request, run.abort.signal)) {
      result = told.result ?? result;
      status = told.status ?? status;
      if (told.status) this.tell(run, status);
      if (told.arrived && this.run === run) this.listener.arrived(told.arrived);
      if (told.judged && this.run === run) this.listener.judged(told.judged);
    }
    // No stream was free, or it was interrupted.
    while (!isOver(status)) {
      if (status) await new Promise((resolve) => setTimeout(resolve, POLL));
      status = await this.api.status(run.id, run.abort.signal);
      this.tell(run, status);
    }
    if (status.has_result) result ??= await this.api.solved(run.id, run.abort.signal);
    return { status, result };
  }

  tell(run, status) {
    if (this.run !== run || isOver(status)) return;
    this.listener.progress(status);
    if (status.iteration > 0 && performance.now() - run.begin > LIVE_AFTER) this.watch(run);
  }

  async watch(run) {
    if (run.fetching) return;
    run.fetching = true;
    try {
      const xyz = await this.api.surface(run.id, run.abort.signal);
      if (xyz && this.run === run) this.listener.surface(xyz);
    } catch (error) {
      // The job may have been deleted.
      if (!(error instanceof Refusal) && error.name !== 'AbortError') throw error;
    } finally {
      run.fetching = false;
    }
  }
}

function isOver(status) {
  return status !== null && ['succeeded', 'failed', 'cancelled'].includes(status.state);
}
