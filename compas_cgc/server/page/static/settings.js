/** Supports, method, s and e. */

const METHOD_TEXTS = {
  auto: 'The fastest that suits the model, and others if it does not arrive.',
  flow: 'The paper’s gradient flow, for K ≥ 0; s and e shape the creases.',
  newton: 'One unknown per vertex, for K > 0 over a held edge.',
  projection: 'The nearest fair surface; any K, free edges.',
};

/** The fields of the panel besides the regions. */
export class Settings {
  /**
   * @param {HTMLFormElement} panel
   * @param {{change: () => void, hold: () => void}} listener `hold` is called when the supports are others
   */
  constructor(panel, listener) {
    this.panel = panel;
    this.fields = panel.elements;
    this.text = panel.querySelector('#method-text');
    this.flow = panel.querySelector('#flow');
    for (const name of ['method', 's', 'e']) {
      this.fields[name].addEventListener('change', () => {
        this.describe();
        listener.change();
      });
    }
    panel.querySelector('#supports').addEventListener('change', () => {
      listener.hold();
      listener.change();
    });
  }

  /**
   * Take the settings that a model comes with.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    this.model = model;
    for (const input of this.fields.supports) input.disabled = !model.supports[input.value].length;
    this.fields.supports.value = model.choice;
    this.fields.method.value = 'auto';
    this.fields.s.value = model.s;
    this.fields.e.value = model.e;
    this.describe();
  }

  /** Whether all fields hold what they may; if not, the browser says so. */
  get valid() {
    return this.panel.reportValidity();
  }

  /** @returns {number[]} the vertices that are held */
  get supports() {
    return this.model.supports[this.fields.supports.value];
  }

  /** @returns {{supports: number[], method: string, settings: object}} the same as fields of a request */
  get asked() {
    const { method, s, e } = this.fields;
    const settings = method.value === 'flow' ? { s: s.valueAsNumber, e: e.valueAsNumber } : {};
    return { supports: this.supports, method: method.value, settings };
  }

  describe() {
    const { value } = this.fields.method;
    this.text.textContent = METHOD_TEXTS[value];
    this.flow.hidden = value !== 'flow';
  }
}
