/** Level of detail of frames: without a graphics card a full frame takes 0.1 s, which would delay a moving surface. */

const SLOW = 40; // duration of full frames above which quick frames are drawn during motion [ms]
const SAMPLES = 3; // number of frames whose shortest duration counts
const REST = 250; // time without a new frame after which a full frame is drawn [ms]
const LULL = 1000; // the same while a surface is expected [ms]

/** Decides between full and quick frames. */
export class Pace {
  /** @param {() => void} redraw called after motion, to draw a full frame */
  constructor(redraw) {
    this.redraw = redraw;
    /** @type {number[]} */
    this.times = [];
    this.resting = false;
    this.timer = 0;
  }

  /** Whether full frames are too slow for motion. */
  get slow() {
    return this.times.length === SAMPLES && Math.min(...this.times) > SLOW;
  }

  /** Whether the next frame is quick. */
  get coarse() {
    return !this.resting && this.slow;
  }

  /**
   * Called before a frame: measures full frames, and schedules a full frame after a quick one.
   * @param {boolean} [expected] whether a surface is expected after this frame
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
    // This task runs after the browser has finished the frame.
    setTimeout(() => {
      this.times = [...this.times, performance.now() - started].slice(-SAMPLES);
    });
  }
}
