/** Undo and redo: the earlier states of a design. */

const MERGE_TIME = 900; // time within which changes of the same value are merged [ms]
const MAX_STATES = 200;

/** The states of a design, as immutable plain data. */
export class History {
  /** @param {() => void} changed called whenever undo or redo becomes possible or impossible */
  constructor(changed) {
    this.changed = changed;
    /** @type {import('../types.js').State[]} */
    this.states = [];
    this.at = 0;
    this.last = { key: '', time: 0 };
  }

  /** @returns {?import('../types.js').State} the present state */
  get now() {
    return this.states[this.at] ?? null;
  }

  /** @returns {boolean} */
  get canUndo() {
    return this.at > 0;
  }

  /** @returns {boolean} */
  get canRedo() {
    return this.at < this.states.length - 1;
  }

  /**
   * Reset the history.
   * @param {import('../types.js').State} state
   */
  begin(state) {
    this.states = [state];
    this.at = 0;
    this.last = { key: '', time: 0 };
    this.changed();
  }

  /**
   * Continue a stored history.
   * @param {import('../types.js').State[]} states
   * @param {number} at
   */
  restore(states, at) {
    this.states = states;
    this.at = at;
    this.last = { key: '', time: 0 };
    this.changed();
  }

  /**
   * Add a state.
   * @param {import('../types.js').State} state
   * @param {string} [key] what has changed; consecutive changes with the same key are merged
   */
  push(state, key = '') {
    const time = performance.now();
    const same = key && key === this.last.key && time - this.last.time < MERGE_TIME && this.at > 0;
    this.states.length = this.at + 1;
    if (same) this.states[this.at] = state;
    else this.states.push(state);
    if (this.states.length > MAX_STATES) this.states.shift();
    this.at = this.states.length - 1;
    this.last = { key, time };
    this.changed();
  }

  /** @returns {?import('../types.js').State} the state before */
  undo() {
    return this.step(-1);
  }

  /** @returns {?import('../types.js').State} the state after */
  redo() {
    return this.step(1);
  }

  step(by) {
    if (!this.states[this.at + by]) return null;
    this.at += by;
    this.last.key = '';
    this.changed();
    return this.now;
  }
}
