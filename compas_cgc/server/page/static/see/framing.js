/** Where on the screen a surface is shown whole: what lies over the view leaves an area free, and the camera stands as near as that allows. */

const GAP = 10; // pixels between the surface and what lies over the view

/**
 * @typedef {object} Area a rectangle in pixels
 * @property {number} left
 * @property {number} top
 * @property {number} right
 * @property {number} bottom
 */

/**
 * Return the area of a view that some boxes leave free: each takes the side away that costs least.
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
 * Return where the camera looks, and from how far, to see all points as large as can be.
 * @param {ArrayLike<number>} xyz points, three after three
 * @param {{right: number[], up: number[], back: number[]}} axes of the camera
 * @param {{across: number, upward: number}} tangents of half of the angles it sees
 * @returns {{target: number[], far: number}}
 */
export function framing(xyz, { right, up, back }, { across, upward }) {
  // Along each axis of the screen the outermost points of both sides set the distance, and the middle between them the target.
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
