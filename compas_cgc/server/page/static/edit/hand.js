/** Pointer events on the surface; the active tool determines the effect of a click. */

const CLICK_TOLERANCE = 5; // pointer movement during a click [pixel]

/**
 * @typedef {object} Desk what the hand works on
 * @property {(vertices: number[]) => void} hold called with vertices to support or release
 * @property {(path: number[]) => void} fold
 * @property {(vertex: number) => void} erase
 * @property {(region: number) => void} region
 * @property {(a: number, b: number) => void} section
 * @property {(a: number[], b: number[]) => void} box
 * @property {() => void} look called when the tool is deselected
 */

/** Tools on the surface. */
export class Hand {
  /**
   * @param {import('../scene.js').Scene} scene
   * @param {Desk} desk
   */
  constructor(scene, desk) {
    this.scene = scene;
    this.desk = desk;
    this.tool = 'look';
    this.anchors = [];
    this.path = [];
    this.cursor = -1;
    this.waiting = false;
    const { canvas } = scene;
    canvas.addEventListener('pointerdown', (event) => (this.press = [event.clientX, event.clientY]));
    canvas.addEventListener('pointerup', (event) => {
      const still = this.press && Math.hypot(event.clientX - this.press[0], event.clientY - this.press[1]) < CLICK_TOLERANCE;
      this.press = null;
      if (still && event.button === 0) this.click(event.clientX, event.clientY);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!this.press && event.pointerType !== 'touch') this.hover(event.clientX, event.clientY);
    });
    canvas.addEventListener('pointerleave', () => this.point(-1));
    canvas.addEventListener('keydown', (event) => this.key(event), true);
  }

  /**
   * Select a tool.
   * @param {string} tool look, point, side, fold, erase, section or box
   */
  choose(tool) {
    this.tool = tool;
    this.scene.canvas.dataset.tool = tool;
    this.scene.plain = tool !== 'look';
    this.drop();
  }

  /**
   * Switch to another mesh.
   * @param {import('../mesh/graph.js').Graph} graph
   * @param {Set<number>} corners of its boundary
   */
  show(graph, corners) {
    this.graph = graph;
    this.corners = corners;
    this.drop();
  }

  /** Discard an unfinished operation. */
  drop() {
    this.anchors = [];
    this.path = [];
    this.point(-1);
  }

  hover(x, y) {
    if (this.tool === 'look' || this.tool === 'box') return;
    /** @type {[number, number]} */
    this.place = [x, y];
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.point(this.scene.pick(...this.place)?.vertex ?? -1);
    });
  }

  /** Preview the effect of a click on a vertex. */
  point(vertex) {
    this.cursor = vertex;
    const { surface } = this.scene;
    if (!surface) return;
    const trail = [];
    if (vertex >= 0 && this.tool === 'fold' && this.anchors.length) trail.push(...this.path, ...this.wayTo(vertex));
    else if (this.tool === 'fold') trail.push(...this.path);
    if (vertex >= 0 && this.tool === 'side') trail.push(...this.graph.side(vertex, this.corners));
    surface.extras.cursor(vertex >= 0 ? [vertex, ...this.anchors] : this.anchors, surface.xyz);
    surface.extras.trail(trail, surface.xyz);
    this.scene.draw();
  }

  wayTo(vertex) {
    const last = this.anchors.at(-1);
    if (vertex === last) return [];
    return this.graph.way(this.scene.surface.xyz, last, vertex).slice(this.path.length ? 1 : 0);
  }

  click(x, y) {
    if (this.tool === 'box') {
      this.ground(this.scene.groundAt(x, y));
      return;
    }
    const found = this.scene.pick(x, y);
    if (found && this.tool === 'look') this.desk.region(found.region);
    else if (found) this.act(found.vertex);
  }

  ground(at) {
    if (!at) return;
    this.corner = this.corner ? (this.desk.box(this.corner, at), null) : at;
  }

  act(vertex) {
    if (this.tool === 'point') this.desk.hold([vertex]);
    else if (this.tool === 'side') {
      const side = this.graph.side(vertex, this.corners);
      if (side.length) this.desk.hold(side);
    } else if (this.tool === 'erase') this.desk.erase(vertex);
    else if (this.tool === 'fold') this.fold(vertex);
    else if (this.tool === 'section') {
      this.anchors = [...this.anchors, vertex];
      if (this.anchors.length === 2) {
        const [a, b] = this.anchors;
        this.drop();
        this.desk.section(a, b);
      }
    }
    this.point(this.cursor);
  }

  /** Continue to a vertex; a crease ends on the boundary, on another crease, or at a second click on the same vertex. */
  fold(vertex) {
    if (!this.anchors.length) {
      this.anchors = [vertex];
      return;
    }
    if (vertex === this.anchors.at(-1)) {
      this.finish();
      return;
    }
    const more = this.wayTo(vertex);
    if (!more.length) return;
    this.path = [...this.path, ...more];
    this.anchors = [...this.anchors, vertex];
    if (this.graph.rim[vertex].length || this.scene.surface.model.onCrease[vertex] || vertex === this.path[0]) this.finish();
  }

  finish() {
    const { path } = this;
    this.drop();
    if (path.length > 1) this.desk.fold(path);
  }

  key(event) {
    if (this.tool === 'look' || event.ctrlKey || event.metaKey || event.altKey) return;
    const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (turn && !event.shiftKey) this.point(this.next(turn));
    else if (event.key === 'Enter' || event.key === ' ') {
      if (this.cursor >= 0) this.act(this.cursor);
    } else if (event.key === 'Escape') {
      if (this.anchors.length) this.drop();
      else this.desk.look();
    } else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  /** Return the neighbour of the cursor vertex in a direction on the screen. */
  next([right, up]) {
    const { surface } = this.scene;
    if (this.cursor < 0) return this.scene.central();
    const at = (vertex) => this.scene.onScreen(surface.xyz, vertex);
    const here = at(this.cursor);
    const gain = (vertex) => {
      const there = at(vertex);
      const [x, y] = [there[0] - here[0], here[1] - there[1]];
      return (right * x + up * y) / (Math.hypot(x, y) || 1);
    };
    const best = this.graph.near[this.cursor].reduce((most, vertex) => (most < 0 || gain(vertex) > gain(most) ? vertex : most), -1);
    return best >= 0 && gain(best) > 0.2 ? best : this.cursor;
  }
}
