/** Drawing of a plan. */

import { readable } from '../numbers.js';
import { roundStep } from './snap.js';
import { rolesOf, segmentsOf } from './plan.js';

const LABELS = 60; // number of segments above which a line has no dimensions

/** Draws a plan into an SVG. */
export class Ink {
  /** @param {SVGSVGElement} svg */
  constructor(svg) {
    this.svg = svg;
    this.view = { x: 0, y: 0, scale: 24 }; // point of the plan at the centre of the view; pixels per unit of length
    this.frame = { width: 1, height: 1 };
  }

  /**
   * Return the screen position of a point in plan.
   * @param {number[]} point
   * @returns {[number, number]}
   */
  toScreen([x, y]) {
    const { view, frame } = this;
    return [frame.width / 2 + (x - view.x) * view.scale, frame.height / 2 - (y - view.y) * view.scale];
  }

  /**
   * Return the point in plan at a screen position.
   * @param {number} left
   * @param {number} top
   * @returns {number[]}
   */
  toPlan(left, top) {
    const { view, frame } = this;
    return [view.x + (left - frame.width / 2) / view.scale, view.y - (top - frame.height / 2) / view.scale];
  }

  /** @returns {number} the step of the grid */
  get step() {
    return roundStep(11 / this.view.scale);
  }

  /**
   * Show all of a plan.
   * @param {?{x0: number, y0: number, x1: number, y1: number}} bounds
   */
  fit(bounds) {
    const { x0, y0, x1, y1 } = bounds ?? { x0: -2, y0: -2, x1: 22, y1: 14 };
    const { width, height } = this.frame;
    // Leave room for the tools at the top and the input field at the bottom (two lines on narrow screens).
    const [margin, top, floor] = [Math.min(90, 0.16 * width), 90, width < 600 ? 140 : 110];
    const fitting = Math.min((width - 2 * margin) / Math.max(x1 - x0, 1e-9), (height - top - floor) / Math.max(y1 - y0, 1e-9), 400 / Math.max(x1 - x0, y1 - y0, 1e-9) * 4);
    const scale = Math.max(1e-6, fitting);
    this.view = { x: (x0 + x1) / 2, y: (y0 + y1) / 2 - (floor - top) / 2 / scale, scale };
  }

  /**
   * Draw all.
   * @param {import('./plan.js').Plan} plan
   * @param {{draft: number[][], pointer: ?{at: number[], on: string}, tool: string, hot: ?object, shape: ?number[][], chosen: number[][], band: ?number[][]}} state
   */
  draw(plan, { draft, pointer, tool, hot, shape, chosen, band }) {
    const parts = [this.grid(), this.area(plan)];
    const roles = rolesOf(plan);
    plan.lines.forEach((line, number) => parts.push(this.line(line, number, roles[number], tool, hot)));
    plan.columns.forEach((column, number) => parts.push(this.column(column, number, hot)));
    for (const place of chosen) parts.push(this.dot(place, 'chosen', 10));
    if (band) parts.push(this.band(band[0], band[1]));
    if (draft.length || shape) parts.push(this.draft(draft, pointer, shape));
    if (pointer && tool !== 'move' && tool !== 'hold') parts.push(this.cross(pointer));
    this.svg.replaceChildren(...parts);
  }

  grid() {
    const group = this.make('g', { class: 'grid' });
    const { width, height } = this.frame;
    const [left, top] = this.toPlan(0, 0);
    const [right, bottom] = this.toPlan(width, height);
    const { step } = this;
    const times = step / 10 ** Math.floor(Math.log10(step) + 1e-9) > 4 ? 10 : 5;
    const path = { fine: '', bold: '' };
    for (let k = Math.ceil(left / step); k * step <= right; k++) path[k % times ? 'fine' : 'bold'] += `M${this.toScreen([k * step, 0])[0]} 0V${height}`;
    for (let k = Math.ceil(bottom / step); k * step <= top; k++) path[k % times ? 'fine' : 'bold'] += `M0 ${this.toScreen([0, k * step])[1]}H${width}`;
    const [x, y] = this.toScreen([0, 0]);
    group.append(
      this.make('path', { class: 'fine', d: path.fine }),
      this.make('path', { class: 'bold', d: path.bold }),
      this.make('path', { class: 'axis', d: `M${x} 0V${height}M0 ${y}H${width}` }),
    );
    // Coordinates along the lower edge, at every bold line.
    const apart = times * step;
    const every = apart * this.view.scale < 48 ? 2 : 1;
    for (let k = Math.ceil(left / apart); k * apart <= right; k++) {
      if (k % every === 0) group.append(this.text(readable(k * apart, 6), this.toScreen([k * apart, 0])[0], height - 8, 'rule'));
    }
    for (let k = Math.ceil(bottom / apart); k * apart <= top; k++) {
      if (k % every === 0) group.append(this.text(readable(k * apart, 6), 8, this.toScreen([0, k * apart])[1] + 4, 'rule first'));
    }
    return group;
  }

  area(plan) {
    const roles = rolesOf(plan);
    const d = plan.lines
      .filter((_, k) => roles[k] !== 'fold')
      .map((line) => this.path(line.points, true))
      .join('');
    return this.make('path', { class: 'area', d: d || 'M0 0' });
  }

  line(line, number, role, tool, hot) {
    const group = this.make('g', { class: `line ${role}` });
    group.append(this.make('path', { class: 'stroke', d: this.path(line.points, line.closed) }));
    segmentsOf(line).forEach((ends, k) => {
      if (line.held.includes(k)) group.append(this.make('path', { class: 'held', d: this.path(ends, false) }));
      if (tool === 'hold' && hot?.line === number && (hot.segment === k || line.circle)) {
        group.append(this.make('path', { class: 'hot', d: this.path(ends, false) }));
      }
    });
    if (line.circle) {
      const { x, y, r } = line.circle;
      group.append(this.text(`⌀ ${readable(2 * r, 5)}`, this.toScreen([x, y])[0], this.toScreen([x, y + r])[1] - 9, 'size'));
      group.append(this.dot([x, y], `point ${hot?.line === number && hot.point === 0 ? 'hot' : ''}`));
      return group;
    }
    if (line.points.length <= LABELS) {
      segmentsOf(line).forEach((ends, k) => {
        const label = this.size(ends, line.closed ? turning(line.points) : 1);
        if (!label) return;
        label.dataset.size = `${number} ${k}`;
        group.append(label);
      });
      line.points.forEach((point, k) => group.append(this.dot(point, `point ${hot?.line === number && hot.point === k ? 'hot' : ''}`)));
    }
    return group;
  }

  column({ x, y, height }, number, hot) {
    const [left, top] = this.toScreen([x, y]);
    const group = this.make('g', { class: `column ${hot?.column === number ? 'hot' : ''}` });
    group.append(this.make('circle', { cx: left, cy: top, r: 7 }));
    if (height) group.append(this.text(`↑ ${readable(height, 4)}`, left, top - 13, 'size'));
    return group;
  }

  draft(draft, pointer, shape) {
    const group = this.make('g', { class: 'draft' });
    const points = shape ?? (pointer ? [...draft, pointer.at] : draft);
    group.append(this.make('path', { class: 'stroke', d: this.path(points, Boolean(shape)) }));
    const ends = shape ? segmentsOf({ points: shape, closed: true, held: [] }).slice(0, shape.length > 8 ? 0 : 2) : segmentsOf({ points, closed: false, held: [] });
    for (const pair of ends) {
      const label = this.size(pair, shape ? turning(shape) : 1);
      if (label) group.append(label);
    }
    for (const point of draft) group.append(this.dot(point, 'point'));
    if (!shape && draft.length > 2) group.append(this.dot(draft[0], 'close', 8));
    return group;
  }

  /** Return the frame between two points of the screen. */
  band(a, b) {
    return this.make('path', { class: 'band', d: `M${a[0]} ${a[1]}H${b[0]}V${b[1]}H${a[0]}Z` });
  }

  cross({ at, on }) {
    const [x, y] = this.toScreen(at);
    return this.make('path', { class: `cross ${on}`, d: `M${x - 9} ${y}H${x + 9}M${x} ${y - 9}V${y + 9}` });
  }

  /**
   * Return the dimension of a segment, null if there is no room.
   * @param {number[][]} ends
   * @param {number} side 1 or -1
   * @returns {?Element}
   */
  size([a, b], side) {
    const [from, to] = [this.toScreen(a), this.toScreen(b)];
    const room = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (room < 30) return null;
    const normal = [(to[1] - from[1]) / room, -(to[0] - from[0]) / room].map((each) => 15 * side * each);
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    return this.text(readable(length, 5), (from[0] + to[0]) / 2 + normal[0] * -1, (from[1] + to[1]) / 2 - normal[1] + 4, 'size');
  }

  path(points, closed) {
    if (!points.length) return '';
    return `M${points.map((point) => this.toScreen(point).map((at) => at.toFixed(1)).join(' ')).join('L')}${closed ? 'Z' : ''}`;
  }

  dot(point, name, r = 4.5) {
    const [cx, cy] = this.toScreen(point);
    return this.make('circle', { class: name, cx, cy, r });
  }

  /** @returns {any} */
  text(content, x, y, name) {
    const made = this.make('text', { x, y, class: name });
    made.textContent = content;
    return made;
  }

  make(tag, attributes) {
    const made = document.createElementNS(this.svg.namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    return made;
  }
}

/** Return 1 for anticlockwise and -1 for clockwise points, so that dimensions are placed outside. */
function turning(points) {
  const twice = points.reduce((sum, [x, y], k) => sum + x * points[(k + 1) % points.length][1] - points[(k + 1) % points.length][0] * y, 0);
  return twice >= 0 ? 1 : -1;
}
