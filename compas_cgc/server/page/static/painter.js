/** Colours of the surface: regions, K and its error, other curvatures, heights, stripes, and the change from the previous solution. */

import { gaussianCurvature } from './curvature.js';
import { quadricCurvatures } from './mesh/quadrics.js';
import { roundAbove } from './numbers.js';

const ROOM = 1.5; // upper end of the colour scale relative to the largest K, so that a surface of constant K is not uniformly dark
const FINE = 1e-6; // errors below this fraction of the target are shown as zero
const ALIKE = 1e-4; // height differences below this fraction of the size are shown as zero
const QUANTILE = 0.98; // of the fitted values, upper end of their colour scale, as the largest are outliers

/** Stores K and its targets, and colours the surface. */
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
   * Switch to a model.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    this.model = model;
  }

  /**
   * Update K of a surface.
   * @param {ArrayLike<number>} xyz
   * @param {number[]} held vertices
   * @param {?Float64Array} [K] K measured by the server
   */
  measure(xyz, held, K = null) {
    this.held = new Set(held);
    this.xyz = xyz;
    this.fitted = null;
    if (K) this.K = K;
    else this.K = gaussianCurvature(xyz, this.model.faces, this.model.askedWith(held));
  }

  /**
   * Update the targets.
   * @param {(?number)[]} targets per region
   */
  want(targets) {
    this.targets = this.model.targetsOfVertices(targets);
  }

  /**
   * Return the data of a vertex.
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

  /** Colour by the selected quantity. */
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

  /** Return the values with label and limits, null for colours of regions. */
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
        return { values, limit: roundAbove(Math.max(largest(values), ALIKE * largest(this.xyz))), what: `Height above the previous solution${length}` };
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
  return sizes[Math.floor(QUANTILE * (sizes.length - 1))] ?? 0;
}
