/** The dialog that takes a freeform design to panels on few moulds. */

import { LOST } from '../api.js';
import { hand } from '../download.js';
import { numberOf, showNumber } from '../fields.js';
import { Legend } from '../legend.js';
import { duration } from '../numbers.js';
import { capital } from '../words.js';
import { figuresOf, lengthScale, limitOf, mouldColour, mouldsOf, reportOf } from './found.js';
import { drawPlan, isUpwards } from './plan.js';
import { Stops } from './stops.js';
import { Views, showDistances } from './views.js';

const PANELS = 12; // along the longer side by default, as on the server
const PAUSE = 400; // time after the last change of the slider before it solves [ms]
const LARGEST = 64 * 2 ** 20; // bytes

/** @typedef {any} Told result of a rationalisation: its report, and the surface with its panels */

/** One design at a time, with the results for several numbers of moulds. */
export class Rationaliser {
  /**
   * @param {HTMLDialogElement} dialog
   * @param {import('../api.js').Api} api
   * @param {string[]} kinds of files
   * @param {(data: import('../types.js').Data) => Promise<void>} open shows a roof on the page
   */
  constructor(dialog, api, kinds, open) {
    this.dialog = dialog;
    this.api = api;
    this.kinds = kinds;
    this.open = open;
    /** @type {?{file: File, kind: string, name: string, surface: any}} */
    this.design = null;
    /** @type {?File} the last one that was dropped */
    this.latest = null;
    /** @type {Map<string, Told>} by the settings */
    this.results = new Map();
    /** @type {?Told} */
    this.shown = null;
    /** @type {?{abort: AbortController, id: string, stopped: boolean}} */
    this.run = null;
    /** @type {?Views} */
    this.views = null;
    this.timer = 0;
    /** @type {(name: string) => any} */
    const $ = (name) => dialog.querySelector(`#rationalise-${name}`);
    this.$ = $;
    this.form = $('form');
    this.fields = this.form.elements;
    this.stops = new Stops($('stops'));
    this.legend = new Legend($('distances-legend'));
    $('file').addEventListener('change', ({ target }) => {
      const [file] = target.files;
      if (file) this.take(file);
      // Choosing the same file again must trigger a change event.
      target.value = '';
    });
    $('close').addEventListener('click', () => dialog.close());
    $('stop').addEventListener('click', () => this.stop());
    $('open').addEventListener('click', () => this.asRoof());
    $('colours').addEventListener('change', ({ target }) => this.views?.colour(target.value));
    $('fit').addEventListener('click', () => this.views?.scene.fit());
    $('files').addEventListener('click', ({ target }) => target.dataset.format && this.download(target.dataset.format));
    this.fields.moulds.addEventListener('input', () => this.count());
    this.fields.moulds.addEventListener('change', () => this.later());
    $('aim').addEventListener('change', () => this.aim());
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.start();
    });
    $('moulds').addEventListener('pointerover', ({ target }) => this.light(target.closest('tr')));
    $('moulds').addEventListener('pointerleave', () => this.light(null));
    new ResizeObserver(() => this.draw()).observe($('plans'));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.views?.scene.dress();
      this.draw();
    });
    window.addEventListener('pagehide', ({ persisted }) => {
      this.halt();
      if (!persisted) this.forget();
    });
    this.aim();
  }

  /** Open the dialog, if it is not open. */
  show() {
    if (!this.dialog.open) this.dialog.showModal();
    if (this.shown) this.present(this.shown);
  }

  // ---------------------------------------------------------- the design

  /**
   * Read a design, and show it.
   * @param {File} file
   */
  async take(file) {
    const kind = suffixOf(file.name);
    if (file.size > LARGEST) return this.fail(`“${file.name}” is larger than 64 MB, the limit of the server. Save only the design to a file.`);
    if (!this.kinds.includes(kind)) return this.fail(`“${file.name}” has an unsupported format. Save the design as ${this.kinds.map((own) => `.${own}`).join(', ')} and drop the file again.`);
    this.halt();
    this.say(`Reading “${file.name}” …`);
    this.latest = file;
    try {
      const surface = await this.api.freeform(file, kind);
      // Another file may have been dropped meanwhile, or the dialog closed.
      if (this.latest !== file) return;
      if (!this.dialog.open) {
        this.say('');
        return;
      }
      this.forget();
      this.design = { file, kind, name: file.name.replace(/\.[^.]*$/, ''), surface };
      await this.begin();
    } catch (error) {
      if (this.latest === file) this.fail(error.message);
    }
  }

  /** Show the design without a result. */
  async begin() {
    const { surface, file } = this.design;
    const spans = spansOf(surface.vertices);
    const size = spans.map((span) => String(Number(span.toPrecision(3)))).join(' × ');
    this.$('file-name').textContent = file.name;
    this.$('file-facts').textContent = [`${size}${surface.unit ? ` ${surface.unit}` : ''}`, ...(surface.seams.length ? [`${surface.seams.length} seams`] : [])].join(' · ');
    this.$('name').textContent = this.design.name;
    for (const each of this.form.querySelectorAll('.unit.length')) each.textContent = surface.unit ? `in ${surface.unit}` : '';
    showNumber(this.fields.panel, Number((Math.max(...spans) / PANELS).toPrecision(2)));
    showNumber(this.fields.within);
    this.$('choices').disabled = false;
    this.dialog.classList.remove('bare');
    this.settle();
    this.clear();
    this.notes(surface.notes);
    this.views ??= await Views.create(this.$('canvas'), this.$('legend'));
    this.views.design(this.design.name, surface);
  }

  // ---------------------------------------------------------- the job

  /** Settings of the job in the fields. */
  get settings() {
    const { panel, within, moulds, aim, seams, supports, tolerance, flat } = this.fields;
    const given = { panel: numberOf(panel), tolerance: numberOf(tolerance), seams: seams.value, supports: supports.value, flat: { yes: true, no: false }[flat.value] };
    const aims = aim.value === 'count' ? { moulds: Number(moulds.value) } : { within: numberOf(within) };
    // Numbers of empty fields are NaN.
    return Object.fromEntries(Object.entries({ ...given, ...aims }).filter(([, value]) => value || value === false || value === 0));
  }

  /** Show the fields of the aim. */
  aim() {
    const counted = this.fields.aim.value === 'count';
    this.$('count').hidden = !counted;
    this.$('limit').hidden = counted;
    this.fields.within.required = !counted;
    this.count();
  }

  /** Show the number of moulds of the slider, and its result if it is known. */
  count() {
    clearTimeout(this.timer);
    const { moulds } = this.fields;
    this.$('number').textContent = moulds.value;
    this.stops.choose(Number(moulds.value));
    const known = this.design && this.fields.aim.value === 'count' && this.results.get(JSON.stringify(this.settings));
    if (known && known !== this.shown) {
      this.halt();
      this.present(known);
    }
  }

  /** The slider rests: solve for its number, once a number was solved. */
  later() {
    if (!this.results.size || this.results.has(JSON.stringify(this.settings))) return;
    this.timer = setTimeout(() => this.start(), PAUSE);
  }

  /** Start a job with the settings in the fields, in the place of the running one. */
  async start() {
    clearTimeout(this.timer);
    if (!this.design || !this.form.reportValidity()) return;
    const { settings } = this;
    const key = JSON.stringify(settings);
    if (this.results.has(key)) {
      this.present(this.results.get(key));
      return;
    }
    this.halt();
    const run = { abort: new AbortController(), id: '', stopped: false };
    this.run = run;
    const { file, kind, name } = this.design;
    this.say('Sending the design …');
    this.$('stop').hidden = false;
    this.$('results').ariaBusy = 'true';
    try {
      const options = { task: 'rationalise', name: name.slice(0, 100), settings };
      const told = await this.api.buildFrom(file, kind, options, run.abort.signal, {
        begun: (id) => (run.id = id),
        progress: (status) => this.run === run && this.progress(status),
        lost: () => this.run === run && this.say(LOST),
      });
      if (this.run !== run) return;
      // One that was stopped is not the result of its settings.
      if (told.status !== 'cancelled') this.results.set(key, told);
      this.settle();
      this.shown = told;
      // A dialog that was closed meanwhile has no size to draw in.
      if (this.dialog.open) this.present(told);
    } catch (error) {
      if (this.run !== run) return;
      this.settle();
      if (run.stopped) this.say('Stopped.');
      else this.fail(error.message);
    }
  }

  progress(status) {
    const { text, part } = stageOf(status);
    this.say([text, ...(status.elapsed === null ? [] : [duration(status.elapsed)])].join(' · '), part);
  }

  /** Stop the job with its best surface so far. */
  async stop() {
    if (!this.run?.id) return this.halt();
    this.run.stopped = true;
    this.say('Stopping …');
    try {
      await this.api.cancel(this.run.id);
    } catch {
      // The job may have ended meanwhile, or the server may not respond.
      this.halt();
    }
  }

  /** Give up the running job. */
  halt() {
    this.run?.abort.abort();
    if (this.run) this.settle();
  }

  /** Nothing runs any more. */
  settle() {
    this.run = null;
    this.$('stop').hidden = true;
    this.$('results').ariaBusy = 'false';
    this.say('');
  }

  /** Delete all results on the server. */
  forget() {
    // The result of a job that was stopped is shown, but not kept.
    for (const { id } of new Set([...this.results.values(), ...(this.shown ? [this.shown] : [])])) this.api.forget(id).catch(() => {});
    this.results.clear();
    this.shown = null;
  }

  // ---------------------------------------------------------- the result

  /**
   * Show a result.
   * @param {Told} told
   */
  present(told) {
    const { unit } = this.design.surface;
    this.shown = told;
    const { aim, moulds } = this.fields;
    // A result may have fewer moulds than were allowed: the slider keeps the number that was set.
    if (aim.value === 'within') moulds.value = told.moulds;
    this.stops.show(this.tried());
    this.stops.choose(Number(moulds.value));
    this.$('number').textContent = moulds.value;
    const figures = figuresOf(told, unit);
    const verdict = this.$('verdict');
    verdict.className = `verdict ${figures.kind}`;
    verdict.querySelector('h2').textContent = figures.head;
    verdict.querySelector('p').textContent = figures.text;
    verdict.querySelector('p').hidden = !figures.text;
    this.$('figures').replaceChildren(...figures.rows.flatMap(([name, value]) => [textOf('dt', name), textOf('dd', value)]));
    this.$('radius').textContent = unit ? `in ${unit}` : '';
    const { unit: per, rows } = mouldsOf(told.curvatures, unit);
    this.$('K').textContent = per;
    this.$('moulds').replaceChildren(...rows.map((mould, k) => rowOf(mould, k, told.panels_per_class[k])));
    this.notes(told.notes);
    this.$('results').hidden = false;
    this.$('plans').hidden = false;
    this.$('tools').hidden = false;
    this.views?.result(this.design.name, unit, told);
    this.views?.colour(this.fields['rationalise-colours'].value);
    this.draw();
  }

  /** Return the largest distances by number of moulds, of results with the present settings but for this number. */
  tried() {
    const rest = (/** @type {any} */ { moulds, within, ...own }) => JSON.stringify(own);
    const found = [...this.results].map(([key, told]) => ({ settings: JSON.parse(key), told }));
    const alike = found.filter(({ settings }) => rest(settings) === rest(this.settings));
    return new Map(alike.map(({ settings, told }) => [settings.moulds ?? told.moulds, told.distance.max]));
  }

  /** Draw the plans. */
  draw() {
    const told = this.shown;
    if (!told || !this.dialog.open) return;
    const { unit } = this.design.surface;
    const panels = drawPlan(this.$('panels'), told, 'moulds', unit);
    drawPlan(this.$('distances'), told, 'distance', unit);
    this.$('panels').ariaLabel = `${panels} of ${told.panels} panels in the colours of ${told.moulds} moulds`;
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

  clear() {
    this.shown = null;
    for (const name of ['results', 'plans', 'tools']) this.$(name).hidden = true;
    this.stops.show(new Map());
    this.count();
  }

  /** Open the result as a roof on the page. */
  async asRoof() {
    const { name } = this.design;
    const told = this.shown;
    this.say('Opening the roof …');
    this.$('open').disabled = true;
    try {
      const file = new File([await this.api.download(told.id, '3dm', null)], `${name} panels.3dm`);
      const data = await this.api.model(file, '3dm');
      const colours = data.targets.map((K) => mouldColour(nearest(told.curvatures, K)));
      await this.open({ ...data, file, colours });
      this.dialog.close();
      this.say('');
    } catch (error) {
      this.fail(error.message);
    } finally {
      this.$('open').disabled = false;
    }
  }

  async download(format) {
    const { name } = this.design;
    try {
      if (format === 'json') hand(new Blob([reportOf(this.shown)], { type: 'application/json' }), `${name} moulds.json`);
      else hand(await this.api.download(this.shown.id, format, null), `${name} panels.${format}`);
    } catch (error) {
      this.fail(error.message);
    }
  }

  // ---------------------------------------------------------- words

  /**
   * Say what is going on.
   * @param {string} text nothing is shown if it is empty
   * @param {?number} [part] that is done
   */
  say(text, part = null) {
    this.$('trouble').hidden = true;
    this.$('said').textContent = text;
    this.$('doing').hidden = !text;
    const bar = this.$('bar');
    bar.hidden = !this.run;
    if (part) bar.value = part;
    else bar.removeAttribute('value');
  }

  fail(text) {
    this.say('');
    this.$('trouble').textContent = capital(text);
    this.$('trouble').hidden = false;
    this.$('trouble').scrollIntoView({ block: 'nearest' });
  }

  notes(notes) {
    this.$('notes').replaceChildren(...notes.map((text) => textOf('p', capital(text))));
  }
}

/** Return what a job does, and the part of the assignment that is done. */
function stageOf({ state, stage, iteration, iterations }) {
  if (state === 'queued') return { text: 'Waiting in the queue', part: null };
  if (stage !== 'assign') return { text: 'Dividing the design into panels', part: null };
  if (iteration >= iterations) return { text: 'Solving the surface', part: null };
  return { text: `Assigning panels, round ${iteration} of at most ${iterations}`, part: iteration / iterations };
}

function suffixOf(name) {
  return name.split('.').pop().toLowerCase();
}

function spansOf(vertices) {
  return [0, 1, 2].map((axis) => {
    const [low, high] = vertices.reduce(([a, b], point) => [Math.min(a, point[axis]), Math.max(b, point[axis])], [Infinity, -Infinity]);
    return high - low;
  });
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

function nearest(curvatures, K) {
  return curvatures.reduce((best, own, k) => (Math.abs(own - K) < Math.abs(curvatures[best] - K) ? k : best), 0);
}
