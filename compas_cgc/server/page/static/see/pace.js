/** How finely frames are drawn: without a graphics card one takes a tenth of a second, and a surface that moves would wait for it. */

const SLOW = 40; // milliseconds; where frames take longer, quick ones are drawn while something moves
const SEEN = 3; // frames, of which the quickest tells
const REST = 250; // milliseconds without a new frame, after which the last one is drawn finely
const LULL = 1000; // milliseconds, the same while a surface is expected

/** Decides whether a frame is drawn finely. */
export class Pace {
  /** @param {() => void} redraw called when all is still, to draw once more and finely */
  constructor(redraw) {
    this.redraw = redraw;
    /** @type {number[]} */
    this.times = [];
    this.resting = false;
    this.timer = 0;
  }

  /** Whether fine frames take too long to be drawn while something moves. */
  get slow() {
    return this.times.length === SEEN && Math.min(...this.times) > SLOW;
  }

  /** Whether the next frame is a quick one. */
  get coarse() {
    return !this.resting && this.slow;
  }

  /**
   * A frame is about to be drawn: note how long a fine one takes, and see to one after a quick one.
   * @param {boolean} [expected] whether a surface is on its way, to be drawn after this frame
   */
  begin(expected = false) {
    const { coarse } = this;
    clearTimeout(this.timer);
    this.resting = false;
    if (coarse) {
      const finely = () => {
        this.resting = true;
        this.redraw();
      };
      this.timer = setTimeout(finely, expected ? LULL : REST);
      return;
    }
    const started = performance.now();
    // What the browser does with a frame is over when it gets to this.
    setTimeout(() => {
      this.times = [...this.times, performance.now() - started].slice(-SEEN);
    });
  }
}
