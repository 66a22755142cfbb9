/** The 3D view: camera, lights, and drawing on demand. */
// @ts-nocheck: three.js and uPlot come without types.

import * as THREE from './vendor/three/three.module.min.js';
import { OrbitControls } from './vendor/three/controls/OrbitControls.js';
import { framing, freeArea } from './see/framing.js';
import { Pace } from './see/pace.js';
import { Sharpness } from './see/sharpness.js';
import { DETAIL, Surface } from './surface.js';

const SETTLE = 90; // time constant of the motion of the surface [ms]
const REACH = 1.6; // distance from the centre within which shadows are drawn
const RIM = 0.1; // width of the ground around the surface, limited to the extent of its shadow
const MARGIN = 1.04; // factor for the margin around a surface that fills the view
const PASSING = ['crown', 'readout', 'progress']; // elements beside the canvas that do not count as obstructing the view
const FROM = new THREE.Vector3(-0.62, -1, 0.72).normalize();

/** A view of one model. */
export class Scene {
  /**
   * @param {HTMLCanvasElement} canvas
   * @throws {Error} if the browser has no WebGL
   */
  constructor(canvas) {
    this.canvas = canvas;
    this.sharpness = new Sharpness();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: this.sharpness.smoothed, alpha: true });
    this.renderer.setPixelRatio(this.sharpness.fine);
    this.pace = new Pace(() => this.draw());
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.world = new THREE.Scene();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.rotateSpeed = 0.8;
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 0.3;
    this.controls.maxDistance = 30;
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => (this.chosen = true));
    this.still = window.matchMedia('(prefers-reduced-motion: reduce)');
    this.surface = null;
    this.goal = null;
    this.frame = 0;
    this.plain = false;
    this.framed = false;
    this.chosen = false; // whether somebody chose the view
    this.after = () => {};
    /** @type {(gone: boolean) => void} called when the browser takes the graphics away, and when it gives them back */
    this.lost = () => {};
    this.light();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    canvas.addEventListener('dblclick', () => this.plain || this.fit());
    canvas.addEventListener('keydown', (event) => this.key(event));
    // The renderer restores its own state; textures and buffers are sent again with the next frame.
    canvas.addEventListener('webglcontextlost', () => this.lost(true));
    canvas.addEventListener('webglcontextrestored', () => {
      this.lost(false);
      this.draw();
    });
  }

  light() {
    this.world.add(new THREE.HemisphereLight(0xffffff, 0xb9b0a4, 1.5));
    const lamp = new THREE.DirectionalLight(0xfff6e8, 2.1);
    lamp.position.set(-2.2, -1.2, 3.4);
    this.world.add(lamp);
    // The light is nearly overhead, so that the shadow shows the position of the surface.
    this.sun = new THREE.DirectionalLight(0xffffff, 0.25);
    this.sun.position.set(0.4, -0.3, 4);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 6;
    this.sun.shadow.camera.near = 0.5;
    this.sun.shadow.camera.far = 9;
    for (const [side, at] of Object.entries({ left: -REACH, right: REACH, top: REACH, bottom: -REACH })) this.sun.shadow.camera[side] = at;
    this.ground = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.ShadowMaterial({ opacity: 0.13 }));
    this.ground.receiveShadow = true;
    this.world.add(this.sun, this.ground);
  }

  /**
   * Show a model instead of the previous one.
   * @param {import('./model.js').Model} model
   * @param {boolean} [keep] the view
   */
  show(model, keep = false) {
    if (this.surface) {
      this.world.remove(this.surface.group);
      this.surface.dispose();
    }
    this.goal = null;
    this.surface = new Surface(model);
    this.world.add(this.surface.group);
    this.start = this.surface.xyz;
    this.dress();
    if (!keep) this.fit(false);
  }

  /**
   * Move the surface to new positions.
   * @param {Float32Array} xyz in the scene's frame
   * @param {boolean} [glide] whether to animate the motion
   */
  moveTo(xyz, glide = true) {
    if (!glide || this.still.matches) {
      this.goal = null;
      this.surface.place(xyz.slice());
    } else {
      this.goal = xyz;
      this.last = performance.now();
    }
    this.draw();
  }

  /**
   * Fit the surface into the area not covered by the tools.
   * @param {boolean} [keep] whether to keep the direction of view
   */
  fit(keep = true) {
    if (!this.surface) return;
    this.framed = true;
    this.chosen = false;
    // The resize observer reports a new size only later.
    this.measure();
    const back = keep ? this.camera.position.clone().sub(this.controls.target).normalize() : FROM;
    const right = this.camera.up.clone().cross(back).normalize();
    const axes = { right: right.toArray(), up: back.clone().cross(right).toArray(), back: back.toArray() };
    const { target, far } = framing([...(this.goal ?? this.surface.xyz), ...this.start], axes, this.tangents());
    this.controls.target.fromArray(target);
    this.camera.position.copy(this.controls.target).addScaledVector(back, MARGIN * far);
    this.controls.update();
    this.draw();
  }

  /** @returns {boolean} whether every point of the surface, or of that which it moves to, is in the picture */
  get whole() {
    const xyz = this.goal ?? this.surface.xyz;
    const point = new THREE.Vector3();
    this.camera.updateMatrixWorld();
    for (let k = 0; k < xyz.length; k += 3) {
      const { x, y } = point.fromArray(xyz, k).project(this.camera);
      if (Math.max(Math.abs(x), Math.abs(y)) > 1) return false;
    }
    return true;
  }

  /** @returns {number[]} position of the camera and its target, in units of the scene */
  get view() {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()];
  }

  /** @param {number[]} view */
  set view(view) {
    this.framed = this.chosen = true;
    this.measure();
    this.tangents();
    this.camera.position.fromArray(view);
    this.controls.target.fromArray(view, 3);
    this.controls.update();
    this.draw();
  }

  /** Centre the view in the free area, and return the tangents of half of its angles of view. */
  tangents() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    const { left, top, right, bottom } = this.free();
    this.camera.setViewOffset(width, height, (width - left - right) / 2, (height - top - bottom) / 2, width, height);
    const half = Math.tan(0.5 * THREE.MathUtils.degToRad(this.camera.fov)) / height;
    return { across: half * Math.max(1, right - left), upward: half * Math.max(1, bottom - top) };
  }

  /** @returns {import('./see/framing.js').Area} what the tools leave free */
  free() {
    const room = this.canvas.parentElement;
    const over = [...room.children].filter((each) => each !== this.canvas && !PASSING.includes(each.id) && each.checkVisibility());
    return freeArea(
      room.getBoundingClientRect(),
      over.map((each) => each.getBoundingClientRect()),
    );
  }

  /** Update the colours from the style sheet, for the light and dark theme. */
  dress() {
    const style = getComputedStyle(document.documentElement);
    const theme = { line: style.getPropertyValue('--line3d').trim(), crease: style.getPropertyValue('--crease3d').trim() };
    this.surface?.dress(theme);
    this.ground.material.opacity = Number(style.getPropertyValue('--shadow3d'));
    this.draw();
  }

  /**
   * Return the vertex and region at a screen position, null if there is none.
   * @param {number} x
   * @param {number} y
   * @returns {?{vertex: number, region: number}}
   */
  pick(x, y) {
    if (!this.surface) return null;
    const frame = this.canvas.getBoundingClientRect();
    const place = new THREE.Vector2((2 * (x - frame.left)) / frame.width - 1, 1 - (2 * (y - frame.top)) / frame.height);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, this.camera);
    const [hit] = ray.intersectObject(this.surface.mesh);
    if (!hit) return null;
    const { position } = this.surface.geometry.attributes;
    const far = (wedge) => new THREE.Vector3().fromBufferAttribute(position, wedge).distanceToSquared(hit.point);
    const corners = [hit.face.a, hit.face.b, hit.face.c].sort((a, b) => far(a) - far(b));
    return { vertex: this.surface.wedges.vertexOf[corners[0]], region: this.surface.wedges.regionOf[corners[0]] };
  }

  /**
   * Return the point on the ground at a screen position, in the frame of the model; null if there is none.
   * @param {number} x
   * @param {number} y
   * @returns {?number[]}
   */
  groundAt(x, y) {
    if (!this.surface) return null;
    const { model } = this.surface;
    const frame = this.canvas.getBoundingClientRect();
    const place = new THREE.Vector2((2 * (x - frame.left)) / frame.width - 1, 1 - (2 * (y - frame.top)) / frame.height);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, this.camera);
    const level = (model.bounds.low[2] - model.centre[2]) / model.size;
    const hit = ray.ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), -level), new THREE.Vector3());
    return hit && [hit.x, hit.y, hit.z].map((value, axis) => value * model.size + model.centre[axis]);
  }

  /**
   * Return the position of a vertex on the canvas, and the number of pixels per unit of length there.
   * @param {ArrayLike<number>} xyz in the frame of the scene
   * @param {number} vertex
   * @returns {number[]} x, y, pixels
   */
  onScreen(xyz, vertex) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const at = new THREE.Vector3(xyz[3 * vertex], xyz[3 * vertex + 1], xyz[3 * vertex + 2]);
    const far = at.distanceTo(this.camera.position);
    const pixels = height / (2 * far * Math.tan(0.5 * THREE.MathUtils.degToRad(this.camera.fov)));
    const { x, y } = at.project(this.camera);
    return [((x + 1) / 2) * width, ((1 - y) / 2) * height, pixels];
  }

  /** @returns {number} the vertex nearest to the middle of the view */
  central() {
    const { xyz } = this.surface;
    const [x, y] = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
    let [best, least] = [0, Infinity];
    for (let vertex = 0; vertex < xyz.length / 3; vertex++) {
      const at = this.onScreen(xyz, vertex);
      const far = Math.hypot(at[0] - x, at[1] - y);
      if (far < least) [best, least] = [vertex, far];
    }
    return best;
  }

  /**
   * Return the view as a picture.
   * @returns {Promise<Blob>}
   */
  picture() {
    // A picture uses the whole area, as it contains no tools.
    const { framed } = this;
    this.framed = false;
    this.camera.clearViewOffset();
    this.refine(true);
    this.renderer.setPixelRatio(this.sharpness.ofPictures);
    this.resize();
    // Copy the canvas now, as it is cleared after this frame.
    const taken = this.sharpness.picture(this.canvas);
    this.framed = framed;
    this.renderer.setPixelRatio(this.sharpness.fine);
    this.resize();
    return taken;
  }

  key(event) {
    const turn = { ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (turn) {
      this.controls.rotateLeft(turn[0]);
      this.controls.rotateUp(turn[1]);
    } else if (event.key === '+' || event.key === '=') this.controls.dollyIn(1 / 1.15);
    else if (event.key === '-') this.controls.dollyOut(1 / 1.15);
    else if (event.key === 'f') this.fit();
    else return;
    event.preventDefault();
    this.chosen = event.key !== 'f';
    this.controls.update();
    this.draw();
  }

  resize() {
    if (this.measure()) this.render();
  }

  /** Update the size of the canvas, and return whether it is not zero. */
  measure() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return false;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    if (this.framed) this.tangents();
    this.camera.updateProjectionMatrix();
    return true;
  }

  /** Schedule a frame. */
  draw() {
    if (!this.frame) this.frame = requestAnimationFrame((now) => this.tick(now));
  }

  /** Draw a scheduled frame immediately if frames are slow, in parallel with the update of the texts. */
  flush() {
    if (!this.frame || !this.pace.coarse) return;
    cancelAnimationFrame(this.frame);
    this.tick(performance.now());
  }

  /** A surface is expected: switch to quick frames in advance, as changing the resolution takes time. */
  expect() {
    if (!this.pace.slow) return;
    this.pace.resting = false;
    if (this.renderer.getPixelRatio() === this.sharpness.coarse) this.pace.begin(true);
    else this.tick(performance.now(), true);
  }

  tick(now, expected = false) {
    this.frame = 0;
    if (this.goal) this.glide(now);
    this.refine(!this.pace.coarse);
    this.pace.begin(expected);
    this.render();
  }

  /** Draw a full frame, or a quick frame of a moving surface. */
  refine(fine) {
    const ratio = fine ? this.sharpness.fine : this.sharpness.coarse;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.renderer.shadowMap.autoUpdate = fine;
    if (fine) this.camera.layers.enable(DETAIL);
    else this.camera.layers.disable(DETAIL);
  }

  render() {
    if (this.surface) this.lay();
    this.renderer.render(this.world, this.camera);
    this.after();
  }

  /** Place the ground below the surface and its shadow. */
  lay() {
    const { min, max } = new THREE.Box3().setFromArray(this.surface.xyz);
    const level = min.z - 0.02;
    const { x, y, z } = this.sun.position;
    for (const [axis, slope] of [
      ['x', x / z],
      ['y', y / z],
    ]) {
      const shift = slope * (max.z - level);
      const [from, to] = [Math.min(min[axis], min[axis] - shift) - RIM, Math.max(max[axis], max[axis] - shift) + RIM];
      this.ground.position[axis] = 0.5 * (from + to);
      this.ground.scale[axis] = to - from;
    }
    this.ground.position.z = level;
  }

  glide(now) {
    const share = 1 - Math.exp(-Math.max(0, now - this.last) / SETTLE);
    this.last = now;
    const xyz = this.surface.xyz.slice();
    let left = 0;
    for (let k = 0; k < xyz.length; k++) {
      xyz[k] += share * (this.goal[k] - xyz[k]);
      left = Math.max(left, Math.abs(this.goal[k] - xyz[k]));
    }
    const arrived = left < 2e-4;
    this.surface.place(arrived ? this.goal.slice() : xyz);
    if (arrived) this.goal = null;
    else this.draw();
  }
}
