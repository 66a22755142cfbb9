/** Effects of the tools on a design. */

import { heldIn, withCrease, withHeld, withoutCrease } from '../design/edits.js';
import { Hand } from './hand.js';

const ROOM = 0.12; // height of a new clear volume above the lowest point, relative to the size of the model

/**
 * Connect the tools over the view to the design.
 * @param {import('../studio.js').Studio} studio
 * @param {HTMLElement} menu menu of the tools
 * @returns {Hand & {take: (tool: string) => void}}
 */
export function toolsOf(studio, menu) {
  const { scene, section, goals } = studio;
  const take = (tool) => {
    menu.querySelector(`[value="${tool}"]`).checked = true;
    hand.choose(tool);
  };
  const tidy = (value) => Number(value.toPrecision(3));
  const hand = new Hand(scene, {
    // Release the vertices if all of them are supported.
    hold: (vertices) => {
      const held = new Set(heldIn(studio.data));
      studio.edit(withHeld(studio.data, vertices, !vertices.every((vertex) => held.has(vertex))));
    },
    fold: (path) => studio.edit(withCrease(studio.data, path)),
    erase: (vertex) => {
      if (studio.model.onCrease[vertex]) studio.edit(withoutCrease(studio.data, vertex));
    },
    region: (region) => studio.regions.focus(region),
    section: (...ends) => {
      const [a, b] = ends.map((vertex) => Array.from(studio.shown.slice(3 * vertex, 3 * vertex + 3)));
      section.open(a, b);
      section.show(studio.model, studio.shown);
    },
    // A clear volume between two points on the ground.
    box: (a, b) => {
      const height = tidy(studio.model.bounds.low[2] + ROOM * studio.model.size);
      goals.put({ x0: tidy(a[0]), y0: tidy(a[1]), x1: tidy(b[0]), y1: tidy(b[1]), height });
      take('look');
    },
    look: () => take('look'),
  });
  return Object.assign(hand, { take });
}
