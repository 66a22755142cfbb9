/** K, target and error under the pointer. */

import { readable } from './numbers.js';

/** A small card beside the pointer. */
export class Readout {
  /**
   * @param {HTMLElement} room
   * @param {import('./scene.js').Scene} scene
   * @param {(vertex: number) => {K: number, target: ?number, held: boolean}} look
   * @param {(region: number) => void} choose called when a region is clicked
   */
  constructor(room, scene, look, choose) {
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
    canvas.addEventListener('pointerup', (event) => {
      const still = down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4;
      down = null;
      const found = still && scene.pick(event.clientX, event.clientY);
      if (found) choose(found.region);
    });
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
    const { K, target, held } = this.look(found.vertex);
    const head = document.createElement('b');
    head.textContent = `Region ${found.region} · vertex ${found.vertex}`;
    const rows = Number.isFinite(K)
      ? [
          [readable(K), 'K'],
          [readable(target), 'target'],
          [target === null ? '–' : readable(K - target, 2), 'error'],
        ]
      : [['', held ? 'a support' : 'K is not asked here']];
    this.room.replaceChildren(head, ...rows.flatMap((row) => row.map(cell)));
    this.room.hidden = false;
    const frame = this.room.parentElement.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = this.room;
    const right = x - frame.left + 18 + width > frame.width;
    this.room.style.left = `${x - frame.left + (right ? -width - 14 : 18)}px`;
    this.room.style.top = `${Math.min(frame.height - height - 8, Math.max(8, y - frame.top + 14))}px`;
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
