/** K on the surface, and the colours for it. */

import { gaussianCurvature } from './curvature.js';
import { roundAbove } from './numbers.js';

const ROOM = 1.5; // the darkest colours are for a K so much larger than any, or a surface of one K would be all dark
const FINE = 1e-6; // errors below this part of the target are shown as none

/** Knows K and its targets, and colours by them. */
export class Painter {
  /**
   * @param {import('./scene.js').Scene} scene
   * @param {import('./legend.js').Legend} legend
   */
  constructor(scene, legend) {
    this.scene = scene;
    this.legend = legend;
    this.by = 'regions';
  }

  /**
   * Begin with a model.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    this.model = model;
  }

  /**
   * Take note of K on a surface.
   * @param {ArrayLike<number>} xyz
   * @param {number[]} held vertices
   * @param {?(?number)[]} [K] where the server has measured it
   */
  measure(xyz, held, K = null) {
    this.held = new Set(held);
    if (K) this.K = Float64Array.from(K, (value) => value ?? Number.NaN);
    else this.K = gaussianCurvature(xyz, this.model.faces, this.model.askedWith(held));
  }

  /**
   * Take note of what is asked.
   * @param {(?number)[]} targets per region
   */
  want(targets) {
    this.targets = this.model.targetsOfVertices(targets);
  }

  /**
   * Tell about a vertex.
   * @param {number} vertex
   * @returns {{K: number, target: ?number, held: boolean}}
   */
  look(vertex) {
    return { K: this.K[vertex], target: this.targets[vertex], held: this.held.has(vertex) };
  }

  /** Colour by what is chosen. */
  paint() {
    const { surface } = this.scene;
    if (this.by === 'regions') {
      this.legend.hide();
      surface.colourRegions();
    } else {
      const error = this.by === 'error';
      const values = error ? this.K.map((K, vertex) => K - (this.targets[vertex] ?? Number.NaN)) : this.K;
      const limit = roundAbove(error ? Math.max(largest(values), FINE * largest(this.targets)) : ROOM * largest(values));
      const gaps = surface.colourValues(values, limit);
      this.legend.show(`${error ? 'K − target' : 'K'} in ${this.model.curvatureUnit}`, limit, gaps);
    }
    this.scene.draw();
  }
}

function largest(values) {
  return values.reduce((most, value) => (Number.isFinite(value) ? Math.max(most, Math.abs(value)) : most), 0);
}
