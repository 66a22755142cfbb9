/** Dots on vertices: supports and rough places. */
// @ts-nocheck: three.js and uPlot come without types.

import * as THREE from './vendor/three/three.module.min.js';

/** Dots of one colour. */
export class Dots {
  /** @param {string} colour */
  constructor(colour) {
    const material = new THREE.PointsMaterial({
      map: picture(colour),
      sizeAttenuation: false,
      alphaTest: 0.4,
      transparent: true,
    });
    this.points = new THREE.Points(new THREE.BufferGeometry(), material);
    this.vertices = [];
  }

  /**
   * Put a dot on each of some vertices.
   * @param {number[]} vertices
   * @param {Float32Array} xyz of all
   */
  put(vertices, xyz) {
    this.vertices = vertices;
    // Smaller dots if there are many.
    this.points.material.size = Math.max(7, 13 * Math.min(1, Math.sqrt(40 / Math.max(1, vertices.length))));
    this.points.geometry.dispose();
    this.points.geometry = new THREE.BufferGeometry();
    this.points.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * vertices.length), 3));
    this.place(xyz);
  }

  /** @param {Float32Array} xyz of all vertices */
  place(xyz) {
    const at = this.points.geometry.getAttribute('position');
    if (!at) return;
    this.vertices.forEach((vertex, i) => at.array.set(xyz.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
    at.needsUpdate = true;
  }
}

function picture(colour) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext('2d');
  for (const [radius, fill] of [
    [29, '#ffffff'],
    [21, colour],
  ]) {
    pen.fillStyle = fill;
    pen.beginPath();
    pen.arc(32, 32, radius, 0, 2 * Math.PI);
    pen.fill();
  }
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}
