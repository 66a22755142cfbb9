/** Description of a result. */

import { duration, largest, readable } from './numbers.js';
import { rowOf } from './remedies.js';
import { capital } from './words.js';

const HEADS = {
  converged: ['good', 'Target reached'],
  step_limit: ['warn', 'Step limit reached'],
  stalled: ['warn', 'Stalled'],
  diverged: ['bad', 'Diverged'],
  infeasible: ['bad', 'No surface exists'],
  cancelled: ['warn', 'Stopped'],
};
const ROUGH = 'K equals its target at every vertex, but the surface is too rough to build.';
const QUADRICS =
  'Second measure: median K of quadrics fitted to the mesh, in the region with the largest deviation from its target';

/** The words on a result. */
export class Verdict {
  /** @param {HTMLElement} room */
  constructor(room) {
    this.room = room;
  }

  /**
   * Show a result.
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
   * Show the verdict of a surface before it is measured; the figures of the previous surface remain until then.
   * @param {import('./types.js').Judged} said
   */
  judge({ fair, reasons, ...said }) {
    const result = { ...said, report: { verdict: { fair, reasons } } };
    this.fill(head(result).mood, [...first(result), ...this.room.querySelectorAll(':scope > dl, :scope > details')]);
  }

  /**
   * Show an error.
   * @param {string} message
   * @param {boolean} [shown] whether the previous surface is still displayed
   * @param {boolean} [stopped] whether the user stopped the solve
   */
  fail(message, shown = false, stopped = false) {
    const parts = [element('h2', stopped ? 'Stopped' : 'Not solved'), element('p', capital(message))];
    if (shown) parts.push(aside('The previous surface is shown.', 'old'));
    this.fill(stopped ? 'warn' : 'bad', parts);
  }

  /** Clear the verdict. */
  clear() {
    this.room.className = 'verdict';
    this.room.hidden = true;
  }

  /** Mark the result as out of date. */
  outdate() {
    if (this.room.classList.contains('good') && !this.room.querySelector('.old')) {
      this.room.querySelector('h2').after(aside('Settings have changed since. Solve again to see what they give.', 'old'));
    }
  }

  /**
   * Offer remedies.
   * @param {import('./remedies.js').Button[]} remedies
   */
  offer(remedies) {
    const row = rowOf(remedies);
    const figures = this.room.querySelector(':scope > dl');
    if (figures) figures.before(row);
    else this.room.append(row);
  }

  /**
   * Add a note below the heading.
   * @param {string} text
   */
  add(text) {
    this.room.querySelector('h2').after(aside(text, 'note'));
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

/** Return the first sentences: the outcome and, for a rough surface, the remedy and the reasons. */
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

/** Split the ending into the remedy and the outcome of the steps. */
function parted(ending) {
  const at = ending.search(/\bconverged in\b/);
  return at > 0 ? { mend: ending.slice(0, at).replace(/; $/, ''), end: ending.slice(at) } : { mend: '', end: ending };
}

function figures(result, model) {
  const size = largest(result.targets);
  const unit = model.unit ? ` ${model.unit}` : '';
  const { regions, moved_max: moved } = result.report;
  const error = largest(result.curvature.map((K, vertex) => K - result.targets[vertex]));
  const most = `${readable(error, 2)} ${model.curvatureUnit.slice(1)}`;
  const rows = [['Largest error', most, 'Largest |K − target|, with K as it is measured for the colours; mid-edge normals do not read it within two edges of supports']];
  if (size > 0) rows.push(['Relative to the target', part(error / size)]);
  const fits = (regions ?? []).filter((region) => region.target && region.quadric_median !== null);
  if (fits.length) {
    const off = fits.map((region) => region.quadric_median / region.target - 1).reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a));
    const sign = off < 0 ? '−' : '+';
    rows.push(['By fitted quadrics', `${sign}${readable(100 * Math.abs(off), 2)} %`, QUADRICS]);
  }
  if (moved !== null && moved !== undefined) rows.push(['Largest displacement', `${readable(moved)}${unit}`]);
  if (result.turned) rows.push(['Faces changed', String(result.turned), 'Edges of overstretched triangles were flipped for K < 0; the vertices are those of the drawing.']);
  rows.push(['Time', duration(result.seconds)]);
  return rows;
}

function details(result) {
  const box = document.createElement('details');
  const how = `Method ${result.method}, in ${result.iterations === 1 ? 'one step' : `${result.iterations} steps`}.`;
  box.append(element('summary', 'Solver details'));
  // If the method was chosen automatically, the ending already names it.
  if (!result.ending.includes('by the method')) box.append(element('p', how));
  box.append(element('p', capital(isRough(result) ? parted(result.ending).end : result.ending)));
  for (const note of result.report.notes ?? []) box.append(element('p', capital(note)));
  return box;
}

function part(share) {
  return share >= 1e-4 ? `${readable(100 * share, 2)} %` : readable(share, 2);
}

function aside(text, kind) {
  const note = element('p', text);
  note.className = `aside ${kind}`;
  return note;
}

function element(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}
