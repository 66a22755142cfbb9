/** Supports, method and its options. */

import { asNumberField, numberOf } from './fields.js';
import { capitalised } from './words.js';

/** Fields of the panel except the regions. */
export class Settings {
  /**
   * @param {HTMLFormElement} panel
   * @param {import('./api.js').Api} api provides the methods
   * @param {{change: (key: string) => void, hold: (choice: string) => void}} listener `hold` is called when the supports change
   */
  constructor(panel, api, listener) {
    this.panel = panel;
    this.fields = panel.elements;
    this.text = panel.querySelector('#method-text');
    this.options = panel.querySelector('#options');
    this.methods = [];
    this.fields.method.addEventListener('change', () => {
      this.own = {};
      this.describe();
      listener.change('method');
    });
    this.options.addEventListener('change', ({ target }) => listener.change(`setting ${target.name}`));
    panel.querySelector('#supports').addEventListener('change', ({ target }) => listener.hold(target.value));
    this.own = {};
    this.load(api);
  }

  async load(api) {
    try {
      this.methods = await api.methods();
    } catch (error) {
      this.text.textContent = error.message;
      return;
    }
    this.fields.method.replaceChildren(...this.methods.map(({ name }) => new Option(capitalised(name), name)));
    if (this.model?.method) this.fields.method.value = this.model.method;
    this.describe();
  }

  /**
   * Use the settings of a model.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    this.model = model;
    this.own = model.settings;
    for (const input of this.fields.supports) input.disabled = !model.supports[input.value]?.length && input.value !== model.choice;
    this.fields.supports.value = model.choice;
    this.panel.querySelector('[value="file"] + span').textContent = model.drawn ? 'As drawn' : 'As given';
    this.fields.method.selectedIndex = 0;
    if (model.method) this.fields.method.value = model.method;
    this.describe();
  }

  /** Whether all fields are valid; if not, the browser reports the error. */
  get valid() {
    return this.panel.reportValidity();
  }

  /** @returns {number[]} the vertices that are held */
  get supports() {
    return this.model.held;
  }

  /** @returns {{supports: number[], method: string, settings: object}} the same as fields of a request */
  get asked() {
    /** @type {any[]} */
    const fields = Array.from(this.options.querySelectorAll('input, select'));
    const given = fields.filter((field) => field.value !== '');
    const settings = Object.fromEntries(given.map((field) => [field.name, valueOf(field)]));
    return { supports: this.supports, method: this.fields.method.value || undefined, settings };
  }

  /** Show the description of the method and a field per option. */
  describe() {
    const method = this.methods[this.fields.method.selectedIndex];
    if (!method) return;
    const { own } = this;
    this.text.textContent = method.text;
    this.options.open = method.options.some(({ name }) => name in own);
    this.options.querySelector('.fields').replaceChildren(...method.options.map((option) => labelled(option, own[option.name])));
  }
}

/**
 * Return the field of an option; an empty field selects the default of the method.
 * @param {import('./types.js').Option} option its JSON schema, with a name and a description
 * @param {any} [value]
 * @returns {HTMLLabelElement}
 */
export function labelled(option, value) {
  const label = document.createElement('label');
  const name = document.createElement('abbr');
  const words = option.name.replaceAll('_', ' ');
  Object.assign(name, { textContent: words[0].toUpperCase() + words.slice(1), title: option.description });
  const choices = option.type?.includes('boolean') ? ['true', 'false'] : option.enum?.filter((choice) => choice !== null);
  const field = choices ? choiceField(choices, option.default) : numberField(option);
  field.name = option.name;
  field.value = value ?? '';
  label.append(name, field);
  return label;
}

function choiceField(choices, own) {
  const field = document.createElement('select');
  const said = { true: 'yes', false: 'no' }[own] ?? own;
  field.append(new Option(said === undefined || said === null ? 'default' : String(said), ''), ...choices.map((choice) => new Option(choice, choice)));
  return field;
}

function numberField(option) {
  const field = document.createElement('input');
  const whole = option.type?.includes('integer');
  if (!option.type || option.type === 'string') {
    Object.assign(field, { type: 'text', placeholder: option.type ? 'auto' : 'free' });
    return field;
  }
  asNumberField(field, { placeholder: option.default ?? 'auto' });
  if (whole) field.dataset.whole = 'true';
  for (const [limit, bound] of [
    ['min', option.minimum ?? option.exclusiveMinimum],
    ['max', option.maximum ?? option.exclusiveMaximum],
  ]) {
    if (bound !== undefined) field.dataset[limit] = String(bound);
  }
  return field;
}

/**
 * Return the JSON value of a field.
 * @param {HTMLInputElement | HTMLSelectElement} field
 * @returns {number | string | boolean}
 */
export function valueOf(field) {
  if (field instanceof HTMLInputElement && field.classList.contains('number')) return numberOf(field);
  return { true: true, false: false }[field.value] ?? field.value;
}
