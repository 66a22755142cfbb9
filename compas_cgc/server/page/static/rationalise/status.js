/** What the dialog says while it works. */

import { duration } from '../numbers.js';
import { capital } from '../words.js';

/** The line with the progress bar, errors, and notes. */
export class Status {
  /** @param {(name: string) => any} $ */
  constructor($) {
    this.$ = $;
    this.running = false;
  }

  /**
   * Say what is going on.
   * @param {string} text nothing is shown if it is empty
   * @param {?number} [part] that is done
   */
  say(text, part = null) {
    this.$('trouble').hidden = true;
    this.$('said').textContent = text;
    this.$('doing').hidden = !text;
    const bar = this.$('bar');
    bar.hidden = !this.running;
    if (part) bar.value = part;
    else bar.removeAttribute('value');
  }

  /** @param {boolean} running whether a job is running */
  run(running) {
    this.running = running;
    this.$('stop').hidden = !running;
    this.$('results').ariaBusy = String(running);
    this.say('');
  }

  progress(status) {
    const { text, part } = stageOf(status);
    this.say([text, ...(status.elapsed === null ? [] : [duration(status.elapsed)])].join(' · '), part);
  }

  /** @param {string} text of an error */
  fail(text) {
    this.say('');
    this.$('trouble').textContent = capital(text);
    this.$('trouble').hidden = false;
    this.$('trouble').scrollIntoView({ block: 'nearest' });
  }
}

/** Return what a job does, and the part of the assignment that is done. */
function stageOf({ state, stage, iteration, iterations }) {
  if (state === 'queued') return { text: 'Waiting in the queue', part: null };
  if (stage !== 'assign') return { text: 'Dividing the design into panels', part: null };
  if (iteration >= iterations) return { text: 'Solving the surface', part: null };
  return { text: `Assigning panels, round ${iteration} of at most ${iterations}`, part: iteration / iterations };
}
