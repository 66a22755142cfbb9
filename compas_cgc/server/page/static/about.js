/** Description, problems and notes of a model. */

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
 * Show the problems and notes of a model.
 * @param {HTMLElement} room
 * @param {import('./model.js').Model} model
 */
export function showNotes(room, { notes, problems }) {
  const lines = [...problems.map(({ text, fatal }) => [text, fatal ? 'fatal' : 'warning']), ...notes.map((text) => [text, 'note'])];
  const said = lines.map(([text, kind]) => {
    const line = document.createElement('p');
    line.className = kind;
    line.textContent = capital(text);
    return line;
  });
  room.replaceChildren(...said);
  room.parentElement.hidden = !lines.length;
}

function count(number, one, many) {
  return `${number.toLocaleString('en')} ${number === 1 ? one : many}`;
}
