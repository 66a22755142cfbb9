/** A model as the page works with it. */

import { regionColour } from './colours.js';
import { heldIn } from './design/edits.js';
import { Graph } from './mesh/graph.js';
import { pack } from './packed.js';

/** A mesh with its supports, targets and goals. */
export class Model {
  /** @param {import('./types.js').Data} data answer of /api/v1/models, /api/v1/drawings or /api/v1/examples/NAME */
  constructor(data) {
    this.name = data.name;
    this.file = data.file ?? null;
    this.unit = data.unit;
    this.notes = data.notes;
    this.problems = data.problems;
    this.supports = data.supports;
    this.choice = data.support_choice;
    this.held = heldIn(data);
    this.creases = data.creases;
    this.goals = data.goals;
    this.targets = data.targets;
    this.vertexTargets = data.vertex_targets;
    /** @type {Record<string, string>} those other than constant K, by region */
    this.laws = data.laws ?? {};
    this.settings = data.settings ?? {};
    this.method = data.method ?? null;
    this.names = data.names ?? [];
    this.colours = data.colours ?? [];
    this.heights = data.heights ?? {};
    this.ground = data.ground ?? null;
    this.drawn = 'columns' in data;
    this.vertices = data.vertices;
    this.triangles = data.faces;
    /** @type {?Graph} */
    this.edges = null;
    this.packed = null;
    this.own = null; // data of the drawing, while the surface has other faces
    this.count = data.vertices.length;
    this.xyz = Float64Array.from(data.vertices.flat());
    this.faces = Uint32Array.from(data.faces.flat());
    this.regions = Uint32Array.from(data.regions);
    this.regionOf = new Int32Array(this.count).fill(-1);
    this.regions.forEach((region, face) => {
      for (let k = 0; k < 3; k++) this.regionOf[this.faces[3 * face + k]] = region;
    });
    this.onCrease = new Uint8Array(this.count);
    for (const path of this.creases) for (const vertex of path) this.onCrease[vertex] = 1;
    this.areas = regionAreas(this.xyz, this.faces, this.regions, this.targets.length);
    const { centre, span, size } = frameOf(this.xyz);
    this.centre = centre;
    this.span = span;
    this.size = size;
  }

  /**
   * Use the faces of a surface with flipped edges, or those of the drawing; supports and targets remain unchanged.
   * @param {?Int32Array} faces their corners, null for those of the drawing
   * @returns {boolean} whether they are others than before
   */
  turn(faces) {
    if (!faces && !this.own) return false;
    this.own ??= { faces: this.faces, mesh: this.mesh, graph: this.graph };
    this.faces = faces ? Uint32Array.from(faces) : this.own.faces;
    if (!faces) this.own = null;
    return true;
  }

  /** @returns {{vertices: object, faces: object}} both as the server takes them quickest */
  get mesh() {
    this.packed ??= { vertices: pack(this.xyz, 'f8', [this.count, 3]), faces: pack(this.faces, 'i4', [this.triangles.length, 3]) };
    return this.packed;
  }

  /** @returns {Graph} its edges */
  get graph() {
    this.edges ??= new Graph(this.faces, this.count);
    return this.edges;
  }

  /**
   * Return the name of a region.
   * @param {number} region
   * @returns {string}
   */
  nameOf(region) {
    return this.names[region] ?? (this.targets.length === 1 ? 'Surface' : `Region ${region}`);
  }

  /**
   * Return the colour of a region.
   * @param {number} region
   * @returns {string}
   */
  colourOf(region) {
    return this.colours[region] ?? regionColour(region);
  }

  /** @returns {{low: number[], high: number[]}} its corners */
  get bounds() {
    const half = [0, 1, 2].map((axis) => this.span[axis] / 2);
    return { low: this.centre.map((value, axis) => value - half[axis]), high: this.centre.map((value, axis) => value + half[axis]) };
  }

  /**
   * Return the unit of curvature.
   * @returns {string}
   */
  get curvatureUnit() {
    return `1/${this.unit || 'unit'}²`;
  }

  /**
   * Return coordinates in the frame of the scene: centred, at unit size.
   * @param {ArrayLike<number>} xyz
   * @returns {Float32Array}
   */
  toScene(xyz) {
    const [x, y, z] = this.centre;
    const found = new Float32Array(xyz.length);
    for (let k = 0; k < found.length; k += 3) {
      found[k] = (xyz[k] - x) / this.size;
      found[k + 1] = (xyz[k + 1] - y) / this.size;
      found[k + 2] = (xyz[k + 2] - z) / this.size;
    }
    return found;
  }

  /**
   * Return the largest |K| on the slider of a region: half that of a hemisphere over its area, or more if the
   * file has a larger target.
   * @param {number} region
   * @returns {number}
   */
  reach(region) {
    return Math.max((0.5 * Math.PI) / this.areas[region], 2 * Math.abs(this.targets[region] ?? 0));
  }

  /**
   * Return the target of every vertex, null where none is set.
   * @param {(?number)[]} targets per region, null for the targets of the file
   * @returns {(?number)[]}
   */
  targetsOfVertices(targets) {
    return Array.from(this.regionOf, (region, vertex) => {
      if (this.onCrease[vertex] || region < 0) return null;
      return targets[region] ?? this.vertexTargets?.[vertex] ?? null;
    });
  }

  /**
   * Return the vertices at which K is measured for given supports: all except supports, creases and free edges.
   * @param {number[]} supports
   * @returns {Uint8Array}
   */
  askedWith(supports) {
    const asked = Uint8Array.from(this.onCrease, (on) => 1 - on);
    for (const vertex of this.supports.boundary) asked[vertex] = 0;
    for (const vertex of supports) asked[vertex] = 0;
    return asked;
  }
}

function frameOf(xyz) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  xyz.forEach((value, i) => {
    low[i % 3] = Math.min(low[i % 3], value);
    high[i % 3] = Math.max(high[i % 3], value);
  });
  const span = high.map((value, axis) => value - low[axis]);
  return { centre: low.map((value, axis) => 0.5 * (value + high[axis])), span, size: 0.5 * Math.hypot(...span) || 1 };
}

function regionAreas(xyz, faces, regions, count) {
  const areas = new Float64Array(count);
  regions.forEach((region, face) => {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * faces[3 * face + k]);
    const [u, v] = [b, c].map((at) => [0, 1, 2].map((axis) => xyz[at + axis] - xyz[a + axis]));
    areas[region] += 0.5 * Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
  });
  return areas;
}
