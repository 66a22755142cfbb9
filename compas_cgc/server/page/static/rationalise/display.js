/** What the dialog shows of a design and of its result. */

import { Legend } from '../legend.js';
import { capital, counted } from '../words.js';
import { figuresOf, lengthScale, limitOf, mouldColour, mouldsOf } from './found.js';
import { drawPlan, isUpwards } from './plan.js';
import { Views, showDistances } from './views.js';

/** @typedef {import('./jobs.js').Told} Told */

/** 3D view, plans, figures and the table of moulds. */
export class Display {
  /**
   * @param {HTMLDialogElement} dialog
   * @param {(name: string) => any} $
   */
  constructor(dialog, $) {
    this.dialog = dialog;
    this.$ = $;
    /** @type {?import('./jobs.js').Design} */
    this.design = null;
    /** @type {?Told} */
    this.told = null;
    /** @type {?Views} */
    this.views = null;
    this.legend = new Legend($('distances-legend'));
    $('colours').addEventListener('change', () => this.colour());
    $('fit').addEventListener('click', () => this.views?.scene.fit());
    $('moulds').addEventListener('pointerover', ({ target }) => this.light(target.closest('tr')));
    $('moulds').addEventListener('pointerleave', () => this.light(null));
    new ResizeObserver(() => this.draw()).observe($('plans'));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.views?.scene.dress();
      this.draw();
    });
  }

  /**
   * Show a design without a result.
   * @param {import('./jobs.js').Design} design
   */
  async begin(design) {
    this.design = design;
    this.told = null;
    for (const name of ['results', 'plans', 'tools']) this.$(name).hidden = true;
    this.notes(design.surface.notes);
    this.views ??= await Views.create(this.$('canvas'), this.$('legend'));
    this.views.design(design.name, design.surface);
  }

  /**
   * Show a result.
   * @param {Told} told
   */
  result(told) {
    const { name, surface } = this.design;
    const { unit } = surface;
    this.told = told;
    const figures = figuresOf(told, unit);
    const verdict = this.$('verdict');
    verdict.className = `verdict ${figures.kind}`;
    verdict.querySelector('h2').textContent = figures.head;
    verdict.querySelector('p').textContent = figures.text;
    verdict.querySelector('p').hidden = !figures.text;
    this.$('figures').replaceChildren(...figures.rows.flatMap(([head, value]) => [textOf('dt', head), textOf('dd', value)]));
    this.$('radius').textContent = unit ? `in ${unit}` : '';
    const { unit: per, rows } = mouldsOf(told.curvatures, unit);
    this.$('K').textContent = per;
    this.$('moulds').replaceChildren(...rows.map((mould, k) => rowOf(mould, k, told.panels_per_class[k])));
    this.notes(told.notes);
    for (const part of ['results', 'plans', 'tools']) this.$(part).hidden = false;
    this.views?.result(name, unit, told);
    this.colour();
    this.draw();
  }

  /** Colour the 3D view as chosen. */
  colour() {
    this.views?.colour(this.$('colours').querySelector(':checked').value);
  }

  /** Draw the plans. */
  draw() {
    const { told } = this;
    if (!told || !this.dialog.open) return;
    const { unit } = this.design.surface;
    const panels = drawPlan(this.$('panels'), told, 'moulds', unit);
    drawPlan(this.$('distances'), told, 'distance', unit);
    this.$('panels').ariaLabel = `${panels} of ${counted(told.panels, 'panel')} in the colours of ${counted(told.moulds, 'mould')}`;
    const length = lengthScale(unit, limitOf(told));
    const side = { Plan: `, red ${isUpwards(told) ? 'above' : 'below'}`, Elevation: ', red in front' }[panels] ?? '';
    this.$('distances').ariaLabel = `${panels} of the distance from the design, largest ${length.text(told.distance.max)}`;
    this.$('panels-head').textContent = `${panels}: panels by mould`;
    this.$('distances-head').textContent = `${panels}: distance from the design${length.unit ? ` in ${length.unit}` : ''}${side}`;
    showDistances(this.legend, told, unit);
  }

  /** Highlight the panels of a row of the table. */
  light(row) {
    this.views?.light(row?.dataset.mould === undefined ? [] : [Number(row.dataset.mould)]);
  }

  notes(notes) {
    this.$('notes').replaceChildren(...notes.map((text) => textOf('p', capital(text))));
  }
}

function textOf(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}

function rowOf({ shape, radius, curvature }, k, panels) {
  const row = document.createElement('tr');
  row.dataset.mould = String(k);
  const head = textOf('th', '');
  head.scope = 'row';
  const mark = document.createElement('i');
  mark.style.background = mouldColour(k);
  head.append(mark, `${k + 1} ${shape}`);
  row.append(head, textOf('td', radius), textOf('td', curvature), textOf('td', String(panels)));
  return row;
}
