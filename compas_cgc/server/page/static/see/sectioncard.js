/** The card with a section, updated with the surface. */

import { cut, drawSection } from './section.js';

/** The card. */
export class SectionCard {
  /**
   * @param {HTMLElement} room
   * @param {import('../scene.js').Scene} scene
   */
  constructor(room, scene) {
    this.room = room;
    this.scene = scene;
    this.ends = null;
    room.querySelector('button').addEventListener('click', () => this.close());
  }

  /**
   * Cut between two places.
   * @param {number[]} a
   * @param {number[]} b
   */
  open(a, b) {
    this.ends = [a, b];
    this.room.hidden = false;
  }

  /** Hide the section. */
  close() {
    this.ends = null;
    this.room.hidden = true;
    this.scene.surface?.extras.section([]);
    this.scene.draw();
  }

  /**
   * Cut a surface.
   * @param {import('../model.js').Model} model
   * @param {ArrayLike<number>} xyz
   */
  show(model, xyz) {
    if (!this.ends) return;
    const segments = cut(xyz, model.faces, this.ends[0], this.ends[1]);
    if (!segments.length) {
      this.close();
      return;
    }
    this.room.querySelector('span').textContent = drawSection(this.room.querySelector('svg'), segments, model.unit);
    this.scene.surface.extras.section(segments.flat().flatMap((point) => [...model.toScene(point.slice(0, 3))]));
    this.scene.draw();
  }
}
