/** Colours of the surface: regions, K and its error, other curvatures, heights, stripes, and the change from the previous solution. */

import { largest, roundAbove } from './numbers.js';

const ROOM = 1.5; // upper end of the colour scale relative to the largest K, so that a surface of constant K is not uniformly dark
const FINE = 1e-6; // errors below this fraction of the target are shown as zero
const ALIKE = 1e-4; // height differences below this fraction of the size are shown as zero
const QUANTILE = 0.98; // of the fitted values, upper end of their colour scale, as the largest are outliers
const MEASURED = ['curvature', 'error']; // colours by K as measured by the solver
const FITTED = ['fit', 'mean', 'largest', 'smallest']; // colours by curvatures of fitted quadrics

/** Stores the curvatures that the server measured, and colours the surface. */
export class Painter {
  /**
   * @param {import('./scene.js').Scene} scene
   * @param {import('./legend.js').Legend} legend
   * @param {(xyz: ArrayLike<number>) => Promise<import('./types.js').Curvatures>} ask measures a surface of the present model
   */
  constructor(scene, legend, ask) {
    this.scene = scene;
    this.legend = legend;
    this.ask = ask;
    this.by = 'regions';
    this.before = null;
    /** @type {?Float64Array} */
    this.K = null;
    /** @type {?import('./types.js').Curvatures} */
    this.fit = null;
    this.asking = false;
    this.trouble = '';
  }

  /**
   * Switch to a model.
   * @param {import('./model.js').Model} model
   */
  show(model) {
    if (this.model?.triangles !== model.triangles) this.K = this.fit = null;
    this.model = model;
  }

  /**
   * Update a surface; until it is measured, the curvatures of the previous one are shown.
   * @param {ArrayLike<number>} xyz
   * @param {number[]} held vertices
   * @param {?Float64Array} [K] K measured by the server
   */
  measure(xyz, held, K = null) {
    if (this.xyz !== xyz || this.held !== held) this.knowsK = this.knowsFit = false;
    this.held = held;
    this.xyz = xyz;
    if (!K) return;
    this.K = K;
    this.knowsK = true;
  }

  /** Request the curvatures of the surface; one request at a time. */
  async request() {
    if (this.asking) return;
    this.asking = true;
    const { held, xyz } = this;
    let found = null;
    this.trouble = '';
    try {
      found = await this.ask(xyz);
    } catch (error) {
      this.trouble = error.message;
    } finally {
      this.asking = false;
    }
    if (this.xyz === xyz && this.held === held) {
      // After a failure there is no second request for the same surface.
      this.fit = found;
      if (!this.knowsK) this.K = found?.curvature ?? null;
      this.knowsK = this.knowsFit = true;
    }
    if (MEASURED.includes(this.by) || FITTED.includes(this.by)) this.paint();
  }

  /** Whether the curvatures that are shown are those of the surface. */
  get knows() {
    return MEASURED.includes(this.by) ? this.knowsK : !FITTED.includes(this.by) || this.knowsFit;
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
   * @returns {{K: number, target: ?number, asked: boolean, held: boolean, height: number, unit: string}} K is NaN where unknown
   */
  look(vertex) {
    if (!this.knowsK) this.request();
    const K = this.knowsK && this.K ? this.K[vertex] : Number.NaN;
    const asked = Boolean(this.model.askedWith(this.held)[vertex]);
    return { K, target: this.targets[vertex], asked, held: this.held.includes(vertex), height: this.xyz[3 * vertex + 2], unit: this.model.unit };
  }

  /** Colour by the selected quantity. */
  paint() {
    const { surface } = this.scene;
    surface.stripes(this.by === 'zebra');
    surface.edges.visible = this.by !== 'zebra';
    surface.extras.beside(this.by === 'before' && this.before ? this.model.toScene(this.before) : null);
    if (!this.knows) this.request();
    const shown = this.shown();
    if (shown) {
      const { values, limit, what, middle = 0 } = shown;
      const gaps = surface.colourValues(middle ? values.map((value) => value - middle) : values, limit);
      this.legend.show(what, limit, gaps, middle);
    } else {
      this.legend.say(this.knows && (MEASURED.includes(this.by) || FITTED.includes(this.by)) ? this.trouble : '');
      surface.colourRegions();
    }
    this.scene.draw();
  }

  /** Return the values with label and limits, null for colours of regions. */
  shown() {
    const { curvatureUnit, unit } = this.model;
    const length = unit ? ` in ${unit}` : '';
    const bent = unit ? ` in 1/${unit}` : '';
    if ((MEASURED.includes(this.by) && !this.K) || (FITTED.includes(this.by) && !this.fit)) return null;
    switch (this.by) {
      case 'curvature':
        return { values: this.K, limit: roundAbove(ROOM * largest(this.K)), what: `K in ${curvatureUnit}` };
      case 'error': {
        const values = this.K.map((K, vertex) => K - (this.targets[vertex] ?? Number.NaN));
        return { values, limit: roundAbove(Math.max(largest(values), FINE * largest(this.targets))), what: `K − target in ${curvatureUnit}` };
      }
      case 'fit':
        return { values: this.fit.gaussian, limit: roundAbove(ROOM * most(this.fit.gaussian)), what: `K by fitted quadrics in ${curvatureUnit}` };
      case 'mean':
        return { values: this.fit.mean, limit: roundAbove(ROOM * most(this.fit.mean)), what: `Mean curvature${bent}` };
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

function most(values) {
  const sizes = Array.from(values, Math.abs)
    .filter(Number.isFinite)
    .sort((a, b) => a - b);
  return sizes[Math.floor(QUANTILE * (sizes.length - 1))] ?? 0;
}
