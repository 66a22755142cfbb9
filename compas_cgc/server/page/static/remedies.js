/** Remedies: changes of a design that the server proposes with its messages. */

import { heldIn, withChoice, withGoals, withHeld } from './design/edits.js';
import { requestOf } from './draw/plan.js';

const DIGITS = 3; // of changed numbers
const WISHES = { rise: { rise: null, found: false }, above: { above: null }, below: { below: null }, clearance: { boxes: [] }, 'edge in plan': { edge: false } };

/**
 * @typedef {object} Button
 * @property {string} text
 * @property {() => void | Promise<void>} act
 */

/**
 * Return the buttons of the proposed remedies that change the present design.
 * @param {import('./studio.js').Studio} studio
 * @param {import('./types.js').Remedy[]} [remedies]
 * @returns {Button[]}
 */
export function buttonsOf(studio, remedies = []) {
  if (studio.only) return [];
  return remedies.flatMap(({ text, change }) => {
    const act = actOf(studio, change);
    return act ? [{ text, act }] : [];
  });
}

/**
 * Return a row of buttons; all are disabled while one acts.
 * @param {Button[]} buttons
 * @returns {HTMLElement}
 */
export function rowOf(buttons) {
  const row = document.createElement('div');
  row.className = 'buttons remedies';
  const made = buttons.map(({ text, act }) => {
    const button = document.createElement('button');
    Object.assign(button, { type: 'button', className: 'small', textContent: text });
    button.addEventListener('click', async () => {
      for (const each of made) each.disabled = true;
      await act();
      for (const each of made) each.disabled = false;
    });
    return button;
  });
  row.append(...made);
  return row;
}

/** Return what applies a change, null if it does not apply to the present design. */
function actOf(studio, change) {
  const solve = (changed) => {
    studio.edit(changed);
    studio.solving.begin();
  };
  if (change.edge_length || change.edge_scale || change.creases) return meshing(studio, change);
  if (!studio.data) return null;
  return changed(studio.data, change) && (() => solve(changed(studio.data, change)));
}

/** Return what meshes the drawing with another edge length or further creases, null without a drawing. */
function meshing(studio, { edge_length: length, edge_scale: factor = 1, creases = [] }) {
  const { plan, name } = studio.history.now;
  if (!plan) return null;
  const edge = rounded(length ?? requestOf(plan, name || 'Roof').edge_length * factor);
  const lines = [...plan.lines, ...creases.map((points) => ({ points, closed: false, held: [] }))];
  return async () => {
    const { solving } = studio;
    studio.draw({ plan: { ...plan, edge, lines } });
    await studio.mesh();
    if (studio.history.now.stage === 'shape' && !solving.solver.busy) solving.begin();
  };
}

/**
 * Return a changed design, null if the change does not apply to it.
 * @param {import('./types.js').Data} data
 * @param {import('./types.js').Remedy['change']} change
 * @returns {?import('./types.js').Data}
 */
export function changed(data, { settings, method, supports, release, targets, scale, unknown, without, flip }) {
  if (settings) return { ...data, settings: { ...data.settings, ...settings } };
  if (method) return data.method === method ? null : { ...data, method, settings: {} };
  if (supports) return data.supports[supports]?.length && !isSame(heldIn(data), heldIn({ ...data, support_choice: supports })) ? withChoice(data, supports) : null;
  if (release) return release.every((vertex) => heldIn(data).includes(vertex)) ? withHeld(data, release, false) : null;
  if (flip) return { ...data, faces: data.faces.map((face) => face.toReversed()) };
  if (without) {
    const goals = data.goals.filter((/** @type {any} */ { kind }) => kind !== without);
    return { ...data, goals, wishes: { ...data.wishes, ...WISHES[without] } };
  }
  if (data.wishes?.found) return null; // K is unknown.
  if (unknown) return data.wishes?.rise != null ? withGoals(data, { found: true }) : null;
  if (targets !== undefined) return data.targets.length === 1 ? { ...data, targets: [targets] } : null;
  if (scale && data.targets.some((K) => K)) return { ...data, targets: data.targets.map((K) => (K ? rounded(K * scale) : K)) };
  return null;
}

function rounded(value) {
  return Number(value.toPrecision(DIGITS));
}

/** Check whether two lists hold the same vertices. */
function isSame(one, other) {
  const all = new Set(other);
  return one.length === other.length && one.every((vertex) => all.has(vertex));
}
