/** Convergence of a solve: largest residual and energy by step. */
// @ts-nocheck: three.js and uPlot come without types.

import uPlot from './vendor/uplot/uPlot.esm.js';
import { power, readable } from './numbers.js';

const HEIGHT = 116;
const IDLE = 250; // time without a new solve after which the charts are drawn [ms]

/** A small plot of one quantity over the steps. */
class Chart {
  constructor(figure, logarithmic) {
    this.plot = null;
    this.room = figure.querySelector('.plot');
    this.now = figure.querySelector('output');
    this.logarithmic = logarithmic;
    this.data = [[], []];
    new ResizeObserver(() => this.plot?.setSize({ width: this.room.clientWidth, height: HEIGHT })).observe(this.room);
  }

  set(steps, values) {
    this.data = [steps, this.logarithmic ? values.map((value) => (value > 0 ? value : null)) : values];
    if (!this.plot) this.build();
    else this.plot.setData(this.data);
    this.say(null);
  }

  build() {
    this.plot?.destroy();
    const style = getComputedStyle(document.documentElement);
    const [ink, grid, line] = ['--muted', '--grid', '--accent'].map((name) => style.getPropertyValue(name).trim());
    const axis = { stroke: ink, font: '11px system-ui, sans-serif', grid: { stroke: grid, width: 1 }, ticks: { show: false } };
    this.plot = new uPlot(
      {
        width: this.room.clientWidth || 260,
        height: HEIGHT,
        padding: [8, 14, 0, 0],
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false }, points: { size: 6 } },
        scales: { x: { time: false }, y: this.logarithmic ? { distr: 3 } : {} },
        axes: [
          { ...axis, size: 22, gap: 2, space: 44, values: (_, splits) => splits.map((at) => (Number.isInteger(at) ? at : null)) },
          {
            ...axis,
            size: 46,
            gap: 4,
            space: 26,
            ...(this.logarithmic
              ? {
                  splits: (plot) => powers(plot.scales.y),
                  filter: (_, splits) => splits,
                  values: (_, splits) => splits.map((value) => power(Math.round(Math.log10(value)))),
                }
              : { values: (_, splits) => splits.map((value) => readable(value)) }),
          },
        ],
        series: [{}, { stroke: line, width: 1.6, points: { show: this.data[0].length < 2, size: 5 } }],
        hooks: { setCursor: [(plot) => this.say(plot.cursor.idx)] },
      },
      this.data,
      this.room,
    );
  }

  say(at) {
    const [steps, values] = this.data;
    const i = at ?? steps.length - 1;
    this.now.textContent = steps.length ? `step ${steps[i]}: ${readable(values[i])}` : '';
  }
}

/** Return up to four powers of ten in a range. */
function powers({ min, max }) {
  const [low, high] = [Math.ceil(Math.log10(min) - 1e-9), Math.floor(Math.log10(max) + 1e-9)];
  const every = Math.max(1, Math.ceil((high - low) / 3));
  return Array.from({ length: Math.max(0, Math.floor((high - low) / every)) + 1 }, (_, i) => 10 ** (high - i * every)).reverse();
}

/** Both plots. */
export class Charts {
  /**
   * @param {HTMLElement} error
   * @param {HTMLElement} energy
   */
  constructor(error, energy) {
    this.error = new Chart(error, true);
    this.energy = new Chart(energy, false);
    this.clear();
  }

  /** Clear the charts. */
  clear() {
    clearTimeout(this.timer);
    this.seen = { steps: [], error: [], energy: [] };
  }

  /**
   * Add a step of a running solve.
   * @param {object} status
   * @returns {boolean} whether there is something to be seen
   */
  add(status) {
    const { steps, error, energy } = this.seen;
    if (!status.iteration || status.error === null || status.iteration <= (steps.at(-1) ?? 0)) return steps.length > 1;
    steps.push(status.iteration);
    error.push(status.error);
    energy.push(status.energy);
    if (steps.length > 1) this.show(steps, error, energy);
    return steps.length > 1;
  }

  /**
   * Show the whole history.
   * @param {{max_error: number[], energy: number[]}} history of a result
   * @returns {boolean} whether there is something to be seen
   */
  end({ max_error: error, energy }) {
    const steps = error.map((_, i) => i + 1);
    // Drawing the charts while a slider moves would delay the surface.
    if (error.length) this.timer = setTimeout(() => this.show(steps, error, energy), this.error.plot ? IDLE : 0);
    return error.length > 0;
  }

  show(steps, error, energy) {
    this.error.set(steps, error);
    this.energy.set(steps, energy);
  }

  /** Update the colours from the style sheet. */
  dress() {
    for (const chart of [this.error, this.energy]) if (chart.plot) chart.build();
  }
}
