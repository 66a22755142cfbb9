/** Additional objects in the scene: cursor, path, clear volumes, section line, and the previous surface. */
// @ts-nocheck: three.js and uPlot come without types.

import * as THREE from '../vendor/three/three.module.min.js';
import { LineMaterial } from '../vendor/three/lines/LineMaterial.js';
import { LineSegments2 } from '../vendor/three/lines/LineSegments2.js';
import { LineSegmentsGeometry } from '../vendor/three/lines/LineSegmentsGeometry.js';
import { Dots } from '../dots.js';
import { builtGroup } from './built.js';

const TOOL = '#2a6972';
const CLEAR = '#3f7fae';

/** The extras of one surface. */
export class Extras {
  /** @param {{faces: Uint32Array}} model */
  constructor(model) {
    this.group = new THREE.Group();
    this.dots = new Dots(TOOL);
    this.line = this.fat(TOOL, 4.5);
    this.cut = this.fat('#c2410c', 3.5);
    this.boxes = new THREE.Group();
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(model.faces, 1));
    const material = new THREE.MeshBasicMaterial({ color: '#7b8794', transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false });
    this.ghost = new THREE.Mesh(geometry, material);
    this.ghost.visible = false;
    this.group.add(this.dots.points, this.line, this.cut, this.boxes, this.ghost);
    for (const part of [this.dots.points, this.line, this.cut, this.ghost]) part.frustumCulled = false;
  }

  fat(colour, width) {
    const made = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: width, color: colour, depthTest: false }));
    made.renderOrder = 3;
    made.visible = false;
    return made;
  }

  /**
   * Mark vertices.
   * @param {number[]} vertices
   * @param {Float32Array} xyz
   */
  cursor(vertices, xyz) {
    this.dots.put(vertices, xyz);
  }

  /**
   * Draw a path along edges.
   * @param {number[]} path
   * @param {Float32Array} xyz
   */
  trail(path, xyz) {
    this.set(
      this.line,
      path.slice(1).flatMap((vertex, k) => [path[k], vertex].flatMap((each) => [...xyz.subarray(3 * each, 3 * each + 3)])),
    );
  }

  /**
   * Draw the line of a section.
   * @param {number[]} ends six numbers per segment, in the frame of the scene
   */
  section(ends) {
    this.set(this.cut, ends);
  }

  set(line, ends) {
    line.visible = ends.length > 0;
    if (!ends.length) return;
    line.geometry.dispose();
    line.geometry = new LineSegmentsGeometry();
    line.geometry.setPositions(Float32Array.from(ends));
  }

  /**
   * Show clear volumes.
   * @param {number[][]} rooms x0, y0, z0, x1, y1, z1 in the scene's frame
   */
  rooms(rooms) {
    this.empty(this.boxes);
    for (const [x0, y0, z0, x1, y1, z1] of rooms) {
      const sides = [Math.abs(x1 - x0), Math.abs(y1 - y0), Math.max(1e-4, Math.abs(z1 - z0))];
      const geometry = new THREE.BoxGeometry(...sides);
      const body = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: CLEAR, transparent: true, opacity: 0.2, depthWrite: false }));
      const edges = new THREE.LineSegments(new THREE.EdgesGeometry(geometry), new THREE.LineBasicMaterial({ color: CLEAR }));
      for (const part of [body, edges]) {
        part.position.set((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2);
        this.boxes.add(part);
      }
    }
  }

  /**
   * Show another surface of the same mesh, null for none.
   * @param {?Float32Array} xyz
   */
  beside(xyz) {
    this.ghost.visible = xyz !== null;
    if (xyz) this.ghost.geometry.setAttribute('position', new THREE.BufferAttribute(xyz, 3));
  }

  /**
   * Show a build, null for none.
   * @param {?import('../make/drawn.js').Drawn} drawn
   * @param {(point: number[]) => ArrayLike<number>} toScene
   */
  build(drawn, toScene) {
    if (this.built) {
      this.empty(this.built);
      this.group.remove(this.built);
    }
    this.built = drawn && builtGroup(drawn, toScene);
    if (this.built) this.group.add(this.built);
  }

  empty(group) {
    for (const part of [...group.children]) {
      group.remove(part);
      part.geometry?.dispose();
      part.material.map?.dispose();
      part.material.dispose();
    }
  }

  /** Free the memory of the graphics card. */
  dispose() {
    this.build(null, null);
    this.empty(this.boxes);
    for (const part of [this.dots.points, this.line, this.cut, this.ghost]) {
      part.geometry.dispose();
      part.material.map?.dispose();
      part.material.dispose();
    }
  }
}
