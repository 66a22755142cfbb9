/** Figures of a rationalised design in words. */

import { REGIONS, parse } from '../colours.js';
import { largest, power, readable, roundAbove } from '../numbers.js';
import { capital, counted } from '../words.js';

const SMALL = 0.5; // length below which metres are given in millimetres [m]
const DARKER = 0.72; // of the channels of the colours that are used again
const SURFACE = ['vertices', 'faces', 'panel_of_face', 'distances', 'seams', 'supports', 'notes', 'formats', 'task', 'text', 'id'];

/**
 * Return the colour of a mould, as in the .3dm file; after nine moulds the colours are darker.
 * @param {number} mould from 0
 * @returns {string}
 */
export function mouldColour(mould) {
  const colour = REGIONS[mould % REGIONS.length];
  if (mould < REGIONS.length) return colour;
  return `#${parse(colour)
    .map((channel) => Math.round(255 * DARKER * channel).toString(16).padStart(2, '0'))
    .join('')}`;
}

/**
 * Return shape, radius and K of moulds in words, with a common power of ten for K.
 * @param {number[]} curvatures
 * @param {string} unit
 * @returns {{unit: string, rows: {shape: string, radius: string, curvature: string}[]}}
 */
export function mouldsOf(curvatures, unit) {
  const exponent = Math.floor(Math.log10(largest(curvatures) || 1));
  const scale = exponent < -1 ? exponent : 0;
  const rows = curvatures.map((K) => ({
    shape: K === 0 ? 'Flat' : K > 0 ? 'Sphere' : 'Saddle',
    radius: K === 0 ? '–' : readable(Math.abs(K) ** -0.5),
    curvature: readable(K / 10 ** scale),
  }));
  const per = unit ? `/${unit}²` : '';
  return { unit: scale ? `in ${power(scale)}${per}` : per && `in 1${per}`, rows };
}

/**
 * Return how lengths are given: in the unit of the design, or in millimetres if they are small and it is the metre.
 * @param {string} unit
 * @param {number} size the largest of them
 * @returns {{factor: number, unit: string, text: (length: number) => string}}
 */
export function lengthScale(unit, size) {
  const small = unit === 'm' && size < SMALL;
  const [factor, own] = small ? [1000, 'mm'] : [1, unit];
  return { factor, unit: own, text: (length) => `${readable(factor * length)}${own ? ` ${own}` : ''}` };
}

/**
 * Return the end of the colours of the distances.
 * @param {import('./jobs.js').Told} told
 * @returns {number}
 */
export function limitOf(told) {
  return roundAbove(largest(told.distances));
}

/**
 * Return heading, kind and figures of a result.
 * @param {import('./jobs.js').Told} told
 * @param {string} unit
 * @returns {{kind: string, head: string, text: string, rows: string[][]}}
 */
export function figuresOf(told, unit) {
  const { costs, distance, kinks, status, verdict, within } = told;
  const length = lengthScale(unit, distance.max);
  const angle = (value) => `${readable(Math.max(0, value), 2)}°`;
  const head = `${counted(told.panels, 'panel')} on ${counted(told.moulds, 'mould')}`;
  const fair = verdict === 'fair';
  const kind = status === 'kept' && fair ? 'good' : ['kept', 'exceeded', 'cancelled'].includes(status) ? 'warn' : 'bad';
  const said = {
    cancelled: 'Stopped before the end: the best surface so far.',
    exceeded: told.suggestion,
    kept: fair ? '' : `The surface is ${verdict}`,
  };
  const rows = [
    ['Largest distance', length.text(distance.max)],
    ['Distance, rms', length.text(distance.rms)],
    ...(told.weighted_distance ? [['Weighted distance', length.text(told.weighted_distance)]] : []),
    ...(within ? [['Allowed distance', length.text(within)]] : []),
    ...(told.fit_deviation ? [['Mesh to its smooth surface', length.text(told.fit_deviation)]] : []),
    ...(told.facet_deviation ? [['Mesh edges to its smooth surface', length.text(told.facet_deviation)]] : []),
    ...(costs ? [['Costs', (costs.moulds + costs.panels).toLocaleString('en')]] : []),
    ['Largest added kink', angle(kinks.beyond.largest)],
  ];
  const text = said[status] ?? `The surface did not converge (${status.replaceAll('_', ' ')}). Try another width of panels.`;
  return { kind, head, text: text && capital(text), rows };
}

/**
 * Return the report as JSON, as `compas-cgc rationalise --report` writes it.
 * @param {import('./jobs.js').Told} told
 * @returns {string}
 */
export function reportOf(told) {
  const figures = Object.entries(told).filter(([name]) => !SURFACE.includes(name));
  return `${JSON.stringify(Object.fromEntries(figures), null, 1)}\n`;
}
