/** Requests of the page to the server. The page contacts no other server. */

import { unpack } from './packed.js';
import { capital } from './words.js';

/** What is said while the server does not respond. */
export const LOST = 'The server does not respond. Trying again …';
const KEY = 'compas_cgc.key';
const RETRY = 1000; // time between two attempts to reach the server [ms]
const [SHOWN, WAIT] = [0.5, 20]; // time between two requests for the status of a job with and without a display [s]

/**
 * @typedef {object} Told who is told about a job
 * @property {string} [id] of the job: a new one, or that of a job that was submitted before
 * @property {(status: import('./types.js').Status) => void} [progress]
 * @property {() => void} [lost] the server does not respond
 */

/** An error response of the server. */
export class Refusal extends Error {
  /**
   * @param {number} status HTTP status; 0 if there was no response
   * @param {string} message one sentence
   * @param {import('./types.js').Remedy[]} [remedies] that the message names
   */
  constructor(status, message, remedies = []) {
    super(message);
    this.status = status;
    this.remedies = remedies;
  }
}

/** The server's addresses as functions. */
export class Api {
  /** @param {(again: boolean) => Promise<string>} askForKey called when the server requires a key */
  constructor(askForKey) {
    this.askForKey = askForKey;
    this.asking = null;
  }

  /** @returns {Promise<import('./types.js').Method[]>} the methods, each option as a JSON schema */
  async methods() {
    return (await this.json('api/v1/methods')).methods;
  }

  /** @returns {Promise<{name: string, title: string, text: string}[]>} */
  async examples() {
    return (await this.json('api/v1/examples')).examples;
  }

  /** @param {string} name */
  example(name) {
    return this.json(`api/v1/examples/${encodeURIComponent(name)}`);
  }

  /**
   * @param {File} file
   * @param {string} kind of file
   * @param {?number} [edge] edge length of the mesh of curves or surfaces
   */
  model(file, kind, edge) {
    const name = file.name.replace(/\.[^.]*$/, '');
    const length = edge ? `&edge_length=${edge}` : '';
    return this.json(`api/v1/models?kind=${kind}&name=${encodeURIComponent(name)}${length}`, { method: 'POST', body: file });
  }

  /**
   * Read the curves and points of a drawing.
   * @param {File} file
   * @param {string} kind of file: dxf or 3dm
   * @returns {Promise<import('./draw/plan.js').Plan>}
   */
  async plan(file, kind) {
    const { unit, lines, columns, notes } = await this.json(`api/v1/plans?kind=${kind}`, { method: 'POST', body: file });
    const flat = lines.map(({ points, circle, ...line }) => ({ ...line, points: points.map(([x, y]) => [x, y]), held: [], ...(circle && { circle }) }));
    return { unit, edge: null, lines: flat, columns, notes };
  }

  /**
   * Return the surface of a freeform design as a mesh, with what is drawn beside it.
   * @param {File} file
   * @param {string} kind of file
   * @returns {Promise<{unit: string, vertices: number[][], faces: number[][], smooth: boolean, supports: number[][][], seams: number[][][], notes: string[]}>}
   */
  freeform(file, kind) {
    return this.json(`api/v1/surfaces?kind=${kind}`, { method: 'POST', body: file });
  }

  /**
   * Request the mesh of a drawing.
   * @param {object} sketch
   */
  drawing(sketch) {
    return this.json('api/v1/drawings', { method: 'POST', body: JSON.stringify(sketch) });
  }

  /**
   * Return the curvatures of a surface, per vertex; NaN where no K is prescribed.
   * @param {object} surface request of a solve with the vertices of the surface
   * @returns {Promise<import('./types.js').Curvatures>}
   */
  async curvatures(surface) {
    const found = await this.json('api/v1/curvatures', { method: 'POST', body: JSON.stringify(surface) });
    return /** @type {any} */ (Object.fromEntries(Object.entries(found).map(([name, values]) => [name, unpack(values)])));
  }

  /** @returns {Promise<import('./types.js').Method[]>} what is built of solved surfaces */
  async tasks() {
    return (await this.json('api/v1/tasks')).tasks;
  }

  /**
   * Run a job to its end and return its result; an abort stops the job.
   * @param {object} job
   * @param {AbortSignal} signal
   * @param {Told} [told]
   * @returns {Promise<any>}
   */
  build(job, signal, told) {
    return this.follow((id) => this.json('api/v1/jobs', { method: 'POST', body: JSON.stringify({ ...job, id }) }), signal, told);
  }

  /**
   * Run a job on a file, as `build` does.
   * @param {File} file
   * @param {string} kind of file
   * @param {object} options
   * @param {AbortSignal} signal
   * @param {Told} [told]
   * @returns {Promise<any>}
   */
  buildFrom(file, kind, options, signal, told) {
    const path = (id) => `api/v1/jobs?kind=${kind}&options=${encodeURIComponent(JSON.stringify({ ...options, id }))}`;
    return this.follow((id) => this.json(path(id), { method: 'POST', body: file }), signal, told);
  }

  /**
   * Follow a job to its end, through cut connections and restarts of the server.
   * @param {(id: string) => Promise<any>} submit
   * @param {AbortSignal} signal
   * @param {Told} [told]
   * @returns {Promise<any>} its result
   */
  async follow(submit, signal, { id = newId(), progress, lost } = {}) {
    try {
      for (;;) {
        try {
          // The same job again, as its id and its content are the same. An aborted request could still
          // become a job after its deletion: it is completed first.
          await submit(id);
          signal.throwIfAborted();
          return { ...(await this.finished(id, signal, progress)), id };
        } catch (error) {
          if (signal.aborted || !isLost(error)) throw error;
          lost?.();
          await new Promise((resolve) => setTimeout(resolve, RETRY));
        }
      }
    } catch (error) {
      this.forget(id).catch(() => {});
      throw error;
    }
  }

  /** Wait for the end of a job, and return its result. */
  async finished(id, signal, progress) {
    for (;;) {
      const status = await this.json(`api/v1/jobs/${id}?wait=${progress ? SHOWN : WAIT}`, { signal });
      if (status.has_result) return this.result(id, signal);
      if (['succeeded', 'failed', 'cancelled'].includes(status.state)) throw new Refusal(422, status.message, status.remedies);
      progress?.(status);
    }
  }

  /**
   * @param {string} id
   * @param {AbortSignal} [signal]
   */
  status(id, signal) {
    return this.json(`api/v1/jobs/${id}`, { signal });
  }

  /** @param {string} id */
  cancel(id) {
    return this.json(`api/v1/jobs/${id}/cancel`, { method: 'POST' });
  }

  /**
   * Stop and delete a job; also works while the page is closing.
   * @param {string} id
   * @param {number} [after] time within which any other request for the job revokes this [s]
   */
  async forget(id, after = 0) {
    await this.request(`api/v1/jobs/${id}${after ? `?after=${after}` : ''}`, { method: 'DELETE', keepalive: true });
  }

  /**
   * @param {string} id
   * @param {AbortSignal} [signal]
   */
  result(id, signal) {
    return this.json(`api/v1/jobs/${id}/result?format=arrays`, { signal });
  }

  /**
   * Return a solved surface, its arrays as arrays of numbers: xyz, targets and curvature (NaN where undefined).
   * @param {string} id
   * @param {AbortSignal} [signal]
   */
  async solved(id, signal) {
    return surfaceOf(await this.json(`api/v1/jobs/${id}/result?format=packed`, { signal }));
  }

  /**
   * @param {string} id
   * @param {string} format
   * @param {?File} beside the .3dm file into which the result is merged
   * @returns {Promise<Blob>}
   */
  async download(id, format, beside) {
    const options = beside ? { method: 'POST', body: beside } : {};
    return (await this.request(`api/v1/jobs/${id}/result?format=${format}`, options)).blob();
  }

  /**
   * @param {string} id
   * @param {AbortSignal} signal
   * @returns {Promise<?Float32Array>} null where nothing moves
   */
  async surface(id, signal) {
    const answer = await this.request(`api/v1/jobs/${id}/surface`, { signal });
    return answer.status === 204 ? null : new Float32Array(await answer.arrayBuffer());
  }

  /**
   * Solve with a single request, and yield the status of the job, the surface before its verdict, the verdict, and the result;
   * yields nothing if no stream is free.
   * @param {object} job
   * @param {AbortSignal} signal
   * @returns {AsyncGenerator<{status?: import('./types.js').Status, arrived?: Float64Array, judged?: import('./types.js').Judged, result?: import('./types.js').Result}>}
   */
  async *solving(job, signal) {
    const answer = await this.request('api/v1/jobs?follow=true', { method: 'POST', body: JSON.stringify(job), signal });
    if (!answer.headers.get('Content-Type').startsWith('text/event-stream')) return;
    for await (const { event, data } of eventsOf(answer)) yield toldBy(event, data);
  }

  /** @returns {Promise<{id: string, revision: number}[]>} the designs on the server */
  async designs() {
    return (await this.json('api/v1/designs')).designs;
  }

  /**
   * Store a design on the server.
   * @param {string} id
   * @param {string} name
   * @param {Uint8Array} content
   * @param {number} revision that it replaces, 0 for a new one
   */
  store(id, name, content, revision) {
    const headers = revision ? { 'If-Match': `"${revision}"` } : {};
    return this.json(`api/v1/designs/${id}?name=${encodeURIComponent(name)}`, { method: 'PUT', body: /** @type {any} */ (content), headers });
  }

  /**
   * Create a link to a design on the server.
   * @param {string} id
   * @param {string} mode copy or view
   * @returns {Promise<{id: string, token: string}>}
   */
  link(id, mode) {
    return this.json(`api/v1/designs/${id}/links`, { method: 'POST', body: JSON.stringify({ mode }) });
  }

  /**
   * Delete all links to a design on the server.
   * @param {string} id
   * @returns {Promise<number>} how many
   */
  async revoke(id) {
    const { links } = await this.json(`api/v1/designs/${id}/links`);
    for (const link of links) await this.request(`api/v1/designs/${id}/links/${link.id}`, { method: 'DELETE' });
    return links.length;
  }

  /**
   * Return the design of a link.
   * @param {string} token
   */
  async shared(token) {
    const answer = await this.request(`api/v1/shared/${encodeURIComponent(token)}`);
    return { content: new Uint8Array(await answer.arrayBuffer()), mode: answer.headers.get('CGC-Mode') };
  }

  /**
   * @param {string} path
   * @param {RequestInit} [options]
   */
  async json(path, options) {
    return (await this.request(path, options)).json();
  }

  /**
   * Send a request with the key, and ask the user for the key if it is missing or wrong.
   * @param {string} path
   * @param {RequestInit} [options]
   * @returns {Promise<Response>}
   */
  async request(path, options = {}) {
    for (;;) {
      const key = sessionStorage.getItem(KEY);
      const headers = { ...options.headers, ...(key ? { Authorization: `Bearer ${key}` } : {}) };
      let answer;
      try {
        answer = await fetch(path, { ...options, headers });
      } catch (error) {
        if (error.name === 'AbortError') throw error;
        throw new Refusal(0, 'The server does not respond. Check that it is running, then try again.');
      }
      if (answer.ok) return answer;
      if (answer.status !== 401) throw await refusalOf(answer);
      if (sessionStorage.getItem(KEY) === key) await this.newKey(key !== null);
    }
  }

  async newKey(again) {
    this.asking ??= this.askForKey(again).finally(() => {
      this.asking = null;
    });
    sessionStorage.setItem(KEY, await this.asking);
  }
}

/**
 * Check whether an error of a request that the page has not aborted means that the server did not respond, and may later. Firefox aborts
 * requests when the page is left.
 * @param {Error} error
 * @returns {boolean}
 */
export function isLost(error) {
  return error instanceof Refusal ? [0, 502, 503, 504].includes(error.status) : error instanceof TypeError || error.name === 'AbortError';
}

/**
 * Return the id of a new job.
 * @returns {string}
 */
export function newId() {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** Yield the events of a stream. EventSource cannot send a key or a request body. */
async function* eventsOf(answer) {
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = '';
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    // A surface arrives in many pieces: search only the new piece for the end.
    let from = Math.max(0, text.length - 1);
    text += value;
    for (let end = text.indexOf('\n\n', from); end >= 0; end = text.indexOf('\n\n', from)) {
      const fields = text.slice(0, end).split('\n');
      const field = (name) => fields.find((line) => line.startsWith(`${name}: `))?.slice(name.length + 2);
      if (field('data')) yield { event: field('event'), data: JSON.parse(field('data')) };
      text = text.slice(end + 2);
      from = 0;
    }
  }
}

/** @returns {{status?: import('./types.js').Status, arrived?: Float64Array, judged?: import('./types.js').Judged, result?: import('./types.js').Result}} */
function toldBy(event, data) {
  if (event === 'surface') return { arrived: Float64Array.from(unpack(data.vertices)) };
  if (event === 'verdict') return { judged: data };
  return event === 'result' ? { result: surfaceOf(data) } : { status: data };
}

function surfaceOf(found) {
  const faces = found.turned ? unpack(found.faces) : undefined;
  return { ...found, faces, xyz: unpack(found.vertices), targets: unpack(found.targets), curvature: unpack(found.curvature) };
}

async function refusalOf(answer) {
  try {
    const { message, remedies } = await answer.json();
    return new Refusal(answer.status, capital(message), remedies);
  } catch {
    return new Refusal(answer.status, `The server responded with status ${answer.status} and no message.`);
  }
}
