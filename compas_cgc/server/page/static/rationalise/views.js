/** The 3D view of a design and of its panels. */

import { Legend } from '../legend.js';
import { Model } from '../model.js';
import { lengthScale, limitOf, mouldColour } from './found.js';

const PLAIN = '#cfc8ba'; // colour of the design
const SEAM = 1.3; // width of seams [pixel]

/** One scene, which shows the design first and then the results. */
export class Views {
  /**
   * Load the 3D view, and create it.
   * @param {HTMLCanvasElement} canvas
   * @param {HTMLElement} legend
   * @returns {Promise<Views>}
   */
  static async create(canvas, legend) {
    try {
      const { Scene } = await import('../scene.js');
      return new Views(new Scene(canvas), new Legend(legend));
    } catch (error) {
      throw new Error(`The 3D view cannot start: ${error.message}. Use a browser with WebGL enabled.`);
    }
  }

  /**
   * @param {import('../scene.js').Scene} scene
   * @param {Legend} legend
   */
  constructor(scene, legend) {
    this.scene = scene;
    this.legend = legend;
    this.told = null;
  }

  /**
   * Show a design.
   * @param {string} name
   * @param {{unit: string, vertices: number[][], faces: number[][], smooth: boolean}} surface
   */
  design(name, { unit, vertices, faces, smooth }) {
    this.told = null;
    this.legend.say('');
    this.put({ name, unit, vertices, faces, regions: faces.map(() => 0), creases: [], held: [], colours: [PLAIN] });
    // Only edges of the design are shown.
    if (smooth) this.scene.surface.asSeams(SEAM);
    this.scene.fit(false);
  }

  /**
   * Show a result in the place of the design, or of another result.
   * @param {string} name
   * @param {string} unit
   * @param {import('./jobs.js').Told} told
   */
  result(name, unit, told) {
    const first = !this.told;
    this.told = told;
    this.unit = unit;
    const { vertices, faces, supports } = told;
    const regions = told.panel_of_face.map((panel) => told.classes[panel]);
    const colours = told.curvatures.map((_, k) => mouldColour(k));
    this.put({ name, unit, vertices, faces, regions, creases: told.seams, held: supports, colours });
    this.scene.surface.asSeams(SEAM);
    // The plans take a part of the view.
    if (first && !this.scene.chosen) this.scene.fit();
  }

  put({ name, unit, vertices, faces, regions, creases, held, colours }) {
    const none = { goals: [], notes: [], problems: [], support_choice: 'file' };
    const targets = colours.map(() => null);
    this.scene.show(new Model({ ...none, name, unit, vertices, faces, regions, creases, colours, targets, supports: { file: held } }), true);
    this.scene.draw();
  }

  /**
   * Colour the panels by mould, or by their distance from the design.
   * @param {string} by
   */
  colour(by) {
    if (!this.told) return;
    if (by === 'distance') this.scene.surface.colourValues(this.told.distances, limitOf(this.told));
    else this.scene.surface.colourRegions();
    if (by === 'distance') showDistances(this.legend, this.told, this.unit);
    else this.legend.say('');
    this.scene.draw();
  }

  /** @param {number[]} moulds whose panels are highlighted */
  light(moulds) {
    if (!this.told) return;
    this.scene.surface.highlight(moulds);
    this.scene.draw();
  }
}

/**
 * Show the legend of the distances from the design.
 * @param {Legend} legend
 * @param {import('./jobs.js').Told} told
 * @param {string} unit
 */
export function showDistances(legend, told, unit) {
  const limit = limitOf(told);
  const length = lengthScale(unit, limit);
  legend.show(`Distance from the design${length.unit ? ` in ${length.unit}` : ''}`, length.factor * limit, false);
}
