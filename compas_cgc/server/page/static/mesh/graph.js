/** The edges of a mesh: neighbours, boundary, and paths along edges. */

/** Neighbours of every vertex, and the boundary vertices. */
export class Graph {
  /**
   * @param {Uint32Array} faces vertices, three per face
   * @param {number} count of vertices
   */
  constructor(faces, count) {
    const owners = new Map();
    for (let corner = 0; corner < faces.length; corner++) {
      const next = corner % 3 === 2 ? corner - 2 : corner + 1;
      const key = edgeKey(faces[corner], faces[next], count);
      owners.set(key, (owners.get(key) ?? 0) + 1);
    }
    this.count = count;
    this.near = Array.from({ length: count }, () => []);
    this.rim = Array.from({ length: count }, () => []);
    for (const [key, faced] of owners) {
      const [u, v] = [Math.floor(key / count), key % count];
      this.near[u].push(v);
      this.near[v].push(u);
      if (faced === 1) {
        this.rim[u].push(v);
        this.rim[v].push(u);
      }
    }
  }

  /**
   * Return the shortest path along edges close to the straight line, empty if there is none.
   * @param {ArrayLike<number>} xyz
   * @param {number} from
   * @param {number} to
   * @returns {number[]} vertices
   */
  way(xyz, from, to) {
    const straight = direction(xyz, from, to);
    const cost = new Float64Array(this.count).fill(Infinity);
    const before = new Int32Array(this.count).fill(-1);
    const heap = new Heap();
    cost[from] = 0;
    heap.push(0, from);
    for (;;) {
      const here = heap.pop();
      if (here === undefined) return [];
      if (here === to) break;
      for (const next of this.near[here]) {
        const length = distance(xyz, here, next);
        // Deviation from the line has a cost, so that the straightest of equally long paths is selected.
        const price = cost[here] + length + 0.6 * straight(next) * (length / (distance(xyz, from, to) || 1));
        if (price < cost[next]) {
          cost[next] = price;
          before[next] = here;
          heap.push(price, next);
        }
      }
    }
    const path = [to];
    while (path[0] !== from) path.unshift(before[path[0]]);
    return path;
  }

  /**
   * Return the boundary path between corners through a vertex, empty if the vertex is not on the boundary.
   * @param {number} vertex
   * @param {Set<number>} corners
   * @returns {number[]}
   */
  side(vertex, corners) {
    if (!this.rim[vertex].length) return [];
    const run = [vertex];
    for (const [k, first] of this.rim[vertex].entries()) {
      let [last, here] = [vertex, first];
      // A corner selects the side that starts at it.
      if (k && corners.has(vertex)) break;
      while (here !== undefined && here !== vertex) {
        if (k) run.unshift(here);
        else run.push(here);
        if (corners.has(here)) break;
        const next = this.rim[here].find((each) => each !== last);
        [last, here] = [here, next];
      }
      if (here === vertex) break;
    }
    return run;
  }
}

/**
 * Number the regions between creases in the order of their first faces, like the server.
 * @param {Uint32Array} faces
 * @param {number[][]} creases paths of vertices
 * @param {number} count of vertices
 * @returns {number[]} region of every face
 */
export function regionsOf(faces, creases, count) {
  const folded = new Set(creases.flatMap((path) => path.slice(1).map((vertex, i) => edgeKey(path[i], vertex, count))));
  const across = new Map();
  for (let corner = 0; corner < faces.length; corner++) {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const key = edgeKey(faces[corner], faces[next], count);
    if (folded.has(key)) continue;
    if (across.has(key)) across.get(key).push(Math.floor(corner / 3));
    else across.set(key, [Math.floor(corner / 3)]);
  }
  const near = Array.from({ length: faces.length / 3 }, () => []);
  for (const both of across.values()) {
    for (const a of both) for (const b of both) if (a !== b) near[a].push(b);
  }
  const regions = new Array(near.length).fill(-1);
  let number = 0;
  for (let face = 0; face < near.length; face++) {
    if (regions[face] >= 0) continue;
    const waiting = [face];
    regions[face] = number;
    while (waiting.length) {
      for (const next of near[waiting.pop()]) {
        if (regions[next] < 0) {
          regions[next] = number;
          waiting.push(next);
        }
      }
    }
    number += 1;
  }
  return regions;
}

function edgeKey(u, v, count) {
  return Math.min(u, v) * count + Math.max(u, v);
}

function distance(xyz, u, v) {
  return Math.hypot(xyz[3 * u] - xyz[3 * v], xyz[3 * u + 1] - xyz[3 * v + 1], xyz[3 * u + 2] - xyz[3 * v + 2]);
}

/** Return a function for the distance of vertices from the straight line between two vertices. */
function direction(xyz, from, to) {
  const a = [0, 1, 2].map((k) => xyz[3 * from + k]);
  const b = [0, 1, 2].map((k) => xyz[3 * to + k] - a[k]);
  const square = b[0] ** 2 + b[1] ** 2 + b[2] ** 2 || 1;
  return (vertex) => {
    const c = [0, 1, 2].map((k) => xyz[3 * vertex + k] - a[k]);
    const share = (b[0] * c[0] + b[1] * c[1] + b[2] * c[2]) / square;
    return Math.hypot(...c.map((value, k) => value - share * b[k]));
  };
}

/** A priority queue of vertices by cost. */
class Heap {
  constructor() {
    this.items = [];
  }

  push(price, vertex) {
    const { items } = this;
    let at = items.length;
    items.push([price, vertex]);
    while (at) {
      const up = (at - 1) >> 1;
      if (items[up][0] <= items[at][0]) break;
      [items[up], items[at]] = [items[at], items[up]];
      at = up;
    }
  }

  pop() {
    const { items } = this;
    const first = items[0];
    const last = items.pop();
    if (items.length && last !== first) {
      items[0] = last;
      for (let at = 0; ; ) {
        const [left, right] = [2 * at + 1, 2 * at + 2];
        let least = at;
        if (left < items.length && items[left][0] < items[least][0]) least = left;
        if (right < items.length && items[right][0] < items[least][0]) least = right;
        if (least === at) break;
        [items[at], items[least]] = [items[least], items[at]];
        at = least;
      }
    }
    return first?.[1];
  }
}
