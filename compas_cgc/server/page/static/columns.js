/** Fields for the heights of isolated supports. */

import { asNumberField, numberOf } from './fields.js';
import { readable } from './numbers.js';

const MAX_ROWS = 12;

/**
 * List the isolated supports with their heights.
 * @param {HTMLElement} room
 * @param {import('./model.js').Model} model
 * @param {number[]} held
 * @param {(vertices: number[], height: number) => void} change
 */
export function showColumns(room, model, held, change) {
  const set = new Set(held);
  const alone = held.filter((vertex) => !model.graph.near[vertex].some((next) => set.has(next)));
  const rows = alone.length > MAX_ROWS ? [] : alone;
  room.hidden = !rows.length;
  room.replaceChildren(
    ...rows.map((vertex, number) => {
      const row = document.createElement('li');
      const [label, words, field] = ['label', 'span', 'input'].map((tag) => document.createElement(tag));
      const [x, y] = (model.ground ?? model.vertices)[vertex];
      words.textContent = `Support at ${readable(x)}, ${readable(y)}`;
      const height = model.heights[vertex] ?? 0;
      asNumberField(field, { value: height || '', placeholder: '0', ariaLabel: `Height of support ${number + 1}`, title: 'Height above the drawn position' });
      field.addEventListener('change', () => change([vertex], numberOf(field) || 0));
      label.append(words, field);
      row.append(label);
      return row;
    }),
  );
}
