/** Goals of a design in the format of the server. */

/**
 * Return the fields of a request for the goals.
 * @param {object[]} held goals of the model
 * @param {import('../types.js').Goals} [goals] rise, above, below [L]; found: K is unknown; edge: free edges stay on their lines in plan; boxes to keep clear
 * @returns {{goals?: object[], unknown?: string}}
 */
export function asked(held, { rise = null, above = null, below = null, found = false, edge = false, boxes = [] } = {}) {
  /** @type {object[]} */
  const list = [...held];
  if (rise !== null) list.push({ kind: 'rise', rise });
  if (above !== null) list.push({ kind: 'above', height: above });
  if (below !== null) list.push({ kind: 'below', height: below });
  if (edge) list.push({ kind: 'edge in plan' });
  for (const { x0, y0, x1, y1, height } of boxes) {
    list.push({ kind: 'clearance', where: [Math.min(x0, x1), Math.min(y0, y1), Math.max(x0, x1), Math.max(y0, y1)], height });
  }
  return { ...(list.length ? { goals: list } : {}), ...(found && rise !== null ? { unknown: 'all' } : {}) };
}
