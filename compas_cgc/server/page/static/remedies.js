/** Remedies for a rough surface or a failed solve: each changes the design and solves it again. */

import { heldIn, withChoice } from './design/edits.js';
import { requestOf } from './draw/plan.js';

const MARGIN = 0.95; // of the largest feasible K, as it is found within 5 %
const FINER = 0.7; // factor of the edge length
const MORE_STEPS = 5; // factor of the number of steps

/**
 * @typedef {object} Remedy
 * @property {string} text
 * @property {() => void | Promise<void>} act
 */

/**
 * Return the remedies for the present design, the most promising first.
 * @param {import('./studio.js').Studio} studio
 * @returns {Remedy[]}
 */
export function remediesFor(studio) {
  const { data, history, solving } = studio;
  /** @type {Remedy[]} */
  const found = [];
  const given = data.targets.some((K) => K) && !data.wishes?.found;
  const scale = (factor) => solve({ ...studio.data, targets: studio.data.targets.map((K) => (K ? Number((K * factor).toPrecision(3)) : K)) });
  const solve = (changed) => {
    studio.edit(changed);
    solving.begin();
  };
  if (solving.result?.status === 'step_limit') {
    const steps = MORE_STEPS * solving.result.iterations;
    found.push({ text: `Allow ${steps} steps`, act: () => solve({ ...studio.data, settings: { ...studio.data.settings, steps } }) });
  }
  if (given) {
    found.push({
      text: 'Set the largest feasible K',
      act: async () => {
        const factor = await studio.limit.find();
        if (factor) scale(Math.min(1, factor) * MARGIN);
      },
    });
    found.push({ text: 'Halve K', act: () => scale(0.5) });
  }
  if (data.supports.boundary && !isSame(heldIn(data), data.supports.boundary)) {
    found.push({ text: 'Support the whole edge', act: () => solve(withChoice(studio.data, 'boundary')) });
  }
  const { plan, name } = history.now;
  if (plan) {
    const edge = requestOf(plan, name || 'Roof').edge_length * FINER;
    found.push({
      text: 'Mesh finer',
      act: async () => {
        studio.draw({ plan: { ...plan, edge: Number(edge.toPrecision(3)) } });
        await studio.mesh();
        if (!solving.solver.busy) solving.begin();
      },
    });
  }
  return found;
}

/** Check whether two lists hold the same vertices. */
function isSame(one, other) {
  const all = new Set(other);
  return one.length === other.length && one.every((vertex) => all.has(vertex));
}
