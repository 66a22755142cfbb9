/** What is seen on the surface: regions, K and its error, other curvatures, heights, stripes, and the way from the solution before. */

import { gaussianCurvature } from './curvature.js';
import { quadricCurvatures } from './mesh/quadrics.js';
import { roundAbove } from './numbers.js';

const ROOM = 1.5; // the darkest colours are for a K so much larger than any, or a surface of one K would be all dark
const FINE = 1e-6; // errors below this part of the target are shown as none
const ALIKE = 1e-4; // heights that differ by less, against the size of the surface, are shown as the same
const MOST = 0.98; // of the values are within the colours of a fit, whose largest stand alone

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
    this.before = null;
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
   * @param {?Float64Array} [K] where the server has measured it
   */
  measure(xyz, held, K = null) {
    this.held = new Set(held);
    this.xyz = xyz;
    this.fitted = null;
    if (K) this.K = K;
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
   * @returns {{K: number, target: ?number, held: boolean, height: number, unit: string}}
   */
  look(vertex) {
    const height = this.xyz[3 * vertex + 2];
    return { K: this.K[vertex], target: this.targets[vertex], held: this.held.has(vertex), height, unit: this.model.unit };
  }

  /** @returns {ReturnType<typeof quadricCurvatures>} curvatures of fitted quadrics */
  get fit() {
    this.fitted ??= quadricCurvatures(this.xyz, this.model.faces, this.model.graph.near, this.model.askedWith([...this.held]));
    return this.fitted;
  }

  /** Colour by what is chosen. */
  paint() {
    const { surface } = this.scene;
    surface.stripes(this.by === 'zebra');
    surface.edges.visible = this.by !== 'zebra';
    surface.extras.beside(this.by === 'before' && this.before ? this.model.toScene(this.before) : null);
    const shown = this.shown();
    if (shown) {
      const { values, limit, what, middle = 0 } = shown;
      const gaps = surface.colourValues(middle ? values.map((value) => value - middle) : values, limit);
      this.legend.show(what, limit, gaps, middle);
    } else {
      this.legend.hide();
      surface.colourRegions();
    }
    this.scene.draw();
  }

  /** Return values with their words and limits, null where regions are coloured. */
  shown() {
    const { curvatureUnit, unit } = this.model;
    const length = unit ? ` in ${unit}` : '';
    const bent = unit ? ` in 1/${unit}` : '';
    switch (this.by) {
      case 'curvature':
        return { values: this.K, limit: roundAbove(ROOM * largest(this.K)), what: `K in ${curvatureUnit}` };
      case 'error': {
        const values = this.K.map((K, vertex) => K - (this.targets[vertex] ?? Number.NaN));
        return { values, limit: roundAbove(Math.max(largest(values), FINE * largest(this.targets))), what: `K − target in ${curvatureUnit}` };
      }
      case 'fit':
        return { values: this.fit.K, limit: roundAbove(ROOM * most(this.fit.K)), what: `K by fitted quadrics in ${curvatureUnit}` };
      case 'mean':
        return { values: this.fit.H, limit: roundAbove(ROOM * most(this.fit.H)), what: `Mean curvature${bent}` };
      case 'largest':
        return { values: this.fit.largest, limit: roundAbove(ROOM * most(this.fit.largest)), what: `Largest curvature${bent}` };
      case 'smallest':
        return { values: this.fit.smallest, limit: roundAbove(ROOM * most(this.fit.smallest)), what: `Smallest curvature${bent}` };
      case 'height': {
        const values = Float64Array.from(this.targets, (_, vertex) => this.xyz[3 * vertex + 2]);
        const [low, high] = [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))];
        return { values, limit: (high - low) / 2 || 1, middle: (high + low) / 2, what: `Height${length}` };
      }
      case 'before': {
        if (!this.before) return null;
        const values = Float64Array.from(this.targets, (_, vertex) => this.xyz[3 * vertex + 2] - this.before[3 * vertex + 2]);
        return { values, limit: roundAbove(Math.max(largest(values), ALIKE * largest(this.xyz))), what: `Higher than the solution before${length}` };
      }
      default:
        return null;
    }
  }
}

function largest(values) {
  return values.reduce((high, value) => (Number.isFinite(value) ? Math.max(high, Math.abs(value)) : high), 0);
}

function most(values) {
  const sizes = Array.from(values, Math.abs)
    .filter(Number.isFinite)
    .sort((a, b) => a - b);
  return sizes[Math.floor(MOST * (sizes.length - 1))] ?? 0;
}
