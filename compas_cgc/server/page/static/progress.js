/** Progress of a solve. */

import { duration, readable } from './numbers.js';

/**
 * Show step, residual, energy and time.
 * @param {HTMLElement} room
 * @param {import('./types.js').Status} status of the job
 */
export function showProgress(room, status) {
  const parts = [status.state === 'queued' ? 'Waiting in the queue' : `Step ${status.iteration}`];
  if (status.error !== null) parts.push(`residual ${readable(status.error, 2)}`, `energy ${readable(status.energy, 4)}`);
  if (status.elapsed !== null) parts.push(duration(status.elapsed));
  const shown = parts.map((text, i) => {
    const part = document.createElement(i ? 'span' : 'strong');
    part.textContent = text;
    return part;
  });
  room.replaceChildren(...shown);
}
