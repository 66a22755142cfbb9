/** Where a roof is drawn, posed, solved and built: all but the first page, put together. */

import { showNotes, showTitle } from './about.js';
import { Charts } from './charts.js';
import { showColumns } from './columns.js';
import { Crown } from './crown.js';
import { heldIn, withChoice, withColour, withCrease, withGoals, withHeight, withHeld, withName, withoutCrease } from './design/edits.js';
import { asked } from './design/goals.js';
import { History } from './design/history.js';
import { download } from './download.js';
import { Board } from './draw/board.js';
import { Desk } from './draw/desk.js';
import { requestOf } from './draw/plan.js';
import { Hand } from './edit/hand.js';
import { Goals } from './goals.js';
import { Legend } from './legend.js';
import { Maker } from './make/maker.js';
import { Model } from './model.js';
import { Painter } from './painter.js';
import { showProgress } from './progress.js';
import { Readout } from './readout.js';
import { Regions } from './regions.js';
import { Rhythm } from './rhythm.js';
import { Scene } from './scene.js';
import { SectionCard } from './see/sectioncard.js';
import { Settings } from './settings.js';
import { shareMenu } from './share.js';
import { Solver } from './solver.js';
import { Verdict } from './verdict.js';
import { capital } from './words.js';

const SMALL = 3000; // vertices up to which a solve keeps up with a slider
const WORTH = 200; // milliseconds; what is over sooner needs no word
const QUICK = 0.3; // seconds; a surface that follows a slider so soon is near the one before, and need not glide there
const CLOSE = 0.05; // of the limit that is looked for; a mark on a slider is no finer

/** @type {(id: string) => any} the elements are those of index.html */
const $ = (id) => document.getElementById(id);

/** The design, its views and its solves. */
export class Studio {
  /**
   * @param {import('./api.js').Api} api
   * @param {import('./design/keep.js').Keep} keep
   * @param {{offer: () => void, say: (text: string) => void}} welcome the first page
   */
  constructor(api, keep, welcome) {
    this.model = null;
    this.result = null;
    this.before = null;
    this.built = null;
    this.api = api;
    this.keep = keep;
    this.welcome = welcome;
    this.history = new History(() => this.stepped());
    this.scene = new Scene($('canvas'));
    this.painter = new Painter(this.scene, new Legend($('legend')));
    this.regions = new Regions($('regions'), {
      change: (key) => this.given(key),
      over: (regions) => this.light(regions),
      name: (region, name) => this.dress(withName(this.data, region, name)),
      colour: (region, colour) => this.dress(withColour(this.data, region, colour), `colour ${region}`),
    });
    this.settings = new Settings($('panel'), this.api, {
      change: (key) => this.given(key),
      hold: (choice) => this.edit(withChoice(this.data, choice)),
    });
    this.goals = new Goals($('panel'), (goals, key) => this.edit(withGoals(this.data, goals), key));
    this.charts = new Charts($('chart-error'), $('chart-energy'));
    this.verdict = new Verdict($('verdict'));
    this.solver = new Solver(this.api, this);
    this.rhythm = new Rhythm(this.solver, () => this.solve());
    this.readout = new Readout($('readout'), this.scene, (vertex) => this.painter.look(vertex));
    this.section = new SectionCard($('section'), this.scene);
    this.crown = new Crown($('crown'), this.scene, (rise) => this.edit(withGoals(this.data, { rise, found: true }), 'rise'));
    this.scene.after = () => this.crown.place();
    this.hand = new Hand(this.scene, {
      hold: (vertices) => this.hold(vertices),
      fold: (path) => this.edit(withCrease(this.data, path)),
      erase: (vertex) => this.erase(vertex),
      region: (region) => this.regions.focus(region),
      section: (a, b) => this.cut(a, b),
      box: (a, b) => this.room(a, b),
      look: () => this.take('look'),
    });
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
        job: () => this.solver.finished,
        rough: () => this.result?.report.verdict?.fair === false,
        name: () => this.model.name,
        show: (drawn) => this.showBuilt(drawn),
      },
      $('sheets'),
    );
    shareMenu($('share'), { state: () => this.history.now, picture: async () => (this.model ? this.scene.picture() : null) });
    this.listen();
  }

  listen() {
    $('panel').addEventListener('submit', (event) => {
      event.preventDefault();
      this.solve();
    });
    const clicks = {
      cancel: () => this.solver.cancel(),
      reset: () => this.reset(),
      fit: () => this.scene.fit(),
      'board-fit': () => this.board.fit(),
      another: () => this.toggleWelcome(),
      undo: () => this.step('undo'),
      redo: () => this.step('redo'),
      limit: () => this.findLimit(),
      redraw: () => this.draw({ stage: 'draw' }),
    };
    for (const [id, act] of Object.entries(clicks)) $(id).addEventListener('click', act);
    $('colours').addEventListener('change', ({ target }) => this.colour(target.value));
    $('more-colours').addEventListener('change', ({ target }) => this.colour(target.value || 'regions'));
    $('hand').addEventListener('change', ({ target }) => this.hand.choose(target.value));
    $('downloads').addEventListener('click', ({ target }) => this.download(target.dataset.format));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.scene.dress();
      this.charts.dress();
    });
    // A page that may come back keeps its result.
    window.addEventListener('pagehide', ({ persisted }) => {
      this.keep.hide();
      if (persisted) this.solver.stop();
      else this.solver.reset();
    });
    window.addEventListener('keydown', (event) => this.key(event));
  }

  key(event) {
    if (event.key === 'Escape' && this.history.now && !$('welcome').hidden) this.toggleWelcome();
    const typing = event.target.matches?.('input[type="text"], input[type="number"]') && event.target.value !== event.target.defaultValue;
    if (!(event.ctrlKey || event.metaKey) || typing) return;
    const back = event.key.toLowerCase() === 'z' && !event.shiftKey;
    if (back || event.key.toLowerCase() === 'y' || event.key.toLowerCase() === 'z') {
      event.preventDefault();
      this.step(back ? 'undo' : 'redo');
    }
  }

  // ---------------------------------------------------------- the design

  /** Begin with a design. */
  begin({ stage, name, plan, data, solved = false }) {
    this.solver.reset();
    this.toggleWelcome(false);
    this.data = null;
    this.history.begin({ stage, name, plan, data });
    this.show(this.history.now);
    if (stage === 'draw') this.board.fit();
    if (solved && data) this.solve();
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
    if (way === 'undo' && this.history.now?.stage === 'draw' && this.board.back()) return;
    const state = this.history[way]();
    if (!state) return;
    this.show(state);
    if (state.stage === 'shape') this.changed();
  }

  /** The history has another state. */
  stepped() {
    $('undo').disabled = !this.history.canUndo;
    $('redo').disabled = !this.history.canRedo;
    const { now } = this.history;
    if (now) this.keep.put({ ...now, solved: this.result !== null });
  }

  /** Change the drawing. */
  draw(change, key) {
    const state = { ...this.history.now, ...change };
    this.history.push(state, key);
    this.show(state);
  }

  /** Change what is asked. */
  edit(data, key) {
    this.dress(data, key);
    this.changed();
  }

  /** Change names and colours, which no surface depends on. */
  dress(data, key) {
    this.history.push({ ...this.history.now, data }, key);
    this.present(data);
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
      this.solver.stop();
      this.desk.show(plan, name);
      $('about').textContent = name || 'A new roof';
      document.title = `${name || 'A new roof'} – compas_cgc`;
    } else this.present(data);
    $('redraw').hidden = !plan;
  }

  /** Have the drawing meshed. */
  async mesh() {
    const { plan, name, data: old } = this.history.now;
    const trouble = $('desk-trouble');
    trouble.hidden = true;
    document.body.classList.add('reading');
    $('desk').elements.mesh.disabled = true;
    $('plan-count').textContent = 'Making the mesh …';
    try {
      let data = await this.api.drawing(requestOf(plan, name || 'Roof'));
      const outside = data.columns.filter((vertex) => vertex < 0).length;
      if (outside) data.notes.push(`${outside} column${outside > 1 ? 's stand' : ' stands'} outside of the outline`);
      for (const [k, vertex] of data.columns.entries()) if (vertex >= 0 && plan.columns[k].height) data = withHeight(data, [vertex], plan.columns[k].height);
      if (old) {
        const alike = old.targets.length === data.targets.length;
        data = { ...data, goals: old.goals, method: old.method, settings: old.settings, ...(alike ? { targets: old.targets, names: old.names, colours: old.colours } : {}) };
      }
      this.draw({ stage: 'shape', data });
    } catch (error) {
      trouble.textContent = error.message;
      trouble.hidden = false;
      this.desk.show(plan, name);
    } finally {
      document.body.classList.remove('reading');
      $('desk').elements.mesh.disabled = false;
    }
  }

  /** Show a model, or what has changed of it. */
  present(data) {
    const { data: old } = this;
    const mesh = !old || old.faces !== data.faces;
    const shape = mesh || old.vertices !== data.vertices || old.creases !== data.creases;
    this.data = data;
    const { result } = this;
    const kept = !mesh && result ? this.shown : null;
    const model = new Model(data);
    if (!mesh) model.edges = this.model.edges;
    this.model = model;
    this.painter.show(model);
    if (mesh) {
      this.solver.reset();
      this.result = this.painter.before = null;
      this.crown.on = false;
      for (const id of ['panel', 'tools', 'marks', 'hand', 'outcome', 'view']) $(id).hidden = false;
      $('canvas').ariaLabel = `3D view of ${model.name}. Arrow keys turn it, plus and minus zoom, F shows all.`;
      $('drag').checked = model.count <= SMALL;
      $('even').hidden = true;
      this.section.close();
      this.charts.clear();
      this.verdict.clear();
      for (const id of ['downloads', 'making', 'course', 'cancel', 'progress']) $(id).hidden = true;
      this.maker.clear();
      this.take('look');
    }
    if (shape) {
      this.scene.show(model, !mesh);
      this.hand.show(model.graph, new Set(data.supports.corners));
      // Once solved, the surface goes on from where it is.
      this.place(kept ?? model.xyz, null, Boolean(kept));
      this.mark([]);
    } else {
      this.scene.surface.model = model;
      this.scene.surface.tint(model);
    }
    showTitle($('about'), model);
    showNotes($('words'), model);
    for (const each of document.querySelectorAll('.unit.length')) each.textContent = model.unit ? `in ${model.unit}` : '';
    $('unit').textContent = `in ${model.curvatureUnit}`;
    $('crease-mark').hidden = !model.creases.length;
    this.regions.show(model);
    this.settings.show(model);
    this.goals.show(data.goals, model);
    this.regions.follow(Boolean(data.goals?.found && data.goals.rise != null));
    if (shape || old.supports !== data.supports || old.support_choice !== data.support_choice) this.unmark();
    const held = heldIn(data);
    showColumns($('columns'), model, held, (vertices, height) => this.edit(withHeight(this.data, vertices, height), `height ${vertices}`));
    this.scene.surface.setSupports(held);
    this.scene.surface.extras.rooms(this.roomsOf(data));
    this.painter.measure(this.shown, held, this.measured);
    this.crown.show(model, this.shown, held);
    this.paint();
  }

  roomsOf({ goals }) {
    const { model } = this;
    const floor = model.bounds.low[2];
    return (goals?.boxes ?? []).map(({ x0, y0, x1, y1, height }) => [...model.toScene([x0, y0, floor]), ...model.toScene([x1, y1, height])]);
  }

  /** Show the surface at some places. */
  place(xyz, measured = null, jump = false) {
    this.shown = xyz;
    this.measured = measured;
    this.scene.moveTo(this.model.toScene(xyz), !jump);
    this.section.show(this.model, xyz);
  }

  /** Go back to the model as it came. */
  reset() {
    const first = this.history.states.find(({ data }) => data && data.faces === this.data.faces) ?? this.history.now;
    this.solver.reset();
    this.rhythm.settle();
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

  // ---------------------------------------------------------- tools

  /** Take a tool. */
  take(tool) {
    $('hand').querySelector(`[value="${tool}"]`).checked = true;
    this.hand.choose(tool);
  }

  /** Hold vertices, or let them go where all are held. */
  hold(vertices) {
    const held = new Set(heldIn(this.data));
    this.edit(withHeld(this.data, vertices, !vertices.every((vertex) => held.has(vertex))));
  }

  erase(vertex) {
    if (this.model.onCrease[vertex]) this.edit(withoutCrease(this.data, vertex));
  }

  /** Keep a room clear between two places on the ground. */
  room(a, b) {
    const tidy = (value) => Number(value.toPrecision(3));
    const height = tidy(this.model.bounds.low[2] + 0.12 * this.model.size);
    this.goals.put({ x0: tidy(a[0]), y0: tidy(a[1]), x1: tidy(b[0]), y1: tidy(b[1]), height });
    this.take('look');
  }

  /** Cut the surface between two vertices. */
  cut(...vertices) {
    const [a, b] = vertices.map((vertex) => [0, 1, 2].map((axis) => this.shown[3 * vertex + axis]));
    this.section.open(a, b);
    this.section.show(this.model, this.shown);
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

  /** Mark the places where the surface is rough. */
  mark(places) {
    this.scene.surface.mark(places);
    $('rough-mark').hidden = !places.length;
  }

  light(regions) {
    this.scene.surface.highlight(regions);
    this.scene.draw();
  }

  /** Show what was built on the surface. */
  showBuilt(drawn) {
    const { surface } = this.scene;
    if (!surface || !(drawn || this.built)) return;
    this.built = drawn;
    surface.extras.build(drawn, (point) => this.model.toScene(point));
    const faces = Boolean(drawn?.faces.length);
    surface.mesh.visible = surface.edges.visible = !faces;
    this.scene.draw();
  }

  // ---------------------------------------------------------- what the supports carry

  unmark() {
    this.limiting?.abort();
    this.regions.mark(null);
    $('limit-said').hidden = true;
  }

  async findLimit() {
    this.unmark();
    const said = $('limit-said');
    const search = new AbortController();
    this.limiting = search;
    said.textContent = 'Looking for the largest K …';
    said.hidden = false;
    try {
      const { goals, unknown, method, settings, ...problem } = this.request();
      const found = await this.api.build({ ...problem, task: 'limits', settings: { tolerance: CLOSE } }, search.signal);
      this.api.forget(found.id).catch(() => {});
      if (this.limiting !== search) return;
      this.regions.mark(found.status === 'found' ? this.regions.targets.map((K) => (K ? K * found.factor : null)) : null);
      said.textContent = capital(found.message);
    } catch (error) {
      if (error.name !== 'AbortError') said.textContent = capital(error.message);
    }
  }

  // ---------------------------------------------------------- a solve

  /** A slider or a setting is another. */
  given(key) {
    const { method, settings } = this.settings.asked;
    const data = { ...this.data, targets: this.regions.targets.slice(), method, settings };
    this.data = data;
    this.model.targets = data.targets;
    this.history.push({ ...this.history.now, data }, key);
    this.changed();
  }

  changed() {
    this.painter.want(this.regions.targets);
    // The other colours do not know of targets, and to draw takes time that the solve waits for.
    if (this.painter.by === 'error') this.painter.paint();
    this.verdict.outdate();
    if ($('drag').checked) this.rhythm.changed();
  }

  request() {
    const { model } = this;
    return {
      name: model.name.slice(0, 100),
      unit: model.unit,
      ...model.mesh,
      creases: model.creases,
      constraints: model.constraints,
      targets: model.targetsOfVertices(this.regions.targets),
      ...asked(this.data.goals),
      ...this.settings.asked,
    };
  }

  solve() {
    this.maker.clear();
    this.rhythm.settle();
    if (!this.settings.valid) return;
    $('cancel').hidden = false;
    this.charts.clear();
    this.solver.solve(this.request());
    this.scene.expect();
  }

  /** Called by the solver while it runs. */
  progress(status) {
    showProgress($('progress'), status);
    $('progress').hidden = this.solver.age < WORTH;
    if (this.charts.add(status)) $('course').hidden = false;
  }

  /** Called by the solver with a surface on its way. */
  surface(xyz) {
    this.mark([]);
    this.place(xyz);
    this.painter.measure(xyz, this.settings.supports);
    this.painter.paint();
  }

  /** Called by the solver in the end. */
  done(result, status) {
    if (!result) {
      this.failed(status.message ?? 'The solve ended without a result', status.state === 'cancelled');
      return;
    }
    const first = this.result === null;
    if (this.result) this.painter.before = this.result.xyz;
    this.result = result;
    this.find(result);
    this.place(result.xyz, result.curvature, !first && result.seconds < QUICK);
    this.painter.measure(result.xyz, this.settings.supports, result.curvature);
    this.painter.paint();
    this.crown.show(this.model, result.xyz, this.settings.supports);
    this.crown.on = true;
    this.mark(result.report.verdict?.places ?? []);
    if (first) this.scene.fit();
    this.scene.flush();
    this.verdict.show(result, this.model);
    const drawn = this.charts.end(result.history);
    this.rest({ downloads: true, making: result.status !== 'cancelled', course: drawn });
    this.stepped();
  }

  /** Take the K that was found for the goals. */
  find(result) {
    const { goals } = this.data;
    if (!(goals?.found && goals.rise != null)) return;
    const targets = this.data.targets.map((K, region) => {
      const found = result.report.regions?.find((each) => each.region === region)?.target ?? K;
      return found === null ? null : Number(found.toPrecision(6));
    });
    this.data = { ...this.data, targets };
    this.history.now.data = this.data;
    this.model.targets = targets;
    this.regions.set(targets);
    this.painter.want(targets);
  }

  /** Called by the solver when there is no result. */
  failed(message, stopped = false) {
    this.verdict.fail(message, this.result !== null, stopped);
    this.rest({ downloads: false, making: false, course: false });
  }

  rest(shown) {
    for (const [id, on] of Object.entries({ ...shown, cancel: false, progress: false })) $(id).hidden = !on;
    this.rhythm.over();
  }

  async download(format) {
    if (!format) return;
    try {
      await download(this.api, this.solver.finished, format, this.model);
    } catch (error) {
      this.verdict.fail(error.message, true);
    }
  }
}
