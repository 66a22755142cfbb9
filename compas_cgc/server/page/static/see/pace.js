/** How finely frames are drawn: without a graphics card one takes a tenth of a second, and a surface that moves would wait for it. */

const SLOW = 40; // milliseconds; frames that take longer are drawn with fewer pixels while something moves
const SEEN = 3; // frames, of which the quickest tells
const REST = 250; // milliseconds without a new frame, after which the last one is drawn with all pixels

/** Decides with how many pixels a frame is drawn. */
export class Pace {
  /** @param {() => void} redraw called when all is still, to draw once more with all pixels */
  constructor(redraw) {
    this.redraw = redraw;
    /** @type {number[]} */
    this.times = [];
    this.resting = false;
    this.timer = 0;
  }

  /** Whether the next frame is drawn with half the pixels each way. */
  get coarse() {
    return !this.resting && this.times.length === SEEN && Math.min(...this.times) > SLOW;
  }

  /** A frame is about to be drawn: note how long it takes, and see to a fine one. */
  begin() {
    const { coarse } = this;
    clearTimeout(this.timer);
    this.resting = false;
    if (coarse) {
      this.timer = setTimeout(() => {
        this.resting = true;
        this.redraw();
      }, REST);
      return;
    }
    const started = performance.now();
    // What the browser does with a frame is over when it gets to this.
    setTimeout(() => {
      this.times = [...this.times, performance.now() - started].slice(-SEEN);
    });
  }
}
