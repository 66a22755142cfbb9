/** K, target and error under the pointer. */

import { readable } from './numbers.js';

/** A small card beside the pointer. */
export class Readout {
  /**
   * @param {HTMLElement} room
   * @param {import('./scene.js').Scene} scene
   * @param {(vertex: number) => {K: number, target: ?number, asked: boolean, held: boolean, height: number, unit: string}} look
   */
  constructor(room, scene, look) {
    this.room = room;
    this.scene = scene;
    this.look = look;
    this.waiting = false;
    const { canvas } = scene;
    let down = null;
    canvas.addEventListener('pointerdown', (event) => {
      down = [event.clientX, event.clientY];
      this.hide();
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, () => (down = null));
    canvas.addEventListener('pointermove', (event) => {
      if (!down) this.follow(event.clientX, event.clientY);
    });
    canvas.addEventListener('pointerleave', () => this.hide());
  }

  follow(x, y) {
    this.place = [x, y];
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      if (this.place) this.show(...this.place);
    });
  }

  show(x, y) {
    const found = this.scene.pick(x, y);
    if (!found) {
      this.hide();
      return;
    }
    const { K, target, asked, held, height, unit } = this.look(found.vertex);
    const head = document.createElement('b');
    head.textContent = `${this.scene.surface.model.nameOf(found.region)} · vertex ${found.vertex}`;
    const rows = asked
      ? [
          [readable(K), 'K'],
          [readable(target), 'target'],
          [readable(target === null ? null : K - target, 2), 'error'],
        ]
      : [['', held ? 'a support' : 'K is not prescribed here']];
    rows.push([`${readable(height)}${unit ? ` ${unit}` : ''}`, 'height']);
    this.room.replaceChildren(head, ...rows.flatMap((row) => row.map(cell)));
    this.room.hidden = false;
    const frame = this.room.parentElement.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: tall } = this.room;
    const right = x - frame.left + 18 + width > frame.width;
    this.room.style.left = `${x - frame.left + (right ? -width - 14 : 18)}px`;
    this.room.style.top = `${Math.min(frame.height - tall - 8, Math.max(8, y - frame.top + 14))}px`;
  }

  hide() {
    this.place = null;
    this.room.hidden = true;
  }
}

function cell(text) {
  const made = document.createElement('span');
  made.textContent = text;
  return made;
}
