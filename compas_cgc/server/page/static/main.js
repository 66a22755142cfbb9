/** The page put together. */

import { showNotes, showTitle } from './about.js';
import { Api } from './api.js';
import { Charts } from './charts.js';
import { download } from './download.js';
import { keyDialog } from './keydialog.js';
import { Legend } from './legend.js';
import { Model } from './model.js';
import { Painter } from './painter.js';
import { showProgress } from './progress.js';
import { Readout } from './readout.js';
import { Regions } from './regions.js';
import { Rhythm } from './rhythm.js';
import { Scene } from './scene.js';
import { Settings } from './settings.js';
import { Solver } from './solver.js';
import { Verdict } from './verdict.js';
import { Welcome } from './welcome.js';

const SMALL = 3000; // vertices up to which a solve keeps up with a slider
const WORTH = 200; // milliseconds; what is over sooner needs no word

const $ = (id) => document.getElementById(id);

/** The page. */
class Page {
  constructor() {
    this.model = null;
    this.result = null;
    this.api = new Api(keyDialog($('key')));
    this.scene = new Scene($('canvas'));
    this.painter = new Painter(this.scene, new Legend($('legend')));
    this.regions = new Regions($('regions'), { change: () => this.changed(), over: (region) => this.light(region) });
    this.settings = new Settings($('panel'), this.api, { change: () => this.changed(), hold: () => this.hold() });
    this.charts = new Charts($('chart-error'), $('chart-energy'));
    this.verdict = new Verdict($('verdict'));
    this.solver = new Solver(this.api, this);
    this.rhythm = new Rhythm(this.solver, () => this.solve());
    this.readout = new Readout(
      $('readout'),
      this.scene,
      (vertex) => this.painter.look(vertex),
      (region) => this.regions.focus(region),
    );
    this.welcome = new Welcome($('welcome'), this.api, (data) => this.open(data));
    this.listen();
  }

  listen() {
    $('panel').addEventListener('submit', (event) => {
      event.preventDefault();
      this.solve();
    });
    $('cancel').addEventListener('click', () => this.solver.cancel());
    $('reset').addEventListener('click', () => this.reset());
    $('fit').addEventListener('click', () => this.scene.fit());
    $('another').addEventListener('click', () => this.toggleWelcome());
    $('colours').addEventListener('change', ({ target }) => {
      this.painter.by = target.value;
      this.painter.paint();
    });
    $('downloads').addEventListener('click', ({ target }) => this.download(target.dataset.format));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.scene.dress();
      this.charts.dress();
    });
    // A page that may come back keeps its result.
    window.addEventListener('pagehide', ({ persisted }) => (persisted ? this.solver.stop() : this.solver.reset()));
    window.addEventListener('keydown', (event) => {
      if (event.key === 'Escape' && this.model && !$('welcome').hidden) this.toggleWelcome();
    });
  }

  // ---------------------------------------------------------- the model

  /** Show a new model. */
  open(data) {
    this.solver.reset();
    const model = new Model(data);
    this.model = model;
    document.body.classList.remove('empty');
    for (const id of ['panel', 'tools', 'marks', 'another', 'outcome']) $(id).hidden = false;
    this.toggleWelcome(false);
    showTitle($('about'), model);
    showNotes($('words'), model);
    $('canvas').ariaLabel = `3D view of ${model.name}. Arrow keys turn it, plus and minus zoom, F shows all.`;
    $('unit').textContent = `in ${model.curvatureUnit}`;
    $('crease-mark').hidden = !model.creases.length;
    $('drag').checked = model.count <= SMALL;
    this.scene.show(model);
    this.painter.show(model);
    this.regions.show(model);
    this.start();
  }

  /** Go back to the model as it came. */
  reset() {
    this.solver.reset();
    this.regions.reset();
    this.start();
    this.scene.fit();
  }

  start() {
    this.rhythm.settle();
    this.settings.show(this.model);
    this.charts.clear();
    this.verdict.clear();
    this.result = null;
    this.mark([]);
    for (const id of ['downloads', 'course', 'cancel', 'progress']) $(id).hidden = true;
    this.hold();
    this.scene.moveTo(this.model.toScene(this.model.xyz));
  }

  toggleWelcome(show = $('welcome').hidden) {
    $('welcome').hidden = !show;
    $('another').textContent = show ? 'Back' : 'Open another';
    if (!show) this.welcome.say('');
  }

  /** Take the supports that are chosen. */
  hold() {
    const { supports } = this.settings;
    this.scene.surface.setSupports(supports);
    this.painter.measure(this.result?.vertices.flat() ?? this.model.xyz, supports);
    this.paint();
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

  light(region) {
    this.scene.surface.highlight(region);
    this.scene.draw();
  }

  // ---------------------------------------------------------- a solve

  changed() {
    this.paint();
    this.verdict.outdate();
    if ($('drag').checked) this.rhythm.changed();
  }

  solve() {
    this.rhythm.settle();
    if (!this.settings.valid) return;
    const { model } = this;
    $('cancel').hidden = false;
    this.charts.clear();
    this.solver.solve({
      name: model.name.slice(0, 100),
      vertices: model.vertices,
      faces: model.triangles,
      creases: model.creases,
      constraints: model.constraints,
      targets: model.targetsOfVertices(this.regions.targets),
      ...this.settings.asked,
    });
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
    this.painter.measure(xyz, this.settings.supports);
    this.painter.paint();
    this.scene.moveTo(this.model.toScene(xyz));
  }

  /** Called by the solver in the end. */
  done(result, status) {
    if (!result) {
      this.failed(status.message ?? 'The solve ended without a result');
      return;
    }
    const first = this.result === null;
    this.result = result;
    const xyz = result.vertices.flat();
    this.painter.measure(xyz, this.settings.supports, result.curvature);
    this.painter.paint();
    this.scene.moveTo(this.model.toScene(xyz));
    this.mark(result.report.verdict?.places ?? []);
    if (first) this.scene.fit();
    this.verdict.show(result, this.model);
    const drawn = this.charts.end(result.history);
    this.rest({ downloads: true, course: drawn });
  }

  /** Called by the solver when there is no result. */
  failed(message) {
    this.verdict.fail(message, this.result !== null);
    this.rest({ downloads: false, course: false });
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

try {
  new Page();
} catch (error) {
  $('trouble').textContent = `The 3D view cannot start: ${error.message}. The page needs a browser with WebGL switched on.`;
  $('trouble').hidden = false;
}
