/** The model in the scene: surface, edges, creases and supports. */
// @ts-nocheck: three.js and uPlot come without types.

import * as THREE from './vendor/three/three.module.min.js';
import { LineMaterial } from './vendor/three/lines/LineMaterial.js';
import { LineSegments2 } from './vendor/three/lines/LineSegments2.js';
import { LineSegmentsGeometry } from './vendor/three/lines/LineSegmentsGeometry.js';
import { ROUGH, SUPPORT, linear, parse, signedColour } from './colours.js';
import { Dots } from './dots.js';
import { Extras } from './see/extras.js';
import { withZebra } from './see/zebra.js';
import { Wedges } from './wedges.js';

export const DETAIL = 1; // layer of objects that quick frames omit

/** All scene objects of a model. */
export class Surface {
  /** @param {import('./model.js').Model} model */
  constructor(model) {
    this.model = model;
    this.wedges = new Wedges(model);
    this.xyz = model.toScene(model.xyz);
    this.lit = null;
    this.tints = model.targets.map((_, region) => parse(model.colourOf(region)));
    this.colour = (wedge) => this.tints[this.wedges.regionOf[wedge]];

    this.geometry = new THREE.BufferGeometry();
    for (const name of ['position', 'normal', 'color']) {
      const attribute = new THREE.BufferAttribute(new Float32Array(3 * this.wedges.count), 3);
      this.geometry.setAttribute(name, attribute.setUsage(THREE.DynamicDrawUsage));
    }
    this.geometry.setIndex(new THREE.BufferAttribute(this.wedges.index, 1));
    // A matt material looks the same under these lights and is drawn in a third of the time.
    const material = new THREE.MeshLambertMaterial({
      vertexColors: true,
      side: THREE.DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 2,
      polygonOffsetUnits: 2,
    });
    this.zebra = withZebra(material);
    this.mesh = new THREE.Mesh(this.geometry, material);
    this.mesh.castShadow = true;

    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', this.geometry.getAttribute('position'));
    lines.setIndex(new THREE.BufferAttribute(this.wedges.edges, 1));
    this.edges = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ transparent: true }));
    this.edges.layers.set(DETAIL);
    // The edges of a fine mesh would hide the surface.
    this.edges.material.opacity = 0.2 * Math.min(1, Math.sqrt(6000 / model.regions.length));

    this.creaseEnds = model.creases.flatMap((path) => path.slice(1).flatMap((vertex, i) => [path[i], vertex]));
    this.creases = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: 3.2 }));
    this.creases.geometry.setPositions(new Float32Array(Math.max(6, 3 * this.creaseEnds.length)));
    this.creases.visible = this.creaseEnds.length > 0;

    this.supports = new Dots(SUPPORT);
    this.rough = new Dots(ROUGH);
    this.extras = new Extras(model);

    this.group = new THREE.Group();
    this.group.add(this.mesh, this.edges, this.creases, this.supports.points, this.rough.points, this.extras.group);
    for (const part of this.group.children) part.frustumCulled = false;
    this.setSupports(model.held);
    this.place(this.xyz);
    this.paint();
  }

  /**
   * Move the vertices.
   * @param {Float32Array} xyz three per vertex, in the frame of the scene
   */
  place(xyz) {
    this.xyz = xyz;
    const at = this.geometry.getAttribute('position');
    const normal = this.geometry.getAttribute('normal');
    this.wedges.place(xyz, at.array);
    this.wedges.normals(at.array, normal.array);
    at.needsUpdate = true;
    normal.needsUpdate = true;
    this.geometry.boundingSphere = null;
    if (this.creaseEnds.length) {
      const ends = this.creases.geometry.getAttribute('instanceStart').data;
      this.creaseEnds.forEach((vertex, i) => ends.array.set(xyz.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
      ends.needsUpdate = true;
    }
    this.supports.place(xyz);
    this.rough.place(xyz);
  }

  /** @param {number[]} held vertices */
  setSupports(held) {
    this.supports.put(held, this.xyz);
  }

  /** @param {number[]} places vertices where the surface is rough */
  mark(places) {
    this.rough.put(places, this.xyz);
  }

  /** Colour the regions. */
  colourRegions() {
    this.colour = (wedge) => this.tints[this.wedges.regionOf[wedge]];
    this.paint();
  }

  /**
   * Update the colours of the regions.
   * @param {import('./model.js').Model} model
   */
  tint(model) {
    this.tints = model.targets.map((_, region) => parse(model.colourOf(region)));
  }

  /**
   * Draw the creases as thin seams, without the edges of the mesh.
   * @param {number} width of the seams [pixel]
   */
  asSeams(width) {
    this.edges.visible = false;
    this.creases.material.linewidth = width;
  }

  /** @param {boolean} on whether zebra stripes are shown */
  stripes(on) {
    this.zebra.value = on ? 1 : 0;
  }

  /**
   * Colour by signed values.
   * @param {ArrayLike<number>} values per vertex
   * @param {number} limit value of the darkest colours
   * @returns {boolean} whether some of the surface has none
   */
  colourValues(values, limit) {
    const spread = this.wedges.spread(values);
    this.colour = (wedge) => signedColour(spread[wedge], limit);
    this.paint();
    return spread.some((value) => !Number.isFinite(value));
  }

  /**
   * Highlight regions.
   * @param {number[]} regions empty for no highlight
   */
  highlight(regions) {
    if (!regions.length && !this.lit) return;
    this.lit = regions.length ? new Set(regions) : null;
    this.paint();
  }

  /**
   * Set the colours of lines from the theme.
   * @param {{line: string, crease: string}} theme
   */
  dress({ line, crease }) {
    this.edges.material.color.set(line);
    this.creases.material.color.set(crease);
  }

  paint() {
    const colour = this.geometry.getAttribute('color');
    for (let wedge = 0; wedge < this.wedges.count; wedge++) {
      const faded = this.lit && !this.lit.has(this.wedges.regionOf[wedge]) ? 0.5 : 0;
      this.colour(wedge).forEach((channel, k) => {
        colour.array[3 * wedge + k] = linear(channel + faded * (0.86 - channel));
      });
    }
    colour.needsUpdate = true;
  }

  /** Free the memory of the graphics card. */
  dispose() {
    this.extras.dispose();
    for (const part of this.group.children) {
      if (part === this.extras.group) continue;
      part.geometry.dispose();
      part.material.map?.dispose();
      part.material.dispose();
    }
  }
}
