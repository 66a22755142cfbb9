/** A drawing in plan: closed lines, creases and columns, as plain data. */

const ROUND = 72; // sides of a circle
const DEFAULT_EDGES = 18; // default number of edges across a plan

/**
 * @typedef {object} Line
 * @property {number[][]} points [x, y]
 * @property {boolean} closed
 * @property {number[]} held supported segments, each by its first point
 * @property {{x: number, y: number, r: number}} [circle]
 * @property {string} [layer] layer in the source file
 */
/**
 * @typedef {object} Plan
 * @property {string} unit
 * @property {?number} edge edge length of its mesh, null for the default
 * @property {Line[]} lines
 * @property {{x: number, y: number, height: number}[]} columns
 * @property {string[]} [notes] notes on the source file
 */

export const SAME = 1e-9; // distance below which two points are one

/** @returns {Plan} */
export function emptyPlan() {
  return { unit: 'm', edge: null, lines: [], columns: [] };
}

/**
 * Make a circle.
 * @param {number} x
 * @param {number} y
 * @param {number} r
 * @returns {Line}
 */
export function circle(x, y, r) {
  const turn = (k) => (2 * Math.PI * k) / ROUND;
  const points = Array.from({ length: ROUND }, (_, k) => [x + r * Math.cos(turn(k)), y + r * Math.sin(turn(k))]);
  return { points, closed: true, held: [], circle: { x, y, r } };
}

/**
 * Return the area within a line.
 * @param {number[][]} points
 * @returns {number}
 */
export function areaOf(points) {
  return Math.abs(points.reduce((sum, [x, y], k) => sum + x * points[(k + 1) % points.length][1] - points[(k + 1) % points.length][0] * y, 0)) / 2;
}

/**
 * Return the role of each line: the largest closed line is the outline, other closed lines are holes, open lines are creases.
 * @param {Plan} plan
 * @returns {string[]} outline, hole or fold
 */
export function rolesOf({ lines }) {
  const areas = lines.map(({ points, closed }) => (closed ? areaOf(points) : -1));
  const largest = areas.indexOf(Math.max(...areas));
  return lines.map(({ closed }, k) => (!closed ? 'fold' : k === largest ? 'outline' : 'hole'));
}

/**
 * Return the ends of every segment of a line.
 * @param {Line} line
 * @returns {number[][][]}
 */
export function segmentsOf({ points, closed }) {
  return points.slice(0, closed ? points.length : -1).map((point, k) => [point, points[(k + 1) % points.length]]);
}

/**
 * Return the corners of all that is drawn.
 * @param {{lines: Line[], columns: {x: number, y: number}[]}} plan
 * @returns {?{x0: number, y0: number, x1: number, y1: number}} null where nothing is
 */
export function boundsOf({ lines, columns }) {
  const points = [...lines.flatMap((line) => line.points), ...columns.map(({ x, y }) => [x, y])];
  if (!points.length) return null;
  const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
  return { x0: Math.min(...xs), y0: Math.min(...ys), x1: Math.max(...xs), y1: Math.max(...ys) };
}

/**
 * Return a rounded default edge length for a plan.
 * @param {Plan} plan
 * @returns {?number}
 */
export function suggestedEdge(plan) {
  const outline = plan.lines[rolesOf(plan).indexOf('outline')];
  if (!outline) return null;
  // Areas of a self-intersecting outline may cancel; meshing reports the error.
  const { x0, y0, x1, y1 } = boundsOf({ lines: [outline], columns: [] });
  const length = (Math.sqrt(areaOf(outline.points)) || Math.hypot(x1 - x0, y1 - y0)) / DEFAULT_EDGES;
  const decade = 10 ** Math.floor(Math.log10(length));
  const step = [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].find((each) => each * decade >= length * 0.93);
  return Number((step * decade).toPrecision(2));
}

/**
 * Return the request for the mesh of a plan.
 * @param {Plan} plan
 * @param {string} name
 * @returns {object}
 */
export function requestOf(plan, name) {
  const roles = rolesOf(plan);
  const of = (role) => plan.lines.filter((_, k) => roles[k] === role).map(({ points }) => points);
  const held = plan.lines.flatMap((line) => line.held.map((k) => segmentsOf(line)[k]).filter(Boolean));
  return {
    name,
    unit: plan.unit,
    edge_length: plan.edge ?? suggestedEdge(plan),
    outline: of('outline')[0] ?? [],
    holes: of('hole'),
    creases: of('fold'),
    points: plan.columns.map(({ x, y }) => [x, y]),
    held,
  };
}

/**
 * Change the length of a segment; the points beyond its end move along.
 * @param {Line} line
 * @param {number} k
 * @param {number} length
 * @returns {Line}
 */
export function withLength(line, k, length) {
  const count = line.points.length;
  const [a, b] = segmentsOf(line)[k];
  const now = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (!(now > 0 && length > 0)) return line;
  const by = [0, 1].map((axis) => (b[axis] - a[axis]) * (length / now - 1));
  const beyond = line.closed ? (count > 3 ? [k + 1, k + 2] : [k + 1]) : Array.from({ length: count - k - 1 }, (_, i) => k + 1 + i);
  const moving = new Set(beyond.map((each) => each % count));
  return { ...line, points: line.points.map(([x, y], i) => (moving.has(i) ? [tidy(x + by[0]), tidy(y + by[1])] : [x, y])) };
}

/**
 * Return the places of a line that can be moved: its points, or the centre of a circle.
 * @param {Line} line
 * @returns {number[][]}
 */
export function placesOf({ circle: round, points }) {
  return round ? [[round.x, round.y]] : points;
}

/**
 * Return a function that checks whether a point is at one of some places.
 * @param {number[][]} places
 * @returns {(point: number[]) => boolean}
 */
export function isAt(places) {
  return ([x, y]) => places.some((own) => Math.hypot(x - own[0], y - own[1]) < SAME);
}

/**
 * Move all points of lines, circles and columns at some places, so that the ends of creases follow the corner at which they lie.
 * @param {Plan} plan
 * @param {number[][]} places
 * @param {number[]} by
 * @returns {Plan}
 */
export function withMoved(plan, places, by) {
  const isThere = isAt(places);
  const moved = (/** @type {number[]} */ [x, y]) => [tidy(x + by[0]), tidy(y + by[1])];
  const lines = plan.lines.map((line) => {
    if (!placesOf(line).some(isThere)) return line;
    if (!line.circle) return { ...line, points: line.points.map((own) => (isThere(own) ? moved(own) : own)) };
    const [x, y] = moved([line.circle.x, line.circle.y]);
    return { ...line, ...circle(x, y, line.circle.r), held: line.held };
  });
  const columns = plan.columns.map((own) => {
    const [x, y] = moved([own.x, own.y]);
    return isThere([own.x, own.y]) ? { ...own, x, y } : own;
  });
  return { ...plan, lines, columns };
}

/**
 * Remove all points of lines, circles and columns at some places, and lines of which too few points remain.
 * @param {Plan} plan
 * @param {number[][]} places
 * @returns {Plan}
 */
export function without(plan, places) {
  const isThere = isAt(places);
  const lines = plan.lines.flatMap((line) => {
    if (!placesOf(line).some(isThere)) return [line];
    const kept = line.points.flatMap((own, k) => (isThere(own) ? [] : [k]));
    if (line.circle || kept.length < (line.closed ? 3 : 2)) return [];
    return [{ ...line, points: kept.map((k) => line.points[k]), held: line.held.filter((k) => kept.includes(k)).map((k) => kept.indexOf(k)) }];
  });
  return { ...plan, lines, columns: plan.columns.filter(({ x, y }) => !isThere([x, y])) };
}

/**
 * Support a corner by a column, or release it.
 * @param {Plan} plan
 * @param {number[]} place
 * @returns {Plan}
 */
export function withCorner(plan, place) {
  const others = plan.columns.filter(({ x, y }) => !isAt([place])([x, y]));
  const columns = others.length < plan.columns.length ? others : [...others, { x: place[0], y: place[1], height: 0 }];
  return { ...plan, columns };
}

/**
 * Return a coordinate without rounding errors.
 * @param {number} value
 * @returns {number}
 */
export function tidy(value) {
  return Number(value.toFixed(9));
}
