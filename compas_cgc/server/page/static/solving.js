/** A solve: what is asked for, how far it is, and what is shown of its surface. */

import { Charts } from './charts.js';
import { asked } from './design/goals.js';
import { download } from './download.js';
import { pack } from './packed.js';
import { showProgress } from './progress.js';
import { Rhythm } from './rhythm.js';
import { Solver } from './solver.js';
import { Verdict } from './verdict.js';

const WORTH = 200; // milliseconds; what is over sooner needs no word
const COARSE = 1e-5; // tolerance while a slider is held: no eye sees what is left
const QUICK = 0.3; // seconds; a surface that follows a slider so soon is near the one before, and need not glide there

/** @type {(id: string) => any} the elements are those of index.html */
const $ = (id) => document.getElementById(id);

/** Asks for surfaces, and puts them into the views. */
export class Solving {
  /** @param {import('./studio.js').Studio} studio whose design is solved */
  constructor(studio) {
    this.studio = studio;
    /** @type {?import('./types.js').Result} */
    this.result = null;
    /** @type {any} the request that is being solved */
    this.asking = null;
    /** @type {any} the request of the result */
    this.solved = null;
    /** @type {?Float64Array} */
    this.drawn = null;
    this.patience = 0;
    this.stale = false;
    this.held = false; // a slider is
    this.coarse = false; // the last solve was for one
    this.charts = new Charts($('chart-error'), $('chart-energy'));
    this.verdict = new Verdict($('verdict'));
    this.solver = new Solver(studio.api, this);
    this.rhythm = new Rhythm(this.solver, () => this.begin());
  }

  /** Forget all, as the mesh is another. */
  clear() {
    this.solver.reset();
    this.rhythm.settle();
    this.settle();
    this.held = this.coarse = false;
    this.result = this.studio.painter.before = null;
    this.studio.crown.on = false;
    this.charts.clear();
    this.verdict.clear();
    for (const id of ['downloads', 'making', 'course', 'cancel', 'progress']) $(id).hidden = true;
    this.studio.maker.clear();
  }

  /**
   * Something else is asked for.
   * @param {boolean} held by a slider that will be let go
   */
  changed(held = false) {
    const { painter, regions } = this.studio;
    this.held = held;
    painter.want(regions.targets);
    // The other colours do not know of targets, and to draw takes time that the solve waits for.
    if (painter.by === 'error') painter.paint();
    this.stale = true;
    if ($('drag').checked) {
      this.wait();
      this.rhythm.changed();
    } else this.verdict.outdate();
  }

  /** The slider is let go: what has followed it is found to the last digit. */
  release() {
    this.held = false;
    if (this.coarse) this.rhythm.changed();
  }

  /** Somebody waits for a surface: tell so where it takes a while, as words that come and go with every move of a slider are not read. */
  wait() {
    $('outcome').ariaBusy = 'true';
    this.patience ||= setTimeout(() => {
      if (this.stale) this.verdict.outdate();
      $('cancel').hidden = !this.solver.busy;
    }, WORTH);
  }

  /** Nobody waits any more. */
  settle() {
    clearTimeout(this.patience);
    this.patience = 0;
    this.stale = false;
    $('outcome').ariaBusy = 'false';
  }

  request() {
    const { model, regions, data, settings } = this.studio;
    return {
      name: model.name.slice(0, 100),
      unit: model.unit,
      ...model.mesh,
      creases: model.creases,
      targets: model.targetsOfVertices(regions.targets),
      ...asked(model.goals, data.wishes),
      ...settings.asked,
    };
  }

  /** Return the last surface as a field of a request where targets alone are others: the solve goes on from it. */
  last(request) {
    const { result, solved } = this;
    const leads = result?.method === 'projection' && result.report.verdict?.fair && !result.faces && !solved.unknown;
    if (!leads || !isSameBut(request, solved)) return {};
    return { last: { vertices: pack(result.xyz, 'f8', [result.xyz.length / 3, 3]), targets: solved.targets } };
  }

  begin() {
    this.studio.maker.clear();
    this.rhythm.settle();
    if (!this.studio.settings.valid) {
      this.settle();
      return;
    }
    this.wait();
    this.charts.clear();
    this.drawn = null;
    this.asking = this.request();
    this.coarse = this.held;
    const { settings } = this.asking;
    this.solver.solve({ ...this.asking, ...this.last(this.asking), settings: this.coarse ? { tolerance: COARSE, ...settings } : settings });
    this.studio.scene.expect();
  }

  /** Called by the solver while it runs. */
  progress(status) {
    showProgress($('progress'), status);
    $('progress').hidden = this.solver.age < WORTH;
    if (this.charts.add(status)) $('course').hidden = false;
  }

  /** Called by the solver with a surface on its way. */
  surface(xyz) {
    const { studio } = this;
    studio.mark([]);
    studio.place(xyz);
    studio.painter.measure(xyz, studio.settings.supports);
    studio.painter.paint();
  }

  /** Called by the solver with what will be the result, unless it is found wanting: it is drawn while it is judged. */
  arrived(xyz) {
    const { studio } = this;
    studio.mark([]);
    studio.place(xyz, null, this.result !== null && this.solver.age < WORTH);
    studio.scene.flush();
    this.drawn = xyz;
  }

  /** Called by the solver with what is said of the surface that is drawn: while a slider is held, the words need not wait for the figures. */
  judged(said) {
    if (this.drawn && this.coarse) this.verdict.judge(said);
  }

  /** Called by the solver in the end. */
  done(result, status) {
    if (!result) {
      this.failed(status.message ?? 'The solve ended without a result', status.state === 'cancelled');
      return;
    }
    const { crown, data, model, painter, scene, settings } = this.studio;
    const before = this.result;
    if (before) painter.before = before.xyz;
    this.result = result;
    this.solved = this.asking;
    this.studio.turn(result.faces ?? null);
    if (data.wishes?.found && data.wishes.rise != null) this.studio.takeTargets(found(data.targets, result));
    if (this.drawn && isSame(this.drawn, result.xyz)) this.studio.know(result.xyz, result.curvature);
    else this.studio.place(result.xyz, result.curvature, before !== null && result.seconds < QUICK);
    painter.measure(result.xyz, settings.supports, result.curvature);
    if (painter.by !== 'regions' || !before) painter.paint();
    crown.show(model, result.xyz, settings.supports);
    crown.on = true;
    this.studio.mark(result.report.verdict?.places ?? []);
    if (!before) scene.fit();
    scene.flush();
    this.verdict.show(result, model);
    const drawn = this.charts.end(result.history);
    this.rest({ downloads: true, making: result.status !== 'cancelled', course: drawn });
    if (result.status !== 'converged') this.heard();
    this.studio.stepped();
  }

  /** Called by the solver when there is no result. */
  failed(message, stopped = false) {
    this.verdict.fail(message, this.result !== null, stopped);
    this.rest({ downloads: false, making: false, course: false });
    this.heard();
  }

  /** Bring bad news into sight: on a narrow screen they may be far from the button that was pressed. */
  heard() {
    $('verdict').scrollIntoView({ block: 'nearest' });
  }

  rest(shown) {
    for (const [id, on] of Object.entries({ ...shown, cancel: false, progress: false })) $(id).hidden = !on;
    this.settle();
    this.rhythm.over();
  }

  async download(format) {
    if (!format) return;
    try {
      await download(this.studio.api, this.solver.finished, format, this.studio.model);
    } catch (error) {
      this.verdict.fail(error.message, true);
    }
  }
}

function isSame(one, other) {
  return one.length === other.length && one.every((value, k) => value === other[k]);
}

/** Return whether two requests differ by their targets at most; a mesh is packed once, so another is another object. */
function isSameBut({ vertices, faces, targets, ...one }, { vertices: places, faces: corners, targets: before, ...other }) {
  return vertices === places && faces === corners && JSON.stringify(one) === JSON.stringify(other);
}

/** Return targets with the K that was found for the goals. */
function found(targets, result) {
  return targets.map((own, region) => {
    const K = result.report.regions?.find((each) => each.region === region)?.target ?? own;
    return K === null ? null : Number(K.toPrecision(6));
  });
}
