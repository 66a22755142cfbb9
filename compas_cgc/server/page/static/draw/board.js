/** The drawing board: lines, circles and columns drawn by pointer and by typed lengths. */

import { numberIn } from '../fields.js';
import { Ink } from './ink.js';
import { boundsOf, circle, isAt, placesOf, rolesOf, segmentsOf, tidy, withCorner, withLength, withMoved, without } from './plan.js';
import { snapped } from './snap.js';
import { typedPoint } from './typed.js';

const CLICK_TOLERANCE = 5; // pointer movement during a click [pixel]
const HINTS = {
  line: ['Click the first point of the outline, or type coordinates such as 0, 0.', 'Click the next point, or type a length. Enter closes the line.'],
  rectangle: ['Click a corner.', 'Click the opposite corner, or type both sides: 12, 8.'],
  circle: ['Click the centre.', 'Click a point on the circle, or type the radius.'],
  column: ['Click the position of a column, or type its coordinates.', ''],
  hold: ['Click the supported sides and corners. If there are none, the whole edge is supported.', ''],
  move: ['Drag points and columns. Shift selects several, one by one or in a frame; Delete removes them. Click a dimension to change it.', ''],
};

const ON = [
  'The outline is closed: make the surface, or click the first point of a crease or a hole.',
  'Click the next point, or type a length. Click the first point to close a hole. Enter ends a crease.',
];
const UNREAD = ['Type coordinates such as 3; 4.', 'Type a length such as 5, a length and an angle such as 5 < 30, or an offset such as 3; 4.'];
const DUPLICATE = 'There is already a point here.';

/** The board. */
export class Board {
  /**
   * @param {SVGSVGElement} svg
   * @param {{field: HTMLInputElement, label: HTMLElement, hint: HTMLElement}} typing
   * @param {{change: (plan: import('./plan.js').Plan, key?: string) => void}} listener
   */
  constructor(svg, typing, listener) {
    this.svg = svg;
    this.ink = new Ink(svg);
    this.typing = typing;
    this.listener = listener;
    this.plan = null;
    /** @type {Map<number, [number, number]>} */
    this.fingers = new Map();
    this.asking = null;
    this.reset('line');
    new ResizeObserver(() => this.resize()).observe(svg);
    svg.addEventListener('pointerdown', (event) => this.down(event));
    svg.addEventListener('pointermove', (event) => this.move(event));
    svg.addEventListener('pointerup', (event) => this.up(event));
    svg.addEventListener('pointercancel', (event) => this.lift(event));
    svg.addEventListener('pointerleave', () => this.hover(null));
    svg.addEventListener('dblclick', () => this.finish());
    svg.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    svg.addEventListener('keydown', (event) => this.key(event));
    typing.field.addEventListener('keydown', (event) => this.typingKey(event));
  }

  reset(tool) {
    this.tool = tool;
    this.draft = [];
    this.pointer = null;
    this.hot = null;
    this.press = null;
    this.asking = null;
    /** @type {number[][]} the places that are selected */
    this.chosen = [];
    this.trouble = ''; // error in the typed text
    this.typing.field.value = '';
  }

  /** @param {import('./plan.js').Plan} plan */
  show(plan) {
    this.plan = plan;
    this.draw();
  }

  /** @param {string} tool */
  choose(tool) {
    // Keep what was drawn with the previous tool.
    this.finish();
    this.reset(tool);
    this.draw();
  }

  /** Discard the current line. */
  leave() {
    this.reset(this.tool);
    this.draw();
  }

  /** Draw everything. */
  fit() {
    this.ink.fit(boundsOf(this.plan));
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.svg;
    if (!width || !height) return;
    const first = this.ink.frame.width === 1;
    this.ink.frame = { width, height };
    if (!this.plan) return;
    if (first) this.fit();
    else this.draw();
  }

  draw() {
    if (!this.plan) return;
    const { draft, pointer, tool, hot, press } = this;
    // Of the selected places, undo may have moved some.
    this.chosen = this.places().filter(isAt(this.chosen));
    this.ink.draw(this.plan, { draft, pointer, tool, hot, shape: this.shape(pointer?.at), chosen: this.chosen, band: press?.band ?? null });
    const [begin, next] = tool === 'line' && this.hasOutline() ? ON : HINTS[tool];
    this.typing.hint.textContent = this.trouble || (this.asking ? 'Type the new length.' : draft.length ? next : begin);
    const places = !draft.length && !this.asking;
    this.typing.label.textContent = this.asking ? 'Length' : places ? 'Position' : tool === 'rectangle' ? 'Sides' : tool === 'circle' ? 'Radius' : 'Length';
    this.typing.field.parentElement.hidden = (tool === 'move' || tool === 'hold') && !this.asking;
  }

  /** Return the places of all points, circles and columns. */
  places() {
    return [...this.plan.lines.flatMap(placesOf), ...this.plan.columns.map(({ x, y }) => [x, y])];
  }

  /** Return the places of what is under the pointer; of a side, those of its line. */
  placesAt(found) {
    if (!found || found.label) return [];
    if (found.column !== undefined) return [[this.plan.columns[found.column].x, this.plan.columns[found.column].y]];
    const all = placesOf(this.plan.lines[found.line]);
    return found.point === undefined ? all : [all[found.point]];
  }

  hasOutline() {
    return rolesOf(this.plan).includes('outline');
  }

  /** Return the corners of the current rectangle or circle. */
  shape(at) {
    const [from] = this.draft;
    if (!from || !at) return null;
    if (this.tool === 'rectangle') return [from, [at[0], from[1]], at, [from[0], at[1]]];
    if (this.tool === 'circle') return circle(from[0], from[1], Math.hypot(at[0] - from[0], at[1] - from[1])).points;
    return null;
  }

  // ---------------------------------------------------------- pointer

  /** @returns {[number, number]} where a pointer is on the board */
  place(event) {
    const { left, top } = this.svg.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  snap(event, plan = this.plan, skip = undefined) {
    const reach = (event.pointerType === 'touch' ? 20 : 11) / this.ink.view.scale;
    return snapped(this.ink.toPlan(...this.place(event)), plan, this.draft, { reach, step: this.ink.step, skip });
  }

  down(event) {
    this.fingers.set(event.pointerId, this.place(event));
    this.svg.setPointerCapture(event.pointerId);
    this.press = { at: this.place(event), view: { ...this.ink.view }, moved: false, several: this.fingers.size > 1, pan: event.button === 1 || event.button === 2 };
    if (this.tool !== 'move' || this.press.pan) return;
    this.hot = this.under(event);
    const [from] = this.hot?.segment === undefined ? this.placesAt(this.hot) : [];
    Object.assign(this.press, { from, frame: !from && event.shiftKey, plan: this.plan, chosen: from && isAt(this.chosen)(from) ? this.chosen : from && [from] });
  }

  move(event) {
    const { press } = this;
    const before = this.fingers.get(event.pointerId);
    if (before) this.fingers.set(event.pointerId, this.place(event));
    if (press?.several) {
      this.pinch(event.pointerId, before);
      return;
    }
    const at = this.place(event);
    if (press && Math.hypot(at[0] - press.at[0], at[1] - press.at[1]) > CLICK_TOLERANCE) press.moved = true;
    if (press?.moved && press.from) this.drag(event);
    else if (press?.moved && press.frame) {
      press.band = [press.at, at];
      this.draw();
    } else if (press?.moved && (press.pan || this.tool === 'move' || this.tool === 'hold')) {
      const { x, y, scale } = press.view;
      this.ink.view = { x: x - (at[0] - press.at[0]) / scale, y: y + (at[1] - press.at[1]) / scale, scale };
      this.draw();
    } else this.hover(event);
  }

  hover(event) {
    this.pointer = event && this.tool !== 'move' && this.tool !== 'hold' ? this.snap(event) : null;
    if (event) this.hot = this.tool === 'move' || this.tool === 'hold' ? this.under(event) : null;
    this.draw();
  }

  up(event) {
    const { press } = this;
    this.lift(event);
    if (!press || press.several || press.pan) return;
    if (press.band) this.frame(press.band);
    if (press.moved && (this.tool === 'move' || this.tool === 'hold')) return;
    if (this.tool === 'hold') this.hold(this.under(event));
    else if (this.tool === 'move') {
      this.choosePlaces(this.placesAt(this.under(event)), event.shiftKey);
      this.ask(event);
    }
    else this.put(this.snap(event).at);
    // Focus the field so that a length can be typed immediately.
    if (event.pointerType !== 'touch' && !this.typing.field.parentElement.hidden) this.typing.field.focus({ preventScroll: true });
  }

  lift(event) {
    this.fingers.delete(event.pointerId);
    if (!this.fingers.size) this.press = null;
  }

  pinch(id, before) {
    const [other] = [...this.fingers].filter(([each]) => each !== id).map(([, at]) => at);
    const now = this.fingers.get(id);
    if (!other || !before) return;
    const [old, fresh] = [before, now].map((at) => Math.hypot(at[0] - other[0], at[1] - other[1]) || 1);
    const middle = [(before[0] + other[0]) / 2, (before[1] + other[1]) / 2];
    const held = this.ink.toPlan(middle[0], middle[1]);
    this.zoomTo(held, [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2], fresh / old);
  }

  wheel(event) {
    event.preventDefault();
    const at = this.place(event);
    this.zoomTo(this.ink.toPlan(...at), at, Math.exp(-0.0012 * event.deltaY));
  }

  /** Zoom so that a point of the plan lies at a given point on the screen. */
  zoomTo(held, at, factor) {
    this.ink.view.scale = Math.max(1e-6, Math.min(1e6, this.ink.view.scale * factor));
    const there = this.ink.toPlan(at[0], at[1]);
    this.ink.view.x += held[0] - there[0];
    this.ink.view.y += held[1] - there[1];
    this.draw();
  }

  /** Return the point, column, segment or dimension under the pointer. */
  under(event) {
    const at = this.place(event);
    const reach = event.pointerType === 'touch' ? 22 : 11;
    const near = (point) => {
      const [x, y] = this.ink.toScreen(point);
      return Math.hypot(x - at[0], y - at[1]);
    };
    const label = document.elementsFromPoint(event.clientX, event.clientY).find((each) => each.dataset?.size);
    for (const [number, { x, y }] of this.plan.columns.entries()) if (near([x, y]) <= reach) return { column: number };
    for (const [number, line] of this.plan.lines.entries()) {
      const point = placesOf(line).findIndex((each) => near(each) <= reach);
      if (point >= 0 && (this.tool === 'move' || !line.circle)) return { line: number, point };
    }
    if (label && this.tool === 'move') {
      const [line, segment] = label.dataset.size.split(' ').map(Number);
      return { line, segment, label: true };
    }
    for (const [number, line] of this.plan.lines.entries()) {
      for (const [segment, [a, b]] of segmentsOf(line).entries()) {
        if (distanceTo(at, this.ink.toScreen(a), this.ink.toScreen(b)) <= reach) return { line: number, segment };
      }
    }
    return null;
  }

  // ---------------------------------------------------------- drawing

  /** Add the next point; return whether it was added. */
  put(at) {
    const point = at.map(tidy);
    const { draft, tool } = this;
    this.trouble = '';
    if (tool === 'column') {
      this.change({ ...this.plan, columns: [...this.plan.columns, { x: point[0], y: point[1], height: 0 }] });
      return true;
    }
    const [first] = draft;
    const again = first && Math.hypot(point[0] - first[0], point[1] - first[1]) < 1e-9;
    const shape = this.shape(point);
    if (shape && !again) {
      const line = tool === 'circle' ? circle(first[0], first[1], Math.hypot(point[0] - first[0], point[1] - first[1])) : { points: shape, closed: true, held: [] };
      if (tool === 'circle' || (point[0] !== first[0] && point[1] !== first[1])) this.add(line);
    } else if (again && draft.length > 2) this.add({ points: draft, closed: true, held: [] });
    else if (draft.some(([x, y]) => Math.hypot(x - point[0], y - point[1]) < 1e-9)) return false;
    else this.draft = [...draft, point];
    this.draw();
    return true;
  }

  /** End a line: the outline if there is none yet, else a crease. */
  finish() {
    const { draft, tool } = this;
    if (tool === 'line' && draft.length > 1) this.add({ points: draft, closed: draft.length > 2 && !this.hasOutline(), held: [] });
  }

  add(line) {
    this.draft = [];
    this.change({ ...this.plan, lines: [...this.plan.lines, line] });
  }

  change(plan, key) {
    this.plan = plan;
    this.draw();
    this.listener.change(plan, key);
  }

  drag(event) {
    // From the plan before the drag, so that points passed on the way are not taken along.
    const { chosen, from, plan } = this.press;
    const to = this.snap(event, plan, chosen).at;
    const by = [to[0] - from[0], to[1] - from[1]];
    if (this.chosen.length) this.chosen = chosen.map(([x, y]) => [x + by[0], y + by[1]]);
    this.change(withMoved(plan, chosen, by), `move ${from}`);
  }

  /**
   * Select places.
   * @param {number[][]} places
   * @param {boolean} more keep those that are selected; selected places are deselected
   */
  choosePlaces(places, more) {
    const others = more ? this.chosen.filter((own) => !isAt(places)(own)) : [];
    const known = more && places.every(isAt(this.chosen));
    this.chosen = known ? others : [...others, ...places];
  }

  /** Add the places within a frame on the screen to the selection. */
  frame([a, b]) {
    const isWithin = (at) => [0, 1].every((axis) => at[axis] >= Math.min(a[axis], b[axis]) && at[axis] <= Math.max(a[axis], b[axis]));
    this.chosen = [...this.chosen, ...this.places().filter((place) => isWithin(this.ink.toScreen(place)))];
    this.draw();
  }

  hold(found) {
    const [corner] = found && found.segment === undefined ? this.placesAt(found) : [];
    if (corner && this.plan.lines.some((own) => !own.circle && own.points.some(isAt([corner])))) this.change(withCorner(this.plan, corner));
    if (found?.line === undefined || found.segment === undefined) return;
    const line = this.plan.lines[found.line];
    if (!line.closed) return;
    const all = line.circle ? line.points.map((_, k) => k) : [found.segment];
    const held = line.held.includes(found.segment) ? line.held.filter((k) => !all.includes(k)) : [...line.held, ...all];
    this.change({ ...this.plan, lines: this.plan.lines.map((own, k) => (k === found.line ? { ...own, held } : own)) });
  }

  /** Ask for the new length of a dimension. */
  ask(event) {
    const found = this.under(event);
    this.asking = found?.label ? found : null;
    this.draw();
    if (!this.asking) return;
    const [a, b] = segmentsOf(this.plan.lines[found.line])[found.segment];
    this.typing.field.value = String(tidy(Math.hypot(b[0] - a[0], b[1] - a[1])));
    this.typing.field.select();
  }

  /** Apply the typed text. */
  take() {
    const { value } = this.typing.field;
    if (this.asking) {
      const { line, segment } = this.asking;
      const length = numberIn(value);
      this.asking = null;
      this.typing.field.value = '';
      if (length > 0) {
        this.change({ ...this.plan, lines: this.plan.lines.map((own, k) => (k === line ? { ...withLength(own, segment, length), circle: undefined } : own)) });
      } else this.draw();
      return;
    }
    if (!value.trim()) {
      this.trouble = '';
      this.finish();
      return;
    }
    const point = typedPoint(value, this.draft.at(-1) ?? null, this.pointer?.at ?? null);
    const put = point && this.put(point);
    if (put) this.typing.field.value = '';
    else this.trouble = point ? DUPLICATE : UNREAD[this.draft.length ? 1 : 0];
    this.draw();
  }

  /** Remove the last point; return whether there was one. */
  back() {
    if (!this.draft.length) return false;
    this.draft = this.draft.slice(0, -1);
    this.draw();
    return true;
  }

  typingKey(event) {
    if (event.key === 'Enter') {
      event.preventDefault();
      this.take();
    } else if (event.key === 'Escape') this.leave();
    else if (event.key === 'Backspace' && !this.typing.field.value) this.back();
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^[\d.,-]$/.test(event.key) && !this.typing.field.parentElement.hidden) {
      this.typing.field.focus();
      return;
    }
    const shift = { ArrowLeft: [-40, 0], ArrowRight: [40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] }[event.key];
    if (shift) {
      this.ink.view.x += shift[0] / this.ink.view.scale;
      this.ink.view.y += shift[1] / this.ink.view.scale;
    } else if (event.key === '+' || event.key === '-') {
      const middle = [this.ink.view.x, this.ink.view.y];
      this.zoomTo(middle, this.ink.toScreen(middle), event.key === '+' ? 1.2 : 1 / 1.2);
    } else if (event.key === 'f') this.ink.fit(boundsOf(this.plan));
    else if (event.key === 'Enter') this.finish();
    else if (event.key === 'Escape') this.leave();
    else if ((event.key === 'Delete' || event.key === 'Backspace') && this.chosen.length) this.change(without(this.plan, this.chosen));
    else if (event.key === 'Backspace') this.back();
    else return;
    event.preventDefault();
    this.draw();
  }
}

function distanceTo(at, a, b) {
  const along = [b[0] - a[0], b[1] - a[1]];
  const share = Math.max(0, Math.min(1, ((at[0] - a[0]) * along[0] + (at[1] - a[1]) * along[1]) / (along[0] ** 2 + along[1] ** 2 || 1)));
  return Math.hypot(at[0] - a[0] - share * along[0], at[1] - a[1] - share * along[1]);
}
