/** The dialog that takes a freeform design to panels on few moulds. */

import { LOST } from '../api.js';
import { hand } from '../download.js';
import { numberIn, numberOf, showNumber } from '../fields.js';
import { counted } from '../words.js';
import { Display } from './display.js';
import { mouldColour, reportOf } from './found.js';
import { Jobs } from './jobs.js';
import { keep, storeFile, storedFile } from './kept.js';
import { Status } from './status.js';
import { Stops } from './stops.js';

const PANELS = 12; // along the longer side by default, as on the server
const PAUSE = 400; // time after the last change of the slider before it solves [ms]
const LARGEST = 64 * 2 ** 20; // bytes
const RELOAD = 60; // time after which a page that was left is not a reload [s]
const CACHED = 600; // time for which browsers cache a page that was left, to go back to it [s]

const KINDS = ['flat', 'sphere', 'saddle']; // of moulds
const PLACE = 5; // numbers of a weight: x, y, z, radius, factor

/** @typedef {import('./jobs.js').Told} Told */

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
    /** @type {?import('./jobs.js').Design} */
    this.design = null;
    /** @type {?File} the last one that was dropped */
    this.latest = null;
    this.timer = 0;
    /** @type {(name: string) => any} */
    const $ = (name) => dialog.querySelector(`#rationalise-${name}`);
    this.$ = $;
    this.form = $('form');
    this.fields = this.form.elements;
    this.jobs = new Jobs(api);
    this.status = new Status($);
    this.display = new Display(dialog, $);
    this.stops = new Stops($('stops'));
    $('file').addEventListener('change', ({ target }) => {
      const [file] = target.files;
      if (file) this.take(file);
      // Choosing the same file again must trigger a change event.
      target.value = '';
    });
    $('close').addEventListener('click', () => dialog.close());
    $('stop').addEventListener('click', () => this.stop());
    $('open').addEventListener('click', () => this.asRoof());
    $('files').addEventListener('click', ({ target }) => target.dataset.format && this.download(target.dataset.format));
    this.fields.moulds.addEventListener('input', () => this.count());
    this.fields.moulds.addEventListener('change', () => this.later());
    this.fields.weights.addEventListener('input', ({ target }) => {
      const read = this.weights.every((row) => row.length === PLACE && row.every(Number.isFinite));
      target.setCustomValidity(read ? '' : 'Type five numbers in a line, such as 12.5 0 3 4 2: a place, a radius, and a factor.');
    });
    $('aim').addEventListener('change', () => this.aim());
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.start();
    });
    window.addEventListener('pagehide', ({ persisted }) => this.leave(persisted));
    window.addEventListener('pageshow', ({ persisted }) => persisted && this.back());
    this.aim();
  }

  /** Open the dialog, if it is not open. */
  show() {
    if (!this.dialog.open) this.dialog.showModal();
    if (this.display.told) this.present(this.display.told);
  }

  // ---------------------------------------------------------- the design

  /**
   * Read a design, and show it.
   * @param {File} file
   * @param {?import('./kept.js').Kept} [kept] if its job is to be found again
   */
  async take(file, kept = null) {
    const kind = suffixOf(file.name);
    if (file.size > LARGEST) return this.status.fail(`“${file.name}” is larger than 64 MB, the limit of the server. Save only the design to a file.`);
    if (!this.kinds.includes(kind)) return this.status.fail(`“${file.name}” has an unsupported format. Save the design as ${this.kinds.map((own) => `.${own}`).join(', ')} and drop the file again.`);
    this.halt();
    this.status.say(`Reading “${file.name}” …`);
    this.latest = file;
    try {
      const surface = await this.api.freeform(file, kind);
      // Another file may have been dropped meanwhile, or the dialog closed.
      if (this.latest !== file) return;
      if (!this.dialog.open) {
        this.status.say('');
        return;
      }
      this.jobs.forget();
      this.design = { file, kind, name: file.name.replace(/\.[^.]*$/, ''), stored: kept?.stored ?? (await storeFile(file)), surface };
      await this.begin();
      if (!kept?.job) return;
      this.settings = kept.job.settings;
      await this.start(kept.job.id);
    } catch (error) {
      if (this.latest === file) this.status.fail(error.message);
    }
  }

  /** Show the design without a result. */
  async begin() {
    const { surface, file } = this.design;
    const spans = spansOf(surface.vertices);
    const size = spans.map((span) => String(Number(span.toPrecision(3)))).join(' × ');
    this.$('file-name').textContent = file.name;
    this.$('file-facts').textContent = [`${size}${surface.unit ? ` ${surface.unit}` : ''}`, ...(surface.seams.length ? [counted(surface.seams.length, 'seam')] : [])].join(' · ');
    this.$('name').textContent = this.design.name;
    for (const each of this.form.querySelectorAll('.unit.length')) each.textContent = surface.unit ? `in ${surface.unit}` : '';
    showNumber(this.fields.panel, Number((Math.max(...spans) / PANELS).toPrecision(2)));
    showNumber(this.fields.within);
    this.costs = undefined;
    this.weights = [];
    this.$('choices').disabled = false;
    this.dialog.classList.remove('bare');
    this.status.run(false);
    this.stops.show(new Map());
    this.count();
    await this.display.begin(this.design);
  }

  /**
   * Go on with the design and the job from before a reload of the page.
   * @param {import('./kept.js').Kept} kept
   */
  async resume(kept) {
    const file = await storedFile(kept.stored);
    if (file) await this.take(file, kept);
  }

  /** The page is left: keep what a reload needs, for as long as a reload takes, and delete the other results. */
  leave(persisted) {
    // A design that is still being read again stays as it was kept.
    if (!this.design) return;
    const { stored } = this.design;
    const job = stored && this.jobs.last(this.display.told);
    keep(stored && { stored, open: this.dialog.open, job });
    if (job) this.api.forget(job.id, persisted ? CACHED : RELOAD).catch(() => {});
    // A page in the back/forward cache goes on as it is.
    if (persisted) return;
    if (!stored) this.jobs.halt();
    this.jobs.forget(job?.id);
  }

  /** The page is shown again from the cache: a request for its job revokes the deletion. */
  back() {
    const job = this.jobs.last(this.display.told);
    if (job) this.api.status(job.id).catch(() => {});
  }

  // ---------------------------------------------------------- the fields

  /** Settings of the job in the fields. */
  get settings() {
    const { panel, within, moulds, aim, seams, supports, tolerance, flat } = this.fields;
    const given = { panel: numberOf(panel), tolerance: numberOf(tolerance), seams: seams.value, supports: supports.value, flat: { yes: true, no: false }[flat.value] };
    const aims = aim.value === 'count' ? { moulds: Number(moulds.value) } : { within: numberOf(within), costs: this.costs };
    // Numbers of empty fields are NaN.
    const weights = this.weights.length ? { weights: this.weights } : {};
    return Object.fromEntries(Object.entries({ ...given, ...aims, ...weights }).filter(([, value]) => value || value === false || value === 0));
  }

  /** Costs of a mould and of a panel by kind, undefined if no field is filled. */
  get costs() {
    const pairs = KINDS.map((kind) => [kind, this.costFields(kind).map(numberOf)]);
    if (pairs.every(([, pair]) => pair.every(Number.isNaN))) return undefined;
    return Object.fromEntries(pairs.map(([kind, pair]) => [kind, pair.map((cost) => cost || 0)]));
  }

  set costs(costs) {
    for (const kind of KINDS) this.costFields(kind).forEach((field, k) => showNumber(field, costs?.[kind]?.[k]));
  }

  costFields(kind) {
    return ['mould', 'panel'].map((part) => this.fields[`cost-${kind}-${part}`]);
  }

  /** Rows of x, y, z, radius and factor. */
  get weights() {
    const rows = this.fields.weights.value.split('\n').map((line) => line.trim());
    return rows.filter(Boolean).map((line) => line.split(/[\s;]+/).map(numberIn));
  }

  set weights(rows) {
    this.fields.weights.value = rows.map((row) => row.join(' ')).join('\n');
    this.fields.weights.setCustomValidity('');
  }

  set settings({ panel, tolerance, within, moulds, costs, weights = [], seams = '', supports = '', flat }) {
    const { fields } = this;
    showNumber(fields.panel, panel);
    showNumber(fields.tolerance, tolerance);
    showNumber(fields.within, within);
    this.costs = costs;
    this.weights = weights;
    fields.moulds.value = moulds ?? fields.moulds.value;
    fields.aim.value = moulds === undefined ? 'within' : 'count';
    fields.seams.value = seams;
    fields.supports.value = supports;
    fields.flat.value = { true: 'yes', false: 'no' }[flat] ?? '';
    this.aim();
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
    const known = this.design && this.fields.aim.value === 'count' && this.jobs.known(this.settings);
    if (known && known !== this.display.told) {
      this.halt();
      this.present(known);
    }
  }

  /** The slider rests: solve for its number, once a number was solved. */
  later() {
    if (!this.jobs.results.size || this.jobs.known(this.settings)) return;
    this.timer = setTimeout(() => this.start(), PAUSE);
  }

  // ---------------------------------------------------------- the job

  /**
   * Start a job with the settings in the fields, in the place of the running one.
   * @param {string} [id] of a job that was submitted before
   */
  async start(id) {
    clearTimeout(this.timer);
    if (!this.design || !this.form.reportValidity()) return;
    const { settings } = this;
    const known = this.jobs.known(settings);
    if (known) {
      this.present(known);
      return;
    }
    this.status.run(true);
    this.status.say('Sending the design …');
    try {
      const told = await this.jobs.start(this.design, settings, id, { progress: (status) => this.status.progress(status), lost: () => this.status.say(LOST) });
      if (!told) return;
      this.status.run(false);
      this.display.told = told;
      // A dialog that was closed meanwhile has no size to draw in.
      if (this.dialog.open) this.present(told);
    } catch (error) {
      this.status.run(false);
      if (this.jobs.stopped) this.status.say('Stopped.');
      else this.status.fail(error.message);
    }
  }

  /** Stop the job with its best surface so far. */
  async stop() {
    this.status.say('Stopping …');
    if (!(await this.jobs.stop())) this.halt();
  }

  /** Give up the running job. */
  halt() {
    if (!this.jobs.run) return;
    this.jobs.halt();
    this.status.run(false);
  }

  // ---------------------------------------------------------- the result

  /**
   * Show a result.
   * @param {Told} told
   */
  present(told) {
    const { aim, moulds } = this.fields;
    // A result may have fewer moulds than were allowed: the slider keeps the number that was set.
    if (aim.value === 'within') moulds.value = told.moulds;
    this.stops.show(this.jobs.distances(this.settings));
    this.stops.choose(Number(moulds.value));
    this.$('number').textContent = moulds.value;
    this.display.result(told);
  }

  /** Open the result as a roof on the page. */
  async asRoof() {
    const { name } = this.design;
    const { told } = this.display;
    this.status.say('Opening the roof …');
    this.$('open').disabled = true;
    try {
      const file = new File([await this.api.download(told.id, '3dm', null)], `${name} panels.3dm`);
      const data = await this.api.model(file, '3dm');
      const colours = data.targets.map((K) => mouldColour(nearest(told.curvatures, K)));
      await this.open({ ...data, file, colours });
      this.dialog.close();
      this.status.say('');
    } catch (error) {
      this.status.fail(error.message);
    } finally {
      this.$('open').disabled = false;
    }
  }

  async download(format) {
    const { name } = this.design;
    const { told } = this.display;
    try {
      if (format === 'json') hand(new Blob([reportOf(told)], { type: 'application/json' }), `${name} moulds.json`);
      else hand(await this.api.download(told.id, format, null), `${name} panels.${format}`);
    } catch (error) {
      this.status.fail(error.message);
    }
  }
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

function nearest(curvatures, K) {
  return curvatures.reduce((best, own, k) => (Math.abs(own - K) < Math.abs(curvatures[best] - K) ? k : best), 0);
}
