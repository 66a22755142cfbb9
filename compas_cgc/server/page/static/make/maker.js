/** Builds from a solved surface: moulds, flat patterns, forces and nets, each a job of the server. */

import { LOST } from '../api.js';
import { hand } from '../download.js';
import { labelled, valueOf } from '../settings.js';
import { capital } from '../words.js';
import { drawnOf } from './drawn.js';
import { drawSheets } from './sheets.js';

const NAMES = { mould: 'Moulds', unroll: 'Unroll', membrane: 'Forces', net: 'Net', drawings: 'Plans' };
const SHEETS = { unroll: 'Flat pieces', drawings: 'Plans, sections, elevations' }; // headings of the card with sheets
const LEFT = ['rough', 'regions', 'seams', 'through', 'nodes', 'along']; // options for scripts
const DEFAULTS = { pressure: 1 }; // forces require a load
const SUFFIXES = { arrays: 'json' };

/** The build section of the results. */
export class Maker {
  /**
   * @param {HTMLFormElement} room
   * @param {import('../api.js').Api} api
   * @param {{job: () => ?string, rough: () => boolean, name: () => string, show: (drawn: ?import('./drawn.js').Drawn) => void}} source
   * @param {HTMLElement} sheets the card for flat patterns
   */
  constructor(room, api, source, sheets) {
    this.room = room;
    this.api = api;
    this.source = source;
    this.sheets = sheets;
    this.said = room.querySelector('#make-said');
    this.more = room.querySelector('#make-more');
    this.files = room.querySelector('#make-files');
    this.key = room.querySelector('#make-key');
    this.tabs = room.querySelector('#make-tabs');
    this.made = null;
    this.abort = null;
    this.tabs.addEventListener('change', () => this.choose());
    room.addEventListener('submit', (event) => {
      event.preventDefault();
      this.make();
    });
    this.files.addEventListener('click', ({ target }) => {
      if (target.dataset.format) this.download(target.dataset.format);
    });
    sheets.querySelector('button').addEventListener('click', () => (sheets.hidden = true));
    this.load();
  }

  async load() {
    try {
      this.tasks = (await this.api.tasks()).filter(({ name }) => NAMES[name]);
    } catch (error) {
      this.said.textContent = error.message;
      return;
    }
    this.tabs.append(
      ...this.tasks.map(({ name }, k) => {
        const [label, field, words] = ['label', 'input', 'span'].map((tag) => document.createElement(tag));
        Object.assign(field, { type: 'radio', name: 'task', value: name, checked: k === 0 });
        words.textContent = NAMES[name];
        label.append(field, words);
        return label;
      }),
    );
    this.choose();
  }

  get task() {
    return this.tasks.find(({ name }) => name === this.room.elements.task.value);
  }

  /** Show the options of a task. */
  choose() {
    this.clear();
    this.room.querySelector('#make-text').textContent = this.task.text;
    const shown = this.task.options.filter(({ name }) => !LEFT.includes(name));
    this.room.querySelector('#make-options').replaceChildren(...shown.map((option) => labelled(option, DEFAULTS[option.name])));
  }

  /** Clear the display of the last build. */
  clear() {
    this.abort?.abort();
    this.abort = null;
    if (this.made) this.api.forget(this.made.id).catch(() => {});
    this.made = null;
    this.said.textContent = '';
    for (const each of [this.more, this.files, this.key, this.sheets]) each.hidden = true;
    this.source.show(null);
  }

  /** Start a build with the chosen options; a build that is still running is cancelled. */
  async make() {
    const job = this.source.job();
    if (!job) return;
    const { task } = this;
    this.clear();
    const abort = new AbortController();
    this.abort = abort;
    this.said.textContent = 'Computing …';
    /** @type {any[]} */
    const fields = Array.from(this.room.querySelectorAll('#make-options input, #make-options select'));
    const given = fields.filter((field) => field.value !== '');
    const settings = Object.fromEntries(given.map((field) => [field.name, valueOf(field)]));
    if (this.source.rough()) settings.rough = true;
    try {
      const told = await this.api.build({ task: task.name, job, settings }, abort.signal, {
        lost: () => this.abort === abort && (this.said.textContent = LOST),
      });
      if (this.abort !== abort) return;
      this.made = told;
      const [first, ...rest] = told.text.split('\n');
      this.said.textContent = capital(first);
      this.more.hidden = !rest.length;
      this.more.querySelector('p').textContent = rest.join('\n');
      this.draw(task.name, told);
      this.offer(told.formats);
      this.files.scrollIntoView({ block: 'nearest' });
    } catch (error) {
      if (error.name !== 'AbortError') this.said.textContent = capital(error.message);
    }
  }

  draw(task, told) {
    const drawn = drawnOf(task, told);
    this.source.show(drawn);
    this.key.replaceChildren(
      ...drawn.key.map(({ colour, text }) => {
        const [row, mark] = ['li', 'i'].map((tag) => document.createElement(tag));
        mark.style.background = colour;
        row.append(mark, text);
        return row;
      }),
    );
    this.key.hidden = !drawn.key.length;
    if (!told.lines) return;
    this.sheets.hidden = false;
    this.sheets.querySelector('span').textContent = SHEETS[task] ?? NAMES[task];
    drawSheets(this.sheets.querySelector('svg'), told);
  }

  offer(formats) {
    const names = formats.filter((format) => format !== 'json');
    this.files.replaceChildren(
      ...names.map((format) => {
        const button = document.createElement('button');
        Object.assign(button, { type: 'button', textContent: `.${SUFFIXES[format] ?? format}` });
        button.dataset.format = format;
        return button;
      }),
    );
    this.files.hidden = false;
  }

  async download(format) {
    try {
      const blob = await this.api.download(this.made.id, format, null);
      hand(blob, `${this.source.name()} ${this.task.name}.${SUFFIXES[format] ?? format}`);
    } catch (error) {
      this.said.textContent = capital(error.message);
    }
  }
}
