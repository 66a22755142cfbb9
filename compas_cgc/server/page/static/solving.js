/** A solve: its request, progress and displayed surface. */

import { LOST } from './api.js';
import { Charts } from './charts.js';
import { asked } from './design/goals.js';
import { download } from './download.js';
import { pack } from './packed.js';
import { showProgress } from './progress.js';
import { buttonsOf } from './remedies.js';
import { Rhythm } from './rhythm.js';
import { Solver } from './solver.js';
import { Verdict } from './verdict.js';

const PROGRESS_DELAY = 200; // duration of a solve above which progress is shown [ms]
const COARSE = 1e-5; // tolerance while a slider moves; the remaining error is invisible
const QUICK = 0.3; // duration of a solve below which the motion of the surface is not animated [s]

/** @type {(id: string) => any} the elements are those of index.html */
const $ = (id) => document.getElementById(id);

/** Requests surfaces and shows them in the views. */
export class Solving {
  /** @param {import('./studio.js').Studio} studio whose design is solved */
  constructor(studio) {
    this.studio = studio;
    /** @type {?import('./types.js').Result} */
    this.result = null;
    /** @type {any} the running request */
    this.asking = null;
    /** @type {any} the request of the result */
    this.solved = null;
    /** @type {?import('./types.js').Data} the design that the result belongs to */
    this.of = null;
    /** @type {?import('./types.js').Data} the design of the running solve */
    this.begun = null;
    /** @type {?Float64Array} */
    this.drawn = null;
    this.patience = 0;
    this.stale = false;
    this.held = false; // whether a slider is held
    this.coarse = false; // whether the last solve used the coarse tolerance
    this.charts = new Charts($('chart-error'), $('chart-energy'));
    this.verdict = new Verdict($('verdict'));
    this.solver = new Solver(studio.api, this);
    this.rhythm = new Rhythm(this.solver, () => this.begin());
  }

  /** Reset everything for another mesh. */
  clear() {
    this.solver.reset();
    this.rhythm.settle();
    this.settle();
    this.held = this.coarse = false;
    this.result = this.studio.painter.before = this.of = null;
    this.studio.crown.on = false;
    this.charts.clear();
    this.verdict.clear();
    for (const id of ['downloads', 'making', 'course', 'cancel', 'progress']) $(id).hidden = true;
    this.studio.maker.clear();
  }

  /**
   * The request has changed.
   * @param {boolean} held whether a slider is being moved
   */
  changed(held = false) {
    const { painter, regions } = this.studio;
    this.held = held;
    painter.want(regions.targets);
    // Other colours do not depend on targets, and drawing would delay the solve.
    if (painter.by === 'error') painter.paint();
    this.stale = true;
    this.of = null;
    if ($('drag').checked) {
      this.wait();
      this.rhythm.changed();
    } else this.verdict.outdate();
  }

  /** The slider was released: solve again with the full tolerance. */
  release() {
    this.held = false;
    if (this.coarse) this.rhythm.changed();
  }

  /** A solve has started: show progress after a delay, to avoid flicker while a slider moves. */
  wait() {
    $('outcome').ariaBusy = 'true';
    this.patience ||= setTimeout(() => {
      if (this.stale) this.verdict.outdate();
      $('cancel').hidden = !this.solver.busy;
    }, PROGRESS_DELAY);
  }

  /** Hide the progress. */
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
      ...(Object.keys(model.laws).length ? { laws: model.laws } : {}),
      ...asked(model.goals, data.wishes),
      ...settings.asked,
    };
  }

  /** Return the last surface as an initial guess, if the request differs only by its targets. */
  last(request) {
    const { result, solved } = this;
    const leads = result?.report.verdict?.fair && !result.faces && !result.evenness && !solved.unknown;
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
    this.begun = this.studio.data;
    this.coarse = this.held;
    const { settings } = this.asking;
    this.solver.solve({ ...this.asking, ...this.last(this.asking), settings: this.coarse ? { tolerance: COARSE, ...settings } : settings });
    this.studio.scene.expect();
  }

  /** Called by the solver while it runs. */
  progress(status) {
    showProgress($('progress'), status);
    $('progress').hidden = this.solver.age < PROGRESS_DELAY;
    if (this.charts.add(status)) $('course').hidden = false;
  }

  /** Called by the solver while the server does not respond. */
  lost() {
    $('progress').textContent = LOST;
    $('progress').hidden = $('cancel').hidden = false;
  }

  /** Called by the solver with the surface of a step. */
  surface(xyz) {
    const { studio } = this;
    studio.mark([]);
    studio.place(xyz);
    studio.painter.measure(xyz, studio.settings.supports);
    studio.painter.paint();
  }

  /** Called by the solver with the solved surface, which is drawn before its verdict. */
  arrived(xyz) {
    const { studio } = this;
    studio.mark([]);
    studio.place(xyz, null, this.result !== null && this.solver.age < PROGRESS_DELAY);
    studio.scene.flush();
    this.drawn = xyz;
  }

  /** Called by the solver with the verdict, so that the text is updated before the surface is measured. */
  judged(said) {
    if (this.drawn && this.coarse) this.verdict.judge(said);
  }

  /** Called by the solver at the end. */
  done(result, status) {
    if (!result) {
      this.failed(status.message ?? 'The solve ended without a result', status.remedies, status.state === 'cancelled');
      return;
    }
    const { data } = this.studio;
    const known = this.begun === data;
    this.shows(result, data);
    // K found for a rise is part of the design.
    if (known) this.of = this.studio.data;
    if (result.status !== 'converged') this.heard();
    this.studio.stepped();
  }

  /**
   * Show a stored surface, as after its solve.
   * @param {import('./types.js').Result} result
   * @param {?number[]} view
   */
  restore(result, view) {
    const { data, scene } = this.studio;
    this.asking = this.request();
    this.shows(result, data);
    this.of = this.studio.data;
    if (view) scene.view = view;
    // The server has no job of it.
    this.rest({ downloads: false, making: false, course: !$('course').hidden });
    this.verdict.add('Shown as stored. Solve again to download or build.');
  }

  /** Show a result in all views. */
  shows(result, data) {
    const { crown, model, painter, scene, settings } = this.studio;
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
    if (!before && !scene.chosen && !scene.whole) scene.fit();
    scene.flush();
    this.verdict.show(result, model);
    this.remedy(result.report.remedies);
    const drawn = this.charts.end(result.history);
    this.rest({ downloads: true, making: result.status !== 'cancelled', course: drawn });
  }

  /** Called by the solver when there is no result. */
  failed(message, remedies = [], stopped = false) {
    this.verdict.fail(message, this.result !== null, stopped);
    this.remedy(remedies);
    this.rest({ downloads: false, making: false, course: false });
    this.heard();
  }

  /** Offer remedies beside the verdict. */
  remedy(remedies) {
    const buttons = buttonsOf(this.studio, remedies);
    if (buttons.length) this.verdict.offer(buttons);
  }

  /** Scroll to an error, which can be far from the pressed button on a narrow screen. */
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

/** Check whether two requests differ only by their targets. A mesh is packed once, so equal meshes are the same object. */
function isSameBut({ vertices, faces, targets, ...one }, { vertices: places, faces: corners, targets: before, ...other }) {
  return vertices === places && faces === corners && JSON.stringify(one) === JSON.stringify(other);
}

/** Return targets with the K solved for the goals. */
function found(targets, result) {
  return targets.map((own, region) => {
    const K = result.report.regions?.find((each) => each.region === region)?.target ?? own;
    return K === null ? null : Number(K.toPrecision(6));
  });
}
