/** Fields of the goals: rise, height limits, free edges, clear volumes. */

import { asNumberField, numberOf, showNumber } from './fields.js';

const SIDES = [
  ['x0', 'from x'],
  ['y0', 'from y'],
  ['x1', 'to x'],
  ['y1', 'to y'],
  ['height', 'clear up to'],
];

/** The goals section of the panel. */
export class Goals {
  /**
   * @param {HTMLFormElement} panel
   * @param {(goals: import('./types.js').Goals, key: string) => void} change
   */
  constructor(panel, change) {
    this.fields = panel.elements;
    this.list = panel.querySelector('#boxes');
    this.more = panel.querySelector('#more-goals');
    this.change = change;
    for (const name of ['rise', 'above', 'below']) {
      this.fields[name].addEventListener('change', ({ target }) => {
        const value = Number.isFinite(numberOf(target)) ? numberOf(target) : null;
        // Entering the first rise makes K unknown.
        const found = name === 'rise' && this.goals.rise === undefined && value !== null ? { found: true } : {};
        change({ [name]: value, ...found }, name);
      });
    }
    for (const name of ['found', 'edge']) this.fields[name].addEventListener('change', ({ target }) => change({ [name]: target.checked }, name));
    panel.querySelector('#add-box').addEventListener('click', () => this.add());
  }

  /**
   * Show the goals.
   * @param {import('./types.js').Goals} goals
   * @param {import('./model.js').Model} model
   */
  show(goals, model) {
    this.goals = goals ?? {};
    this.model = model;
    for (const name of ['rise', 'above', 'below']) showNumber(this.fields[name], this.goals[name]);
    for (const name of ['found', 'edge']) this.fields[name].checked = Boolean(this.goals[name]);
    this.fields.found.disabled = this.goals.rise === null || this.goals.rise === undefined;
    const boxes = this.goals.boxes ?? [];
    if (boxes.length || this.goals.above != null || this.goals.below != null) this.more.open = true;
    this.list.replaceChildren(...boxes.map((box, number) => this.row(box, number)));
  }

  /** Add a clear volume in the middle of the plan. */
  add() {
    const { low, high } = this.model.bounds;
    const at = (axis, share) => Number((low[axis] + share * (high[axis] - low[axis])).toPrecision(3));
    const height = Number((0.06 * Math.hypot(high[0] - low[0], high[1] - low[1])).toPrecision(2));
    this.put({ x0: at(0, 0.35), y0: at(1, 0), x1: at(0, 0.65), y1: at(1, 0.25), height });
  }

  /** @param {import('./types.js').Box} box */
  put(box) {
    this.change({ boxes: [...(this.goals.boxes ?? []), box] }, 'box');
  }

  row(box, number) {
    const row = document.createElement('li');
    const fields = SIDES.map(([name, words]) => {
      const [label, field] = ['label', 'input'].map((tag) => document.createElement(tag));
      asNumberField(field, { value: box[name], ariaLabel: `Clear volume ${number + 1} ${words}` });
      field.addEventListener('change', () => {
        if (!Number.isFinite(numberOf(field))) showNumber(field, box[name]);
        else this.change({ boxes: this.goals.boxes.map((own, k) => (k === number ? { ...own, [name]: numberOf(field) } : own)) }, `box ${number} ${name}`);
      });
      label.append(words, field);
      return label;
    });
    const remove = document.createElement('button');
    Object.assign(remove, { type: 'button', className: 'small', textContent: 'Remove' });
    remove.addEventListener('click', () => this.change({ boxes: this.goals.boxes.filter((_, k) => k !== number) }, ''));
    row.append(...fields, remove);
    return row;
  }
}
