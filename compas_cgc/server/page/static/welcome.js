/** How a model comes in: dropped, chosen, or one of the examples. */

const KINDS = ['3dm', 'obj'];

/** The first page, and files dropped anywhere. */
export class Welcome {
  /**
   * @param {HTMLElement} room
   * @param {import('./api.js').Api} api
   * @param {(data: object) => void} open
   */
  constructor(room, api, open) {
    this.room = room;
    this.api = api;
    this.open = open;
    this.latest = 0;
    this.trouble = room.querySelector('.trouble');
    const input = room.querySelector('input[type="file"]');
    input.addEventListener('change', () => {
      const [file] = input.files;
      if (file) this.file(file);
      // The same file again is a change too.
      input.value = '';
    });
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
      if (file) this.file(file);
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
    Object.assign(picture, { src: `/page/examples/${name}.png`, alt: '', width: 320, height: 200 });
    card.dataset.example = name;
    head.textContent = title;
    words.textContent = text;
    card.append(picture, head, words);
    card.addEventListener('click', () => this.load(() => this.api.example(name)));
    return card;
  }

  file(file) {
    const kind = file.name.split('.').pop().toLowerCase();
    // A .3dm is kept: the result goes back into it.
    const kept = kind === '3dm' ? file : null;
    if (KINDS.includes(kind)) this.load(async () => ({ ...(await this.api.model(file, kind)), file: kept }));
    else this.say(`“${file.name}” is neither a .3dm nor an .obj file. Save the mesh as one of these and drop it again.`);
  }

  async load(read) {
    const turn = ++this.latest;
    document.body.classList.add('reading');
    this.say('');
    try {
      const data = await read();
      if (turn === this.latest) this.open(data);
    } catch (error) {
      if (turn === this.latest) this.say(error.message);
    } finally {
      if (turn === this.latest) document.body.classList.remove('reading');
    }
  }

  say(text) {
    this.trouble.textContent = text;
    this.trouble.hidden = !text;
    if (text) this.room.hidden = false;
  }
}
