/** Builds in the scene: coloured faces, lines and labels. */
// @ts-nocheck: three.js and uPlot come without types.

import * as THREE from '../vendor/three/three.module.min.js';
import { LineMaterial } from '../vendor/three/lines/LineMaterial.js';
import { LineSegments2 } from '../vendor/three/lines/LineSegments2.js';
import { LineSegmentsGeometry } from '../vendor/three/lines/LineSegmentsGeometry.js';

/**
 * Return the scene objects of a build.
 * @param {import('../make/drawn.js').Drawn} drawn
 * @param {(point: number[]) => ArrayLike<number>} toScene
 * @returns {THREE.Group}
 */
export function builtGroup({ lines, faces, labels }, toScene) {
  const group = new THREE.Group();
  for (const { colour, vertices, triangles } of faces) {
    const geometry = new THREE.BufferGeometry();
    const at = triangles.flat().flatMap((vertex) => [...toScene(vertices[vertex])]);
    geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(at), 3));
    geometry.computeVertexNormals();
    const material = new THREE.MeshLambertMaterial({ color: colour, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    group.add(new THREE.Mesh(geometry, material));
  }
  for (const { colour, ends } of lines) {
    if (!ends.length) continue;
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(Float32Array.from(ends.flat().flatMap((point) => [...toScene(point)])));
    group.add(new LineSegments2(geometry, new LineMaterial({ color: colour, linewidth: 2 })));
  }
  for (const { text, at } of labels) group.add(label(text, toScene(at)));
  for (const part of group.children) part.frustumCulled = false;
  return group;
}

function label(text, at) {
  const canvas = document.createElement('canvas');
  const pen = canvas.getContext('2d');
  pen.font = '600 44px system-ui, sans-serif';
  canvas.width = Math.ceil(pen.measureText(text).width) + 24;
  canvas.height = 60;
  pen.font = '600 44px system-ui, sans-serif';
  pen.fillStyle = 'rgb(255 255 255 / 80%)';
  pen.roundRect(0, 0, canvas.width, 60, 14);
  pen.fill();
  pen.fillStyle = '#262523';
  pen.textBaseline = 'middle';
  pen.fillText(text, 12, 32);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, sizeAttenuation: false, depthTest: false }));
  sprite.scale.set((0.014 * canvas.width) / 60, 0.014, 1);
  sprite.position.set(at[0], at[1], at[2]);
  sprite.renderOrder = 4;
  return sprite;
}
