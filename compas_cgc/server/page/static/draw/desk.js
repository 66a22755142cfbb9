/** The panel beside the drawing board: name, unit, edge length, lines and columns. */

import { areaOf, boundsOf, rolesOf, segmentsOf, suggestedEdge } from './plan.js';
import { asNumberField, numberOf } from '../fields.js';
import { readable } from '../numbers.js';
import { capital } from '../words.js';

const WORDS = { outline: 'Outline', hole: 'Hole', fold: 'Crease' };

/** The panel. */
export class Desk {
  /**
   * @param {HTMLFormElement} panel
   * @param {import('./board.js').Board} board
   * @param {{change: (plan: import('./plan.js').Plan, key?: string) => void, name: (name: string) => void, mesh: () => void}} listener
   */
  constructor(panel, board, listener) {
    this.panel = panel;
    this.board = board;
    this.listener = listener;
    this.fields = panel.elements;
    document.querySelector('#draw-tools').addEventListener('change', ({ target }) => {
      board.choose(target.value);
      board.svg.focus({ preventScroll: true });
    });
    this.fields['plan-name'].addEventListener('change', ({ target }) => listener.name(target.value.trim()));
    this.fields['plan-unit'].addEventListener('change', ({ target }) => listener.change({ ...this.plan, unit: target.value }));
    this.fields['plan-edge'].addEventListener('change', ({ target }) => {
      listener.change({ ...this.plan, edge: numberOf(target) > 0 ? numberOf(target) : null });
    });
    panel.addEventListener('submit', (event) => {
      event.preventDefault();
      listener.mesh();
    });
  }

  /**
   * Show what is drawn.
   * @param {import('./plan.js').Plan} plan
   * @param {string} name
   */
  show(plan, name) {
    this.plan = plan;
    this.board.show(plan);
    const edge = suggestedEdge(plan);
    const outline = plan.lines[rolesOf(plan).indexOf('outline')];
    this.fields['plan-name'].value = name;
    this.fields['plan-unit'].value = plan.unit;
    this.fields['plan-edge'].value = plan.edge ?? '';
    this.fields['plan-edge'].placeholder = edge ?? '';
    this.fields.mesh.disabled = !outline;
    const used = plan.edge ?? edge;
    this.panel.querySelector('#plan-count').textContent = outline
      ? `About ${readable(Math.round(areaOf(outline.points) / (0.866 * used ** 2)), 2)} vertices. Shorter edges give a finer mesh and slower solves.`
      : 'Close a line to define the outline of the roof.';
    this.panel.querySelector('#plan-notes').textContent = (plan.notes ?? []).map(capital).join(' ');
    const rows = [...this.layers(plan), ...this.rows(plan)];
    const list = this.panel.querySelector('#plan-list');
    // Do not replace a field while the user types.
    if (list.contains(document.activeElement) && list.children.length === rows.length) return;
    list.replaceChildren(...rows);
    list.parentElement.hidden = !rows.length;
  }

  /** Rows for the layers of a drawing with several layers; each layer can be removed. */
  layers(plan) {
    const names = [...new Set(plan.lines.map(({ layer }) => layer).filter(Boolean))];
    if (names.length < 2) return [];
    return names.map((name) => {
      const count = plan.lines.filter(({ layer }) => layer === name).length;
      const words = `Layer ${name}, ${count} line${count > 1 ? 's' : ''}`;
      return row('layer', words, [], () => this.listener.change({ ...plan, lines: plan.lines.filter(({ layer }) => layer !== name) }));
    });
  }

  rows(plan) {
    const roles = rolesOf(plan);
    const unit = plan.unit ? ` ${plan.unit}` : '';
    const lines = plan.lines.map((line, number) => {
      const role = roles[number];
      const { x0, y0, x1, y1 } = boundsOf({ lines: [line], columns: [] });
      const length = segmentsOf(line).reduce((sum, [a, b]) => sum + Math.hypot(a[0] - b[0], a[1] - b[1]), 0);
      const size = role === 'fold' ? `${readable(length)}${unit}` : `${readable(x1 - x0)} × ${readable(y1 - y0)}${unit}`;
      const words = `${WORDS[role]} ${size}${line.held.length ? ', supported' : ''}`;
      return row(role, words, [], () => this.listener.change({ ...plan, lines: plan.lines.filter((_, k) => k !== number) }));
    });
    const columns = plan.columns.map((column, number) => {
      const field = document.createElement('input');
      asNumberField(field, { value: column.height || '', placeholder: '0', ariaLabel: `Height of column ${number + 1}` });
      field.addEventListener('change', () => {
        const height = numberOf(field) || 0;
        this.listener.change({ ...this.plan, columns: this.plan.columns.map((own, k) => (k === number ? { ...own, height } : own)) });
      });
      const label = document.createElement('label');
      label.append('height ', field);
      return row('column', `Column ${number + 1}`, [label], () =>
        this.listener.change({ ...this.plan, columns: this.plan.columns.filter((_, k) => k !== number) }),
      );
    });
    return [...lines, ...columns];
  }
}

function row(kind, words, more, remove) {
  const made = document.createElement('li');
  const [mark, text, button] = ['i', 'span', 'button'].map((tag) => document.createElement(tag));
  mark.className = kind;
  text.textContent = words;
  Object.assign(button, { type: 'button', className: 'small', textContent: '×', ariaLabel: `Remove ${words}`, title: 'Remove' });
  button.addEventListener('click', remove);
  made.append(mark, text, ...more, button);
  return made;
}
