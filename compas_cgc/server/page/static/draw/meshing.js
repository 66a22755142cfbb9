/** From a drawing to a mesh with what was asked of the one before. */

import { withHeight } from '../design/edits.js';
import { requestOf } from './plan.js';

/**
 * Have a drawing meshed.
 * @param {import('../api.js').Api} api
 * @param {import('../types.js').State} state its plan and name, and the mesh made of it before, where there is one
 * @returns {Promise<import('../types.js').Data>}
 */
export async function meshed(api, { plan, name, data: old }) {
  let data = await api.drawing(requestOf(plan, name || 'Roof'));
  const outside = data.columns.filter((vertex) => vertex < 0).length;
  if (outside) data.notes.push(`${outside} column${outside > 1 ? 's stand' : ' stands'} outside of the outline`);
  for (const [k, vertex] of data.columns.entries()) if (vertex >= 0 && plan.columns[k].height) data = withHeight(data, [vertex], plan.columns[k].height);
  if (!old) return data;
  const alike = old.targets.length === data.targets.length;
  return { ...data, wishes: old.wishes, method: old.method, settings: old.settings, ...(alike ? { targets: old.targets, names: old.names, colours: old.colours } : {}) };
}
