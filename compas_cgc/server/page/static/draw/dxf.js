/** Lines of a DXF file: LINE, LWPOLYLINE, POLYLINE, CIRCLE, ARC, ELLIPSE, SPLINE and POINT, in plan. */

import { circle, emptyPlan } from './plan.js';

const UNITS = { 1: 'in', 2: 'ft', 4: 'mm', 5: 'cm', 6: 'm' };
const CHORD = Math.PI / 36; // radians between two points of an arc
const SAMPLES = 24; // points to each knot of a spline

/**
 * Return the plan in a DXF file.
 * @param {string} text
 * @returns {import('./plan.js').Plan}
 * @throws {Error} where it holds no lines
 */
export function planOfDxf(text) {
  const pairs = pairsOf(text);
  const unit = pairs.findIndex(([code, value]) => code === 9 && value === '$INSUNITS');
  const lines = [];
  const columns = [];
  for (const entity of entitiesOf(pairs)) {
    const made = READERS[entity.type]?.(entity);
    if (made?.points?.length > 1) lines.push({ held: [], ...made });
    if (entity.type === 'POINT') columns.push({ x: entity.one(10), y: entity.one(20), height: entity.one(30) || 0 });
  }
  if (!lines.length) throw new Error('There are no lines, arcs, circles or curves in this DXF file. Save it as text (ASCII) with the curves not inside of blocks.');
  return { ...emptyPlan(), unit: UNITS[unit < 0 ? 0 : Number(pairs[unit + 1]?.[1])] ?? '', lines: joined(lines), columns };
}

function pairsOf(text) {
  const rows = text.split(/\r\n|\r|\n/);
  const pairs = [];
  for (let k = 0; k + 1 < rows.length; k += 2) pairs.push([Number(rows[k]), rows[k + 1].trim()]);
  return pairs;
}

/** Return the entities of the model, with the vertices of an old polyline inside of it. */
function entitiesOf(pairs) {
  const begin = pairs.findIndex(([code, value], k) => code === 2 && value === 'ENTITIES' && pairs[k - 1]?.[1] === 'SECTION');
  const found = [];
  for (let k = begin + 1; begin >= 0 && k < pairs.length; k++) {
    const [code, value] = pairs[k];
    if (code === 0 && value === 'ENDSEC') break;
    if (code === 0) found.push(new Entity(value));
    else found.at(-1)?.pairs.push([code, value]);
  }
  let open = null;
  for (const entity of found) {
    if (entity.type === 'POLYLINE') open = entity;
    else if (entity.type === 'VERTEX') open?.corners.push(entity);
    else if (entity.type === 'SEQEND') open = null;
  }
  return found;
}

/** One entity, with its values by their codes. */
class Entity {
  constructor(type) {
    this.type = type;
    this.pairs = [];
    this.corners = [];
  }

  all(code) {
    return this.pairs.filter(([own]) => own === code).map(([, value]) => Number(value));
  }

  one(code, otherwise = 0) {
    return this.all(code)[0] ?? otherwise;
  }
}

const READERS = {
  LINE: (own) => ({
    points: [
      [own.one(10), own.one(20)],
      [own.one(11), own.one(21)],
    ],
    closed: false,
  }),
  LWPOLYLINE(own) {
    // A bulge belongs to the point before it, and there may be none.
    const corners = [];
    for (const [code, value] of own.pairs) {
      if (code === 10) corners.push({ x: Number(value), y: 0, bulge: 0 });
      else if (code === 20 && corners.length) corners.at(-1).y = Number(value);
      else if (code === 42 && corners.length) corners.at(-1).bulge = Number(value);
    }
    return bulged(corners, (own.one(70) & 1) === 1);
  },
  POLYLINE: (own) =>
    bulged(
      own.corners.filter((each) => !(each.one(70) & 16)).map((each) => ({ x: each.one(10), y: each.one(20), bulge: each.one(42) })),
      (own.one(70) & 1) === 1,
    ),
  CIRCLE: (own) => circle(own.one(10), own.one(20), own.one(40)),
  ARC(own) {
    const from = (own.one(50) * Math.PI) / 180;
    const turn = ((((own.one(51) - own.one(50)) % 360) + 360) % 360 || 360) * (Math.PI / 180);
    const at = (angle) => [own.one(10) + own.one(40) * Math.cos(angle), own.one(20) + own.one(40) * Math.sin(angle)];
    return { points: along(turn).map((share) => at(from + share * turn)), closed: false };
  },
  ELLIPSE(own) {
    const [a, ratio] = [[own.one(11), own.one(21)], own.one(40, 1)];
    const [from, to] = [own.one(41), own.one(42, 2 * Math.PI)];
    const at = (t) => [0, 1].map((k) => own.one(10 + 10 * k) + a[k] * Math.cos(t) + ratio * [-a[1], a[0]][k] * Math.sin(t));
    const closed = Math.abs(to - from - 2 * Math.PI) < 1e-6;
    const points = along(to - from).map((share) => at(from + share * (to - from)));
    return { points: closed ? points.slice(0, -1) : points, closed };
  },
  SPLINE(own) {
    const [xs, ys, knots, weights] = [10, 20, 40, 41].map((code) => own.all(code));
    const degree = own.one(71, 3);
    if (!xs.length) return { points: own.all(11).map((x, k) => [x, own.all(21)[k]]), closed: (own.one(70) & 1) === 1 };
    const [begin, end] = [knots[degree], knots[xs.length]];
    const count = SAMPLES * (xs.length - degree) + 1;
    const points = Array.from({ length: count }, (_, k) => deBoor(begin + ((end - begin) * k) / (count - 1), degree, knots, xs, ys, weights));
    return closedUp(points);
  },
};

function along(turn) {
  const count = Math.max(2, Math.ceil(Math.abs(turn) / CHORD));
  return Array.from({ length: count + 1 }, (_, k) => k / count);
}

/** Return the points of a polyline whose segments may be arcs: a bulge is the tangent of a quarter of the angle. */
function bulged(corners, closed) {
  const points = [];
  corners.forEach(({ x, y, bulge }, k) => {
    points.push([x, y]);
    const next = corners[k + 1] ?? (closed ? corners[0] : null);
    if (!bulge || !next) return;
    const turn = 4 * Math.atan(bulge);
    const half = 0.5 / Math.tan(turn / 2);
    const centre = [(x + next.x) / 2 - half * (next.y - y), (y + next.y) / 2 + half * (next.x - x)];
    for (const share of along(turn).slice(1, -1)) {
      const [c, s] = [Math.cos(share * turn), Math.sin(share * turn)];
      points.push([centre[0] + c * (x - centre[0]) - s * (y - centre[1]), centre[1] + s * (x - centre[0]) + c * (y - centre[1])]);
    }
  });
  return closedUp(points, closed);
}

/** Return a line as closed where its ends are one. */
function closedUp(points, closed = false) {
  const [first, last] = [points[0], points.at(-1)];
  const size = Math.max(...points.map(([x, y]) => Math.hypot(x - first[0], y - first[1])));
  if (points.length > 3 && Math.hypot(first[0] - last[0], first[1] - last[1]) <= 1e-6 * size) return { points: points.slice(0, -1), closed: true };
  return { points, closed };
}

function deBoor(t, degree, knots, xs, ys, weights) {
  let span = degree;
  while (span < xs.length - 1 && knots[span + 1] <= t) span++;
  const own = Array.from({ length: degree + 1 }, (_, k) => {
    const at = span - degree + k;
    const weight = weights[at] ?? 1;
    return [xs[at] * weight, ys[at] * weight, weight];
  });
  for (let level = 1; level <= degree; level++) {
    for (let k = degree; k >= level; k--) {
      const at = span - degree + k;
      const share = (t - knots[at]) / (knots[at + degree - level + 1] - knots[at]) || 0;
      own[k] = own[k].map((value, axis) => (1 - share) * own[k - 1][axis] + share * value);
    }
  }
  const [x, y, weight] = own[degree];
  return [x / weight, y / weight];
}

/** Join open lines whose ends are one. */
function joined(lines) {
  const closed = lines.filter((line) => line.closed);
  const open = lines.filter((line) => !line.closed);
  const size = Math.max(...lines.flatMap(({ points }) => points.map(([x, y]) => Math.hypot(x - lines[0].points[0][0], y - lines[0].points[0][1]))));
  const same = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]) <= 1e-6 * size;
  const meets = (point) => open.filter(({ points }) => same(points[0], point) || same(points.at(-1), point)).length;
  const ready = [];
  while (open.length) {
    let line = open.pop();
    for (let found = true; found && !line.closed; ) {
      found = false;
      for (const end of [line.points.at(-1), line.points[0]]) {
        // Where three meet nobody knows which two are one line.
        if (meets(end) !== 1) continue;
        const [next] = open.splice(
          open.findIndex(({ points }) => same(points[0], end) || same(points.at(-1), end)),
          1,
        );
        const own = same(line.points.at(-1), end) ? line.points : line.points.toReversed();
        const more = same(next.points[0], end) ? next.points : next.points.toReversed();
        line = { ...line, ...closedUp([...own, ...more.slice(1)]) };
        found = true;
        break;
      }
    }
    ready.push(line);
  }
  return [...closed, ...ready];
}
