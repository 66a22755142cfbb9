/** Scheduling of solves while a slider moves. */

const MAX_WAIT = 700; // time after which a running solve is cancelled for a newer one [ms]

/** Starts solves, at most one at a time. */
export class Rhythm {
  /**
   * @param {import('./solver.js').Solver} solver
   * @param {() => void} solve
   */
  constructor(solver, solve) {
    this.solver = solver;
    this.solve = solve;
    this.timer = 0;
    this.waiting = false;
  }

  /** Called at every change. A change does not delay the solve of the previous one, so that the surface follows a moving slider. */
  changed() {
    if (!this.timer) this.timer = setTimeout(() => this.soon());
  }

  /** A solve has ended: start the pending one. */
  over() {
    if (this.waiting) this.now();
  }

  /** Discard the pending solve. */
  settle() {
    clearTimeout(this.timer);
    this.timer = 0;
    this.waiting = false;
  }

  soon() {
    this.waiting = this.solver.busy && this.solver.age < MAX_WAIT;
    if (this.waiting) this.timer = setTimeout(() => this.now(), MAX_WAIT - this.solver.age);
    else this.now();
  }

  now() {
    this.settle();
    this.solve();
  }
}
