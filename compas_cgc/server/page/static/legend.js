/** Legend of the colours. */

import { SIGNED } from './colours.js';
import { readable } from './numbers.js';

/** The bar of signed values, with numbers at its ends. */
export class Legend {
  /** @param {HTMLElement} room */
  constructor(room) {
    this.room = room;
    room.querySelector('.bar').style.background = `linear-gradient(90deg, ${SIGNED.join(', ')})`;
  }

  /**
   * Show the bar.
   * @param {string} what
   * @param {number} limit value of the darkest colours
   * @param {boolean} gaps whether the value is undefined at some vertices
   * @param {number} [middle] value of white
   */
  show(what, limit, gaps, middle = 0) {
    const ends = this.room.querySelectorAll('.ends span');
    this.room.querySelector('.what').textContent = what;
    for (const each of this.room.querySelectorAll('.bar, .ends')) each.hidden = false;
    ends[0].textContent = readable(middle - limit);
    ends[1].textContent = readable(middle);
    ends[2].textContent = readable(middle + limit);
    this.room.querySelector('.none').hidden = !gaps;
    this.room.hidden = false;
  }

  /**
   * Show a sentence instead of the bar.
   * @param {string} text nothing is shown if it is empty
   */
  say(text) {
    this.room.querySelector('.what').textContent = text;
    for (const each of this.room.querySelectorAll('.bar, .ends, .none')) each.hidden = true;
    this.room.hidden = !text;
  }
}
