/** Description, problems and notes of a model. */

import { rowOf } from './remedies.js';
import { capital } from './words.js';

/**
 * Show the name and size of a model.
 * @param {HTMLElement} room
 * @param {import('./model.js').Model} model
 */
export function showTitle(room, model) {
  const facts = [
    count(model.count, 'vertex', 'vertices'),
    count(model.triangles.length, 'face', 'faces'),
    ...(model.targets.length > 1 ? [`${model.targets.length} regions`] : []),
    ...(model.unit ? [`in ${model.unit}`] : []),
  ];
  const name = document.createElement('strong');
  name.textContent = model.name;
  const more = document.createElement('span');
  more.textContent = ` · ${facts.join(' · ')}`;
  room.replaceChildren(name, more);
  document.title = `${model.name} – compas_cgc`;
}

/**
 * Show the problems of a model, with their remedies, and its notes.
 * @param {HTMLElement} room
 * @param {import('./model.js').Model} model
 * @param {(remedies?: import('./types.js').Remedy[]) => import('./remedies.js').Button[]} buttons
 */
export function showNotes(room, { notes, problems }, buttons) {
  const said = problems.flatMap(({ text, fatal, remedies }) => {
    const made = buttons(remedies);
    return [lineOf(text, fatal ? 'fatal' : 'warning'), ...(made.length ? [rowOf(made)] : [])];
  });
  said.push(...notes.map((text) => lineOf(text, 'note')));
  room.replaceChildren(...said);
  room.parentElement.hidden = !said.length;
}

function lineOf(text, kind) {
  const line = document.createElement('p');
  line.className = kind;
  line.textContent = capital(text);
  return line;
}

function count(number, one, many) {
  return `${number.toLocaleString('en')} ${number === 1 ? one : many}`;
}
