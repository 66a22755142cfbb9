/** One slider and one number per region. */

import { regionColour } from './colours.js';
import { readable, roundAbove } from './numbers.js';

const STEPS = 200; // of a slider to each side of zero
const SNAP = 5; // steps around zero that are zero under a pointer

/** The rows of the regions, and one for all of them together. */
export class Regions {
  /**
   * @param {HTMLElement} room
   * @param {{change: () => void, over: (region: number) => void}} listener
   */
  constructor(room, listener) {
    this.room = room;
    this.listener = listener;
    this.rows = [];
    this.targets = [];
  }

  /**
   * Offer the regions of a model.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    this.model = model;
    this.targets = model.targets.slice();
    const regions = this.targets.map((_, region) => region);
    const alone = regions.length === 1;
    this.rows = regions.map((region) =>
      this.row(alone ? 'Surface' : `Region ${region}`, model.reach(region), regionColour(region), [region]),
    );
    if (!alone) {
      const reach = Math.max(...regions.map((region) => model.reach(region)));
      this.rows.unshift(this.row('All regions', reach, null, regions));
    }
    this.room.replaceChildren(...this.rows.map((row) => row.element));
    this.refresh();
  }

  /** Go back to the targets of the model. */
  reset() {
    this.targets = this.model.targets.slice();
    this.refresh();
  }

  /**
   * Bring the slider of a region into sight.
   * @param {number} region
   */
  focus(region) {
    const row = this.rows.find(({ regions }) => regions.length === 1 && regions[0] === region);
    row?.element.scrollIntoView({ block: 'nearest' });
    row?.slider.focus({ preventScroll: true });
  }

  row(name, size, colour, regions) {
    const reach = roundAbove(size);
    const element = document.createElement('div');
    const [dot, title, radius, slider, number] = ['i', 'span', 'span', 'input', 'input'].map((tag) => document.createElement(tag));
    element.className = 'region';
    if (colour) dot.style.background = colour;
    else dot.className = 'all';
    title.textContent = name;
    radius.className = 'radius';
    Object.assign(number, { type: 'number', step: 'any', ariaLabel: `K of ${name}` });
    Object.assign(slider, { type: 'range', min: -STEPS, max: STEPS, step: 1, ariaLabel: `K of ${name}` });
    element.append(dot, title, radius, slider, number);
    let pointed = false;
    slider.addEventListener('pointerdown', () => (pointed = true));
    slider.addEventListener('keydown', () => (pointed = false));
    slider.addEventListener('input', () => {
      const place = pointed && Math.abs(slider.value) < SNAP ? 0 : Number(slider.value);
      this.set(regions, Number(((place * reach) / STEPS).toPrecision(4)));
    });
    number.addEventListener('change', () => {
      if (number.value !== '' && Number.isFinite(number.valueAsNumber)) this.set(regions, number.valueAsNumber);
      else this.refresh();
    });
    const lit = regions.length === 1 ? regions[0] : -1;
    for (const name of ['pointerenter', 'focusin']) element.addEventListener(name, () => this.listener.over(lit));
    for (const name of ['pointerleave', 'focusout']) element.addEventListener(name, () => this.listener.over(-1));
    return { element, number, slider, radius, regions, reach };
  }

  set(regions, K) {
    for (const region of regions) this.targets[region] = K;
    this.refresh();
    this.listener.change();
  }

  refresh() {
    for (const { number, slider, radius, regions, reach } of this.rows) {
      const values = new Set(regions.map((region) => this.targets[region]));
      const [K] = values;
      const same = values.size === 1 && K !== null;
      number.value = same ? K : '';
      number.placeholder = same ? '' : 'various';
      if (same) slider.value = Math.round((K / reach) * STEPS);
      radius.textContent = same ? shape(K, this.model.unit) : 'various';
      slider.ariaValueText = same ? `${readable(K)}, ${radius.textContent}` : 'various';
    }
  }
}

function shape(K, unit) {
  if (K === 0) return 'unrolls flat';
  const radius = `${readable(1 / Math.sqrt(Math.abs(K)))}${unit ? ` ${unit}` : ''}`;
  return K > 0 ? `sphere, radius ${radius}` : `saddle, radii ± ${radius}`;
}
