/** The studio: drawing, problem, solve and builds. */

import { showNotes, showTitle } from './about.js';
import { showColumns } from './columns.js';
import { listen } from './commands.js';
import { Crown } from './crown.js';
import { heldIn, withChoice, withColour, withGoals, withHeight, withLaw, withName } from './design/edits.js';
import { History } from './design/history.js';
import { Board } from './draw/board.js';
import { Desk } from './draw/desk.js';
import { meshed } from './draw/meshing.js';
import { toolsOf } from './edit/tools.js';
import { Goals } from './goals.js';
import { Legend } from './legend.js';
import { Limit } from './limit.js';
import { Maker } from './make/maker.js';
import { Model } from './model.js';
import { pack } from './packed.js';
import { Painter } from './painter.js';
import { Readout } from './readout.js';
import { Regions } from './regions.js';
import { buttonsOf, rowOf } from './remedies.js';
import { Scene } from './scene.js';
import { SectionCard } from './see/sectioncard.js';
import { Settings } from './settings.js';
import { shareMenu } from './share.js';
import { Solving } from './solving.js';

const SMALL = 3000; // number of vertices up to which solves follow a slider

/** @type {(id: string) => any} the elements are those of index.html */
const $ = (id) => document.getElementById(id);

/** The design, its views and its solves. */
export class Studio {
  /**
   * @param {import('./api.js').Api} api
   * @param {import('./design/keep.js').Keep} keep
   * @param {{offer: () => void, say: (text: string) => void}} welcome the start page
   */
  constructor(api, keep, welcome) {
    this.model = null;
    this.built = null;
    this.only = false; // whether the design may only be viewed
    /** @type {?(Float64Array | Float32Array)} */
    this.shown = null;
    this.api = api;
    this.keep = keep;
    this.welcome = welcome;
    this.history = new History(() => this.stepped());
    this.scene = new Scene($('canvas'));
    this.painter = new Painter(this.scene, new Legend($('legend')), (xyz) => this.api.curvatures(this.surfaceOf(xyz)));
    this.regions = new Regions($('regions'), {
      change: (key, held) => this.given(key, held),
      release: () => this.solving.release(),
      over: (regions) => this.light(regions),
      law: (region, law) => this.edit(withLaw(this.data, region, law), `law ${region}`),
      name: (region, name) => this.dress(withName(this.data, region, name)),
      colour: (region, colour) => this.dress(withColour(this.data, region, colour), `colour ${region}`),
    });
    this.settings = new Settings($('panel'), this.api, {
      change: (key) => this.given(key),
      hold: (choice) => this.edit(withChoice(this.data, choice)),
    });
    this.goals = new Goals($('panel'), (goals, key) => this.edit(withGoals(this.data, goals), key));
    this.solving = new Solving(this);
    this.limit = new Limit($('limit-said'), this.api, this.regions, () => ({ ...this.solving.request(), goals: this.model.goals }));
    this.readout = new Readout($('readout'), this.scene, (vertex) => this.painter.look(vertex));
    this.section = new SectionCard($('section'), this.scene);
    this.crown = new Crown($('crown'), this.scene, (rise) => this.edit(withGoals(this.data, { rise, found: true }), 'rise'));
    this.scene.after = () => this.crown.place();
    this.scene.lost = (gone) => ($('lost').hidden = !gone);
    this.hand = toolsOf(this, $('hand'));
    this.board = new Board($('board'), { field: $('draw-field'), label: $('draw-label'), hint: $('draw-hint') }, { change: (plan, key) => this.draw({ plan }, key) });
    this.desk = new Desk($('desk'), this.board, {
      change: (plan, key) => this.draw({ plan }, key),
      name: (name) => this.draw({ name }, 'name'),
      mesh: () => this.mesh(),
    });
    this.maker = new Maker(
      $('making'),
      this.api,
      {
        job: () => this.solving.solver.finished,
        rough: () => this.solving.result?.report.verdict?.fair === false,
        name: () => this.model.name,
        show: (drawn) => this.showBuilt(drawn),
      },
      $('sheets'),
    );
    this.keep.more = () => this.stored();
    this.keep.parted = () => {
      $('share-said').textContent = 'This design is open in another tab, too. This tab continues with a copy, and both are kept.';
      $('share').open = true;
    };
    shareMenu($('share'), { api, state: () => this.history.now, whole: () => ({ ...this.history.now, ...this.stored(), id: this.keep.id }), picture: async () => (this.model ? this.scene.picture() : null) });
    listen(this);
  }

  // ---------------------------------------------------------- the design

  /** Open a design. */
  begin({ stage, name, plan, data, solved = false, solution = null, states = null, at = 0, view = null, only = false }) {
    this.solving.solver.reset();
    this.only = only;
    document.body.classList.toggle('only', only);
    this.toggleWelcome(false);
    this.data = null;
    if (states?.[at]) this.history.restore(states, at);
    else this.history.begin({ stage, name, plan, data });
    this.show(this.history.now);
    if (stage === 'draw') this.board.fit();
    else if (solution) this.solving.restore(solution, view);
    else if (solved && data) this.solving.begin();
  }

  /** Return what is stored beside the present state: the solved surface, the history and the view. */
  stored() {
    const { history, scene, solving } = this;
    return { solution: solving.of && solving.of === this.data ? solving.result : null, states: history.states, at: history.at, view: scene.view };
  }

  /** Show a new model of a file or an example. */
  open(data, again = null) {
    this.keep.leave();
    this.begin({ stage: 'shape', name: data.name, plan: null, data });
    $('even').hidden = !again;
    $('even').onclick = again;
  }

  /** Take a step of the history. */
  step(way) {
    if (this.only) return;
    if (way === 'undo' && this.history.now?.stage === 'draw' && this.board.back()) return;
    const state = this.history[way]();
    if (!state) return;
    this.show(state);
    if (state.stage === 'shape') this.solving.changed();
  }

  /** The state in the history has changed. */
  stepped() {
    $('undo').disabled = !this.history.canUndo;
    $('redo').disabled = !this.history.canRedo;
    const { now } = this.history;
    if (now && !this.only) this.keep.put({ ...now, solved: this.solving.result !== null });
  }

  /** Change the drawing. */
  draw(change, key) {
    const state = { ...this.history.now, ...change };
    this.history.push(state, key);
    this.show(state);
  }

  /** Change supports, targets or goals. */
  edit(data, key) {
    this.dress(data, key);
    this.solving.changed();
  }

  /** Change names and colours, which do not affect the surface. */
  dress(data, key) {
    const known = this.solving.of === this.data;
    this.history.push({ ...this.history.now, data }, key);
    this.present(data);
    if (known) this.solving.of = data;
  }

  /** Show a state: the drawing, or the surface. */
  show({ stage, name, plan, data }) {
    const drawing = stage === 'draw';
    document.body.classList.remove('empty');
    document.body.classList.toggle('draws', drawing);
    for (const id of ['desk', 'drawing']) $(id).hidden = !drawing;
    for (const id of ['panel', 'view', 'outcome']) $(id).hidden = drawing;
    for (const id of ['steps', 'another']) $(id).hidden = false;
    if (drawing) {
      this.solving.solver.stop();
      this.desk.show(plan, name);
      $('about').textContent = name || 'A new roof';
      document.title = `${name || 'A new roof'} – compas_cgc`;
    } else this.present(data);
    $('redraw').hidden = !plan;
  }

  /** Mesh the drawing. */
  async mesh() {
    const state = this.history.now;
    const trouble = $('desk-trouble');
    trouble.hidden = true;
    document.body.classList.add('reading');
    $('desk').elements.mesh.disabled = true;
    $('plan-count').textContent = 'Making the mesh …';
    try {
      this.draw({ stage: 'shape', data: await meshed(this.api, state) });
      // Show the roof in perspective first, not in plan.
      if ($('drag').checked) this.solving.begin();
    } catch (error) {
      const buttons = buttonsOf(this, error.remedies);
      trouble.replaceChildren(error.message, ...(buttons.length ? [rowOf(buttons)] : []));
      trouble.hidden = false;
      this.desk.show(state.plan, state.name);
    } finally {
      document.body.classList.remove('reading');
      $('desk').elements.mesh.disabled = false;
    }
  }

  /** Show a model, or its changes. */
  present(data) {
    const { data: old } = this;
    const mesh = !old || old.faces !== data.faces;
    const shape = mesh || old.vertices !== data.vertices || old.creases !== data.creases;
    this.data = data;
    const kept = !mesh && this.solving.result ? this.shown : null;
    const model = new Model(data);
    if (!mesh) model.edges = this.model.edges;
    this.model = model;
    this.painter.show(model);
    if (mesh) {
      this.solving.clear();
      for (const id of ['panel', 'tools', 'marks', 'hand', 'outcome', 'view']) $(id).hidden = false;
      $('canvas').ariaLabel = `3D view of ${model.name}. Arrow keys turn it, plus and minus zoom, F shows all.`;
      $('drag').checked = model.count <= SMALL;
      $('even').hidden = true;
      this.section.close();
      this.hand.take('look');
    }
    if (shape) {
      this.scene.show(model, !mesh);
      this.hand.show(model.graph, new Set(data.supports.corners));
      // A solved surface continues from its current position.
      this.place(kept ?? model.xyz, null, Boolean(kept));
      this.mark([]);
    } else {
      this.scene.surface.model = model;
      this.scene.surface.tint(model);
    }
    showTitle($('about'), model);
    showNotes($('words'), model, (remedies) => buttonsOf(this, remedies));
    for (const each of document.querySelectorAll('.unit.length')) each.textContent = model.unit ? `in ${model.unit}` : '';
    $('unit').textContent = `in ${model.curvatureUnit}`;
    $('crease-mark').hidden = !model.creases.length;
    this.regions.show(model);
    this.settings.show(model);
    this.goals.show(data.wishes, model);
    this.regions.follow(Boolean(data.wishes?.found && data.wishes.rise != null));
    const { held } = model;
    if (shape || heldIn(old) !== held) this.limit.clear();
    showColumns($('columns'), model, held, (vertices, height) => this.edit(withHeight(this.data, vertices, height), `height ${vertices}`));
    this.scene.surface.setSupports(held);
    this.scene.surface.extras.rooms(this.roomsOf(data));
    this.painter.measure(this.shown, held, this.measured);
    this.crown.show(model, this.shown, held);
    this.paint();
  }

  /** Show the mesh with the flipped faces of a result, or with its own faces. */
  turn(faces) {
    if (!this.model.turn(faces)) return;
    this.painter.show(this.model);
    this.scene.show(this.model, true);
    this.scene.surface.setSupports(this.model.held);
    this.scene.surface.extras.rooms(this.roomsOf(this.data));
  }

  roomsOf({ wishes }) {
    const { model } = this;
    const floor = model.bounds.low[2];
    return (wishes?.boxes ?? []).map(({ x0, y0, x1, y1, height }) => [...model.toScene([x0, y0, floor]), ...model.toScene([x1, y1, height])]);
  }

  /** Update everything that depends on the displayed surface. */
  know(xyz, measured) {
    this.shown = xyz;
    this.measured = measured;
  }

  /** Return the surface with given coordinates as a request. */
  surfaceOf(xyz) {
    const { model, settings } = this;
    const { creases, faces } = model;
    return { vertices: pack(xyz, 'f8', [model.count, 3]), faces: pack(faces, 'i4', [faces.length / 3, 3]), creases, supports: settings.supports };
  }

  /** Show the surface with given coordinates. */
  place(xyz, measured = null, jump = false) {
    this.know(xyz, measured);
    this.scene.moveTo(this.model.toScene(xyz), !jump);
    this.section.show(this.model, xyz);
  }

  /** Reset to the original model. */
  reset() {
    const first = this.history.states.find(({ data }) => data && data.faces === this.data.faces) ?? this.history.now;
    this.data = null;
    this.history.push({ ...this.history.now, data: first.data });
    this.present(first.data);
    this.scene.fit();
  }

  toggleWelcome(show = $('welcome').hidden) {
    $('welcome').hidden = !show;
    $('another').textContent = show ? 'Back' : 'Open';
    $('steps').hidden = show || !this.history.now;
    if (show) this.keep.now().then(() => this.welcome.offer());
    else this.welcome.say('');
  }

  colour(by) {
    const radio = $('colours').querySelector(`[value="${by}"]`);
    for (const each of $('colours').querySelectorAll('input')) each.checked = each === radio;
    $('more-colours').value = radio ? '' : by;
    this.painter.by = by;
    this.painter.paint();
  }

  paint() {
    this.painter.want(this.regions.targets);
    this.painter.paint();
  }

  /** Mark rough places of the surface. */
  mark(places) {
    this.scene.surface.mark(places);
    $('rough-mark').hidden = !places.length;
  }

  light(regions) {
    this.scene.surface.highlight(regions);
    this.scene.draw();
  }

  /** Show a build on the surface. */
  showBuilt(drawn) {
    const { surface } = this.scene;
    if (!surface || !(drawn || this.built)) return;
    this.built = drawn;
    surface.extras.build(drawn, (point) => this.model.toScene(point));
    const faces = Boolean(drawn?.faces.length);
    surface.mesh.visible = surface.edges.visible = !faces;
    this.scene.draw();
  }
  // ---------------------------------------------------------- targets and settings

  /** A slider or a setting has changed. */
  given(key, held = false) {
    const { method, settings } = this.settings.asked;
    const data = { ...this.data, targets: this.regions.targets.slice(), method, settings };
    this.data = data;
    this.model.targets = data.targets;
    this.history.push({ ...this.history.now, data }, key);
    this.solving.changed(held);
  }

  /** Show the K solved for the goals, without a step in the history. */
  takeTargets(targets) {
    this.data = { ...this.data, targets };
    this.history.now.data = this.data;
    this.model.targets = targets;
    this.regions.set(targets);
    this.painter.want(targets);
  }
}
