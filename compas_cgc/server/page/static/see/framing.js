/** Fit of a surface into the area of the view that is not covered by other elements. */

const GAP = 10; // distance between the surface and elements over the view [pixel]

/**
 * @typedef {object} Area a rectangle in pixels
 * @property {number} left
 * @property {number} top
 * @property {number} right
 * @property {number} bottom
 */

/**
 * Return the area of a view not covered by boxes: each box removes the side that reduces the area least.
 * @param {Area} view
 * @param {Area[]} boxes
 * @returns {Area} from the left and upper end of the view
 */
export function freeArea(view, boxes) {
  let free = { left: GAP, top: GAP, right: view.right - view.left - GAP, bottom: view.bottom - view.top - GAP };
  for (const box of boxes) {
    const [left, top] = [box.left - view.left - GAP, box.top - view.top - GAP];
    const [right, bottom] = [box.right - view.left + GAP, box.bottom - view.top + GAP];
    if (left >= free.right || right <= free.left || top >= free.bottom || bottom <= free.top) continue;
    const rests = [
      { ...free, left: right },
      { ...free, top: bottom },
      { ...free, right: left },
      { ...free, bottom: top },
    ];
    free = rests.reduce((a, b) => (sizeOf(b) > sizeOf(a) ? b : a));
  }
  return free;
}

/** @param {Area} area */
function sizeOf({ left, top, right, bottom }) {
  return Math.max(0, right - left) * Math.max(0, bottom - top);
}

/**
 * Return target and distance of the camera for which all points fill the view.
 * @param {ArrayLike<number>} xyz points, three numbers each
 * @param {{right: number[], up: number[], back: number[]}} axes of the camera
 * @param {{across: number, upward: number}} tangents of half of the angles of view
 * @returns {{target: number[], far: number}}
 */
export function framing(xyz, { right, up, back }, { across, upward }) {
  // Along each screen axis, the outermost points of both sides determine the distance, and their midpoint the target.
  const most = { right: -Infinity, left: -Infinity, top: -Infinity, bottom: -Infinity, back: -Infinity, front: Infinity };
  for (let k = 0; k < xyz.length; k += 3) {
    const along = (axis) => axis[0] * xyz[k] + axis[1] * xyz[k + 1] + axis[2] * xyz[k + 2];
    const [x, y, z] = [along(right) / across, along(up) / upward, along(back)];
    most.right = Math.max(most.right, z + x);
    most.left = Math.max(most.left, z - x);
    most.top = Math.max(most.top, z + y);
    most.bottom = Math.max(most.bottom, z - y);
    most.back = Math.max(most.back, z);
    most.front = Math.min(most.front, z);
  }
  const middle = [(across * (most.right - most.left)) / 2, (upward * (most.top - most.bottom)) / 2, (most.back + most.front) / 2];
  const target = [0, 1, 2].map((k) => middle[0] * right[k] + middle[1] * up[k] + middle[2] * back[k]);
  return { target, far: Math.max(most.right + most.left, most.top + most.bottom) / 2 - middle[2] };
}
