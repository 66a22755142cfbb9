/** One slider and one number per region; many regions are grouped by their targets. */

import { asNumberField, numberOf, showNumber } from './fields.js';
import { readable, roundAbove } from './numbers.js';

const STEPS = 200; // steps of a slider on each side of zero
const SNAP = 5; // steps around zero that snap to zero under a pointer
const FITTING = 8; // characters that fit into a field
const MANY = 12; // number of regions above which they are grouped

/** The rows of the regions, and one for all of them together. */
export class Regions {
  /**
   * @param {HTMLElement} room
   * @param {{change: (key: string, held: boolean) => void, release: () => void, over: (regions: number[]) => void, law: (region: number, law: string) => void, name: (region: number, name: string) => void, colour: (region: number, colour: string) => void}} listener
   */
  constructor(room, listener) {
    this.room = room;
    this.listener = listener;
    this.rows = [];
    this.targets = [];
    this.limit = null;
    /** Last value and proportions of a slider for several regions, which are needed when it is at zero. */
    this.led = { regions: [], shares: [], given: '' };
  }

  /**
   * Show the regions of a model.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    const open = new Set([...this.room.querySelectorAll('details[open]')].map((each) => each.dataset.group));
    this.model = model;
    this.targets = model.targets.slice();
    this.rows = [];
    const regions = this.targets.map((_, region) => region);
    const parts = [];
    const add = (row) => {
      this.rows.push(row);
      return row.element;
    };
    const single = (region) => this.row(model.nameOf(region), model.reach(region), model.colourOf(region), [region]);
    if (regions.length > 1) parts.push(add(this.row('All regions', Math.max(...regions.map((region) => model.reach(region))), null, regions)));
    if (regions.length <= MANY) parts.push(...regions.map((region) => add(single(region))));
    else {
      for (const group of this.groups()) {
        if (group.length === 1) {
          parts.push(add(single(group[0])));
          continue;
        }
        const box = document.createElement('details');
        box.dataset.group = String(group[0]);
        box.open = open.has(box.dataset.group);
        const more = document.createElement('summary');
        more.textContent = 'Individual regions';
        const head = add(this.row(`${group.length} regions`, Math.max(...group.map((region) => model.reach(region))), model.colourOf(group[0]), group));
        box.append(more, ...group.map((region) => add(single(region))));
        parts.push(head, box);
      }
    }
    this.room.replaceChildren(...parts);
    this.refresh();
  }

  /** Return groups of regions: by K and approximate area, or else by K, or else one group. */
  groups() {
    const { areas } = this.model;
    const keys = [(K, region) => `${K} ${areas[region].toPrecision(2)}`, (K) => String(K), () => ''];
    for (const key of keys) {
      const found = new Map();
      this.targets.forEach((K, region) => found.set(key(K, region), [...(found.get(key(K, region)) ?? []), region]));
      if (found.size <= MANY) return [...found.values()];
    }
    return [];
  }

  /**
   * Set the targets without notifying the listener.
   * @param {(?number)[]} targets
   */
  set(targets) {
    this.targets = targets.slice();
    this.refresh();
  }

  /**
   * Mark the largest feasible K.
   * @param {?(?number)[]} targets per region, null to remove the marks
   */
  mark(targets) {
    this.limit = targets;
    this.refresh();
  }

  /**
   * Set whether K is given or unknown.
   * @param {boolean} follows
   */
  follow(follows) {
    this.room.classList.toggle('follows', follows);
    for (const { slider, number, regions } of this.rows) slider.disabled = number.disabled = follows || this.hasLaw(regions);
    this.refresh();
  }

  /**
   * Scroll to the slider of a region.
   * @param {number} region
   */
  focus(region) {
    const row = this.rows.find(({ regions }) => regions.length === 1 && regions[0] === region);
    row?.element.closest('details')?.setAttribute('open', '');
    row?.element.scrollIntoView({ block: 'nearest' });
    row?.slider.focus({ preventScroll: true });
  }

  row(name, size, colour, regions) {
    const reach = roundAbove(size);
    const element = document.createElement('div');
    const [radius, slider, number, mark] = ['span', 'input', 'input', 'b'].map((tag) => document.createElement(tag));
    const one = regions.length === 1 ? regions[0] : -1;
    element.className = 'region';
    radius.className = 'radius';
    mark.className = 'carry';
    asNumberField(number, { ariaLabel: `K of ${name}` });
    Object.assign(slider, { type: 'range', min: -STEPS, max: STEPS, step: 1, ariaLabel: `K of ${name}` });
    const track = document.createElement('span');
    track.className = 'track';
    track.append(slider, mark);
    const law = one >= 0 ? this.lawField(one, name) : null;
    element.append(one >= 0 ? this.swatch(one, name, colour) : plainDot(colour), one >= 0 ? this.title(one, name) : plainTitle(name), radius, track, number, ...(law ? [law] : []));
    let pointed = false;
    slider.addEventListener('pointerdown', () => (pointed = true));
    slider.addEventListener('keydown', () => (pointed = false));
    slider.addEventListener('input', () => {
      const place = pointed && Math.abs(slider.value) < SNAP ? 0 : Number(slider.value);
      this.lead(regions, (place * reach) / STEPS);
    });
    // A slider released at its initial value has not changed.
    for (const event of ['change', 'pointerup', 'pointercancel']) slider.addEventListener(event, () => this.listener.release());
    number.addEventListener('change', () => {
      if (Number.isFinite(numberOf(number))) this.give(regions, numberOf(number));
      else this.refresh();
    });
    const lit = regions.length < this.targets.length ? regions : [];
    for (const event of ['pointerenter', 'focusin']) element.addEventListener(event, () => this.listener.over(lit));
    for (const event of ['pointerleave', 'focusout']) element.addEventListener(event, () => this.listener.over([]));
    return { element, number, slider, radius, mark, regions, reach };
  }

  lawField(region, name) {
    const field = document.createElement('input');
    const title = 'Law of this region: empty for constant K; minimal, H = 0.1 or 2 H + 0.5 K = 0.3, with the mean curvature H';
    const value = this.model.laws[region] ?? '';
    Object.assign(field, { type: 'text', className: 'law', value, placeholder: 'constant K', ariaLabel: `Law of ${name}`, maxLength: 60, title });
    field.addEventListener('change', () => this.listener.law(region, field.value));
    return field;
  }

  /** Whether a row is that of one region with a law other than constant K. */
  hasLaw(regions) {
    return regions.length === 1 && Boolean(this.model.laws[regions[0]]);
  }

  swatch(region, name, colour) {
    const label = document.createElement('label');
    const field = document.createElement('input');
    label.className = 'swatch';
    label.style.background = colour;
    Object.assign(field, { type: 'color', value: colour, ariaLabel: `Colour of ${name}` });
    field.addEventListener('change', () => this.listener.colour(region, field.value));
    label.append(field);
    return label;
  }

  title(region, name) {
    const field = document.createElement('input');
    Object.assign(field, { type: 'text', className: 'name', value: name, ariaLabel: `Name of ${name}`, maxLength: 40, size: Math.max(6, name.length) });
    field.addEventListener('change', () => this.listener.name(region, field.value));
    return field;
  }

  /** Set the same K for all regions. */
  give(regions, K) {
    for (const region of regions) this.targets[region] = K;
    this.tell(regions);
  }

  /** Scale the K of regions: the region with the largest |K| gets this value; regions with K = 0 remain flat. */
  lead(regions, K) {
    if (this.led.regions !== regions || this.led.given !== String(this.targets)) this.led = { regions, shares: proportion(regions.map((region) => this.targets[region])), given: '' };
    regions.forEach((region, k) => {
      const share = this.led.shares[k];
      if (share !== null) this.targets[region] = Number((share * K).toPrecision(4));
    });
    this.led.given = String(this.targets);
    this.tell(regions, true);
  }

  tell(regions, held = false) {
    this.refresh();
    this.listener.change(`K ${regions.join(' ')}`, held);
  }

  refresh() {
    for (const { number, slider, radius, mark, regions, reach } of this.rows) {
      const values = new Set(regions.map((region) => this.targets[region]));
      const first = leading(regions.map((region) => this.targets[region]));
      const K = this.targets[regions[first]];
      const same = values.size === 1 && K !== null && !this.hasLaw(regions);
      showNumber(number, same ? shortened(K) : '');
      number.placeholder = same || this.hasLaw(regions) ? '' : 'various';
      slider.value = Math.round(((K ?? 0) / reach) * STEPS);
      radius.textContent = same ? shape(K, this.model.unit) : K === null || this.hasLaw(regions) ? '' : 'in proportion';
      slider.ariaValueText = same ? `${readable(K)}, ${radius.textContent}` : K === null ? 'various' : `various, the largest ${readable(K)}`;
      const most = this.limit?.[regions[first]];
      const place = 0.5 + (0.5 * (most ?? 2 * reach)) / reach;
      mark.hidden = !(place > 0 && place < 1);
      mark.style.left = `calc(9px + ${place} * (100% - 18px))`;
      mark.title = most ? `Largest feasible K: ${readable(most)}` : '';
    }
  }
}

function plainDot(colour) {
  const dot = document.createElement('i');
  if (colour) dot.style.background = colour;
  else dot.className = 'all';
  return dot;
}

function plainTitle(name) {
  const title = document.createElement('span');
  title.className = 'title';
  title.textContent = name;
  return title;
}

/** Return the index of the largest |K|. */
function leading(targets) {
  return targets.reduce((best, K, k) => (Math.abs(K ?? 0) > Math.abs(targets[best] ?? 0) ? k : best), 0);
}

/** Return each K relative to the largest, null if not given; all equal if the largest is zero. */
function proportion(targets) {
  const most = targets[leading(targets)];
  return targets.map((K) => (most ? K && K / most : 1));
}

/** Return K in a text that fits into its field, with four digits or three if not all fit. The target itself keeps all. */
function shortened(K) {
  const texts = [String(K), String(Number(K.toPrecision(4))), String(Number(K.toPrecision(3)))];
  return texts.find((text) => text.length <= FITTING) ?? K.toExponential(2);
}

function shape(K, unit) {
  if (K === 0) return 'developable';
  const radius = `${readable(1 / Math.sqrt(Math.abs(K)))}${unit ? ` ${unit}` : ''}`;
  return K > 0 ? `sphere, radius ${radius}` : `saddle, radii ± ${radius}`;
}
