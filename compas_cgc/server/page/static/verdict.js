/** What came out, in words. */

import { duration, readable } from './numbers.js';
import { capital } from './words.js';

const HEADS = {
  converged: ['good', 'As asked'],
  step_limit: ['warn', 'Not there yet'],
  stalled: ['warn', 'Not reached'],
  diverged: ['bad', 'It ran away'],
  infeasible: ['bad', 'No such surface'],
  cancelled: ['warn', 'Stopped'],
};
const ROUGH = 'K is met at every vertex, but the surface is not one to build.';
const QUADRICS =
  'A second measure: the median K of quadrics fitted to the mesh, in the region where it differs most from its target';

/** The words on a result. */
export class Verdict {
  /** @param {HTMLElement} room */
  constructor(room) {
    this.room = room;
  }

  /**
   * Tell of a result.
   * @param {import('./types.js').Result} result
   * @param {import('./model.js').Model} model
   */
  show(result, model) {
    const list = document.createElement('dl');
    for (const [name, value, why] of figures(result, model)) {
      const [term, detail] = [element('dt', name), element('dd', value)];
      if (why) term.title = why;
      list.append(term, detail);
    }
    this.fill(head(result).mood, [...first(result), list, details(result)]);
  }

  /**
   * Tell of a surface whose figures are not known yet; those of the one before stay until they are.
   * @param {import('./types.js').Judged} said
   */
  judge({ fair, reasons, ...said }) {
    const result = { ...said, report: { verdict: { fair, reasons } } };
    this.fill(head(result).mood, [...first(result), ...this.room.querySelectorAll(':scope > dl, :scope > details')]);
  }

  /**
   * Tell that there is no result.
   * @param {string} message
   * @param {boolean} [shown] whether the one before is still to be seen
   * @param {boolean} [stopped] whether that was wanted
   */
  fail(message, shown = false, stopped = false) {
    const parts = [element('h2', stopped ? 'Stopped' : 'Not solved'), element('p', capital(message))];
    if (shown) parts.push(old('The surface shown is the one before.'));
    this.fill(stopped ? 'warn' : 'bad', parts);
  }

  /** Say nothing. */
  clear() {
    this.room.className = 'verdict';
    this.room.hidden = true;
  }

  /** Say that the result belongs to other settings than those that are shown. */
  outdate() {
    if (this.room.classList.contains('good') && !this.room.querySelector('.old')) {
      this.room.querySelector('h2').after(old('Settings have changed since. Solve again to see what they give.'));
    }
  }

  fill(mood, parts) {
    this.room.hidden = false;
    this.room.className = `verdict ${mood}`;
    this.room.replaceChildren(...parts);
  }
}

function isRough(result) {
  return result.status === 'converged' && result.report.verdict?.fair === false;
}

function head(result) {
  const [mood, text] = isRough(result) ? ['warn', 'Rough'] : (HEADS[result.status] ?? ['warn', result.status]);
  return { mood, text };
}

function first(result) {
  return [element('h2', head(result).text), ...lead(result)];
}

/** Return what is said first: what came out, and of a rough surface what would mend it and why it is not one to build. */
function lead(result) {
  if (result.status !== 'converged') return [element('p', capital(result.message))];
  const { verdict } = result.report;
  const text = result.message.slice(0, -result.ending.length).replace(/; $/, '');
  if (!isRough(result)) return [element('p', capital(text.replace(/^fair: /, '')))];
  const { mend } = parted(result.ending);
  const why = document.createElement('ul');
  why.className = 'reasons';
  why.append(...verdict.reasons.map((reason) => element('li', capital(reason))));
  const heights = text.replace(`rough: ${verdict.reasons.join('; ')}; `, '');
  return [element('p', ROUGH), ...(mend ? [element('p', capital(mend))] : []), why, element('p', capital(heights))];
}

/** Return what the ending says would mend a surface, and how the steps ended. */
function parted(ending) {
  const at = ending.search(/\bconverged in\b/);
  return at > 0 ? { mend: ending.slice(0, at).replace(/; $/, ''), end: ending.slice(at) } : { mend: '', end: ending };
}

function figures(result, model) {
  const size = largestTarget(result);
  const unit = model.unit ? ` ${model.unit}` : '';
  const { regions, moved_max: moved } = result.report;
  const most = `${readable(result.max_error, 2)} ${model.curvatureUnit.slice(1)}`;
  const rows = [['Largest error', most, 'Largest |K − target| of all vertices, by angle defects']];
  if (size > 0) rows.push(['Relative to the target', part(result.max_error / size)]);
  const fits = (regions ?? []).filter((region) => region.target && region.quadric_median !== null);
  if (fits.length) {
    const off = fits.map((region) => region.quadric_median / region.target - 1).reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a));
    const sign = off < 0 ? '−' : '+';
    rows.push(['By fitted quadrics', `${sign}${readable(100 * Math.abs(off), 2)} %`, QUADRICS]);
  }
  if (moved !== null && moved !== undefined) rows.push(['Moved by at most', `${readable(moved)}${unit}`]);
  if (result.turned) rows.push(['Faces turned', String(result.turned), 'Edges of triangles too stretched for K < 0; the vertices are those of the drawing.']);
  rows.push(['Time', duration(result.seconds)]);
  return rows;
}

function details(result) {
  const box = document.createElement('details');
  const how = `By the method ${result.method}, in ${result.iterations === 1 ? 'one step' : `${result.iterations} steps`}.`;
  box.append(element('summary', 'What the solver says'));
  // Where the solve has chosen it, the sentence itself ends with the method.
  if (!result.ending.includes('by the method')) box.append(element('p', how));
  box.append(element('p', capital(isRough(result) ? parted(result.ending).end : result.ending)));
  for (const note of result.report.notes ?? []) box.append(element('p', capital(note)));
  return box;
}

function largestTarget(result) {
  return result.targets.reduce((most, K) => (Number.isFinite(K) ? Math.max(most, Math.abs(K)) : most), 0);
}

function part(share) {
  return share >= 1e-4 ? `${readable(100 * share, 2)} %` : readable(share, 2);
}

function old(text) {
  const note = element('p', text);
  note.className = 'old';
  return note;
}

function element(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}
