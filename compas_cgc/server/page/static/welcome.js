/** Opening of a model: drawn, dropped, chosen, stored, or an example. */

import { fromText } from './design/packing.js';

const DESIGN = 'json';
const LARGEST = 64 * 2 ** 20; // bytes

/** The start page, and files dropped anywhere. */
export class Welcome {
  /**
   * @param {HTMLElement} room
   * @param {import('./api.js').Api} api
   * @param {{open: (data: import('./types.js').Data, again?: (() => void) | null) => void, draw: (plan: ?import('./draw/plan.js').Plan, name: string) => void, state: (state: import('./types.js').State) => void, edge: (text: string) => Promise<?number>, design: (file: File, dropped: boolean) => boolean}} listener
   */
  constructor(room, api, listener) {
    this.room = room;
    this.api = api;
    this.listener = listener;
    this.latest = 0;
    this.trouble = room.querySelector('.trouble');
    this.opening = room.querySelector('#opening');
    /** @type {HTMLInputElement} */
    const input = room.querySelector('input[type="file"]');
    this.meshes = input.dataset.meshes.split(' ');
    this.plans = input.dataset.plans.split(' ');
    input.addEventListener('change', () => {
      const [file] = input.files;
      if (file) this.file(file);
      // Choosing the same file again must trigger a change event.
      input.value = '';
    });
    room.querySelector('#begin').addEventListener('click', () => listener.draw(null, ''));
    this.takeDrops();
    this.list();
  }

  takeDrops() {
    const { body } = document;
    const over = (on) => body.classList.toggle('over', on);
    window.addEventListener('dragover', (event) => {
      event.preventDefault();
      over(true);
    });
    window.addEventListener('dragleave', (event) => {
      if (!event.relatedTarget) over(false);
    });
    window.addEventListener('drop', (event) => {
      event.preventDefault();
      over(false);
      const [file] = event.dataTransfer.files;
      if (file && !this.listener.design(file, true)) this.file(file);
    });
  }

  async list() {
    try {
      const found = await this.api.examples();
      this.room.querySelector('.examples').replaceChildren(...found.map((example) => this.card(example)));
    } catch (error) {
      this.say(error.message);
    }
  }

  card({ name, title, text }) {
    const card = document.createElement('button');
    const [picture, head, words] = ['img', 'strong', 'span'].map((tag) => document.createElement(tag));
    Object.assign(card, { type: 'button', className: 'example' });
    Object.assign(picture, { src: `page/examples/${name}.png`, alt: '', width: 320, height: 200 });
    card.dataset.example = name;
    head.textContent = title;
    words.textContent = text;
    card.append(picture, head, words);
    card.addEventListener('click', () => this.load(`Preparing “${title}”`, async () => this.listener.open(await this.api.example(name))));
    return card;
  }

  /**
   * List the stored designs.
   * @param {import('./types.js').State[]} designs
   * @param {{take: (design: import('./types.js').State) => void, drop: (design: import('./types.js').State) => void}} act
   */
  offer(designs, act) {
    const rows = designs.map((design) => {
      const row = document.createElement('li');
      const [open, head, when, drop] = ['button', 'strong', 'span', 'button'].map((tag) => document.createElement(tag));
      Object.assign(open, { type: 'button', className: 'kept' });
      head.textContent = design.name || 'Roof';
      when.textContent = new Date(design.time).toLocaleString([], { dateStyle: 'medium', timeStyle: 'short' });
      open.append(head, when);
      open.addEventListener('click', () => act.take(design));
      Object.assign(drop, { type: 'button', className: 'small', textContent: '×', title: 'Delete', ariaLabel: `Delete ${head.textContent}` });
      drop.addEventListener('click', () => {
        act.drop(design);
        row.remove();
        this.room.querySelector('#recent').hidden = !this.room.querySelector('#recent li');
      });
      row.append(open, drop);
      return row;
    });
    this.room.querySelector('#recent ul').replaceChildren(...rows);
    this.room.querySelector('#recent').hidden = !rows.length;
  }

  /** @param {File} file */
  file(file) {
    const kind = file.name.split('.').pop().toLowerCase();
    const size = file.size > 1e6 ? `, ${(file.size / 1e6).toFixed(1)} MB` : '';
    if (file.size > LARGEST) this.say(`“${file.name}” is larger than 64 MB, the limit of the server. Save only the mesh, its supports and creases to a file.`);
    else if (this.meshes.includes(kind)) this.load(`Opening “${file.name}”${size}`, () => this.model(file, kind));
    else if (this.plans.includes(kind)) this.load(`Opening “${file.name}”${size}`, () => this.plan(file, kind));
    else if (kind === DESIGN) this.load(`Opening “${file.name}”${size}`, async () => this.listener.state(fromText(await file.text())));
    else if (!this.listener.design(file, false)) this.say(`“${file.name}” has an unsupported format. Save the mesh or the curves as ${[...new Set([...this.meshes, ...this.plans])].map((own) => `.${own}`).join(', ')} and drop the file again.`);
  }

  /** Open the curves of a file on the drawing board. */
  async plan(file, kind) {
    this.draw(await this.api.plan(file, kind), file);
  }

  /** @param {import('./draw/plan.js').Plan} plan */
  draw(plan, file) {
    this.listener.draw(plan, file.name.replace(/\.[^.]*$/, ''));
  }

  /** Return the drawing in a file without a mesh; null if its layers already define a problem, or no curve is closed. */
  async drawing(file, kind) {
    const plan = await this.api.plan(file, kind).catch(() => null);
    return plan?.lines.some(({ closed }) => closed) && !plan.lines.some(({ layer }) => layer.startsWith('CGC')) ? plan : null;
  }

  /** Open a file; if it holds curves or surfaces but no mesh, ask for an edge length. */
  async model(file, kind, edge = null) {
    // Keep a .3dm file: the result is merged into it.
    const kept = kind === '3dm' ? file : null;
    try {
      const data = await this.api.model(file, kind, edge);
      const again = !edge && data.notes.some((note) => /edge length|meshed with edges/.test(note)) ? () => this.again(file, kind) : null;
      this.listener.open({ ...data, file: edge ? null : kept }, again);
    } catch (error) {
      if (edge || kind !== '3dm' || !/no mesh/.test(error.message)) throw error;
      const drawing = await this.drawing(file, kind);
      if (drawing) this.draw(drawing, file);
      else await this.again(file, kind, 'The file has no mesh. A mesh can be generated inside its closed curve, or on its surfaces.');
    }
  }

  async again(file, kind, text = 'An even mesh can be generated on the surfaces of the file.') {
    const edge = await this.listener.edge(text);
    if (edge) await this.load(`Meshing “${file.name}”`, () => this.model(file, kind, edge));
  }

  async load(words, read) {
    const turn = ++this.latest;
    const begin = performance.now();
    const tell = () => {
      const seconds = Math.round((performance.now() - begin) / 1000);
      this.opening.textContent = `${words} …${seconds > 1 ? ` ${seconds} s` : ''}`;
    };
    document.body.classList.add('reading');
    this.say('');
    tell();
    this.opening.hidden = false;
    const clock = setInterval(tell, 1000);
    try {
      await read();
    } catch (error) {
      if (turn === this.latest) this.say(error.message);
    } finally {
      clearInterval(clock);
      if (turn === this.latest) {
        this.opening.hidden = true;
        document.body.classList.remove('reading');
      }
    }
  }

  say(text) {
    this.trouble.textContent = text;
    this.trouble.hidden = !text;
    if (text) this.room.hidden = false;
  }
}
