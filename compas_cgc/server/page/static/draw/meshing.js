/** Meshing of a drawing; the new mesh keeps targets and goals of the previous one. */

import { withHeight } from '../design/edits.js';
import { requestOf } from './plan.js';

/**
 * Mesh a drawing.
 * @param {import('../api.js').Api} api
 * @param {import('../types.js').State} state its plan and name, and its previous mesh if there is one
 * @returns {Promise<import('../types.js').Data>}
 */
export async function meshed(api, { plan, name, data: old }) {
  let data = await api.drawing(requestOf(plan, name || 'Roof'));
  const outside = data.columns.filter((vertex) => vertex < 0).length;
  if (outside) data.notes.push(`${outside} column${outside > 1 ? 's are' : ' is'} outside the outline`);
  for (const [k, vertex] of data.columns.entries()) if (vertex >= 0 && plan.columns[k].height) data = withHeight(data, [vertex], plan.columns[k].height);
  if (!old) return data;
  const alike = old.targets.length === data.targets.length;
  // Regions that a crease divides keep their K, where there is only one.
  const same = old.targets.every((/** @type {number} */ K) => K === old.targets[0]) ? { targets: data.targets.map(() => old.targets[0]) } : {};
  return { ...data, wishes: old.wishes, method: old.method, settings: old.settings, ...(alike ? { targets: old.targets, names: old.names, colours: old.colours } : same) };
}
