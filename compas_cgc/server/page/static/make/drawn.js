/** Conversion of builds to objects drawn on the surface. */

import { REGIONS } from '../colours.js';

const TENSION = '#c8372d';
const COMPRESSION = '#2b6fb0';
const CONTOUR = '#a06e3c';
const SECTION = '#14828c';
const FAMILIES = ['#1f5d66', '#b4532a', '#6b5aa0'];
const LABELS = 160; // largest number of legible labels

/**
 * @typedef {object} Drawn
 * @property {{colour: string, ends: number[][]}[]} lines pairs of points
 * @property {{colour: string, vertices: number[][], triangles: number[][]}[]} faces
 * @property {{text: string, at: number[]}[]} labels
 * @property {{colour: string, text: string}[]} key
 */

/**
 * Return the objects of a task, in their final position.
 * @param {string} task
 * @param {any} told result of the job
 * @returns {Drawn}
 */
export function drawnOf(task, told) {
  return DRAW[task](told);
}

const DRAW = {
  mould({ panels, moulds }) {
    const colour = (number) => REGIONS[(number - 1) % REGIONS.length];
    return {
      faces: panels.map((own) => ({ colour: colour(own.mould), vertices: own.vertices, triangles: own.triangles })),
      lines: [{ colour: '#26221d', ends: panels.flatMap((own) => own.outlines.flatMap((loop) => sides(loop, true))) }],
      labels: panels.slice(0, LABELS).map((own) => ({ text: own.panel, at: own.label_at })),
      key: moulds.map((own) => ({ colour: colour(own.mould), text: `Mould ${own.mould}: ${own.kind}, ${own.panels} panel${own.panels === 1 ? '' : 's'}` })),
    };
  },
  unroll({ in_place: place, pieces }) {
    const labels = pieces.slice(0, LABELS).map(({ label }, piece) => {
      const own = place.triangles.filter((_, k) => place.piece[k] === piece).flat();
      const at = [0, 1, 2].map((axis) => own.reduce((sum, vertex) => sum + place.vertices[vertex][axis], 0) / (own.length || 1));
      return { text: label, at };
    });
    const faces = pieces.map((_, piece) => ({
      colour: REGIONS[piece % REGIONS.length],
      vertices: place.vertices,
      triangles: place.triangles.filter((_, k) => place.piece[k] === piece),
    }));
    return { faces, lines: [], labels, key: [] };
  },
  membrane({ crosses, reactions }) {
    const parts = { [TENSION]: [], [COMPRESSION]: [] };
    crosses.lines.forEach((family, k) => {
      family.forEach((line, face) => {
        if (line) parts[crosses.forces[face][k] >= 0 ? TENSION : COMPRESSION].push(line);
      });
    });
    const arrows = reactions.at.map((at, k) => [at, at.map((value, axis) => value + reactions.forces[k][axis] * reactions.length_per_force)]);
    return {
      faces: [],
      lines: [...Object.entries(parts).map(([colour, ends]) => ({ colour, ends })), { colour: '#2e6b3f', ends: arrows }],
      labels: [],
      key: [
        { colour: TENSION, text: 'tension' },
        { colour: COMPRESSION, text: 'compression' },
        { colour: '#2e6b3f', text: 'reaction' },
      ],
    };
  },
  drawings({ contours, sections }) {
    const ends = (lines) => lines.flatMap(({ points }) => sides(points, false));
    return {
      faces: [],
      lines: [
        { colour: CONTOUR, ends: ends(contours) },
        { colour: SECTION, ends: ends(sections) },
      ],
      labels: sections.map(({ letter, points }) => ({ text: letter, at: points[0] })),
      key: [
        { colour: CONTOUR, text: 'contour line' },
        { colour: SECTION, text: 'section' },
      ],
    };
  },
  net({ curves }) {
    const families = [...new Set(curves.map((own) => own.family))];
    return {
      faces: [],
      lines: families.map((family, k) => ({
        colour: FAMILIES[k % FAMILIES.length],
        ends: curves.filter((own) => own.family === family).flatMap((own) => sides(own.points, false)),
      })),
      labels: [],
      key: families.map((family, k) => {
        // The kind of curves depends on K of the region.
        const kinds = [...new Set(curves.filter((own) => own.family === family).map((own) => own.kind))].join(', ');
        const way = ['first family', 'second family'][family];
        return { colour: FAMILIES[k % FAMILIES.length], text: families.length > 1 ? `${kinds}, ${way}` : kinds };
      }),
    };
  },
};

function sides(points, closed) {
  const count = closed ? points.length : points.length - 1;
  return Array.from({ length: Math.max(0, count) }, (_, k) => [points[k], points[(k + 1) % points.length]]);
}
