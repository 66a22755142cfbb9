/** When to solve while a slider moves. */

const PATIENCE = 700; // milliseconds after which a running solve is dropped for a newer one

/** Begins solves, not more often than they can be done. */
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

  /** Something has changed, maybe with others at once. A change does not put off the solve of the one before: the surface shall follow a slider that moves. */
  changed() {
    if (!this.timer) this.timer = setTimeout(() => this.soon());
  }

  /** A solve is over: go on with what has waited for it. */
  over() {
    if (this.waiting) this.now();
  }

  /** Drop what waits. */
  settle() {
    clearTimeout(this.timer);
    this.timer = 0;
    this.waiting = false;
  }

  soon() {
    this.waiting = this.solver.busy && this.solver.age < PATIENCE;
    if (this.waiting) this.timer = setTimeout(() => this.now(), PATIENCE - this.solver.age);
    else this.now();
  }

  now() {
    this.settle();
    this.solve();
  }
}
