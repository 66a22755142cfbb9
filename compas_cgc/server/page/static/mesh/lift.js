/** Smooth interpolation of support heights over the mesh: an initial guess. */

const MAX_SUPPORTS = 400; // interpolated supports; more would be close together

/**
 * Return vertices on a thin-plate spline through given heights.
 * @param {number[][]} ground drawn vertices
 * @param {number[]} held supports
 * @param {Record<number, number>} heights of some supports above their drawn position
 * @returns {number[][]}
 */
export function lifted(ground, held, heights) {
  const known = held.map((vertex) => [vertex, heights[vertex] ?? 0]);
  if (!known.some(([, height]) => height)) return ground;
  const every = Math.ceil(known.length / MAX_SUPPORTS);
  const through = known.filter(([vertex], i) => i % every === 0 || heights[vertex]);
  const plate = thinPlate(
    through.map(([vertex]) => ground[vertex]),
    through.map(([, height]) => height),
  );
  const raised = ground.map((point) => [point[0], point[1], point[2] + plate(point)]);
  for (const [vertex, height] of known) raised[vertex] = [ground[vertex][0], ground[vertex][1], ground[vertex][2] + height];
  return raised;
}

/** Return the thin-plate spline in plan with given values at given points. */
function thinPlate(points, values) {
  const size = Math.max(...points.flatMap((a) => points.map((b) => Math.hypot(a[0] - b[0], a[1] - b[1])))) || 1;
  const place = ([x, y]) => [(x - points[0][0]) / size, (y - points[0][1]) / size];
  const at = points.map(place);
  const n = at.length;
  const rows = at.map((a, i) => [...at.map((b, j) => (i === j ? 1e-9 : bend(a, b))), 1, a[0], a[1], values[i]]);
  for (const row of [0, 1, 2]) {
    const last = at.map((a) => [1, a[0], a[1]][row]);
    // For collinear supports, the slope across their line is zero.
    rows.push([...last, ...[0, 1, 2].map((k) => (k === row ? -1e-9 : 0)), 0]);
  }
  const weights = solved(rows);
  return (point) => {
    const here = place(point);
    return at.reduce((sum, b, j) => sum + weights[j] * bend(here, b), weights[n] + weights[n + 1] * here[0] + weights[n + 2] * here[1]);
  };
}

function bend(a, b) {
  const square = (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2;
  return square > 0 ? 0.5 * square * Math.log(square) : 0;
}

/** Solve a dense system by elimination; the right side is the last column. */
function solved(rows) {
  const n = rows.length;
  for (let k = 0; k < n; k++) {
    let best = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    [rows[k], rows[best]] = [rows[best], rows[k]];
    for (let i = k + 1; i < n; i++) {
      const factor = rows[i][k] / rows[k][k];
      if (factor) for (let j = k; j <= n; j++) rows[i][j] -= factor * rows[k][j];
    }
  }
  const x = new Array(n).fill(0);
  for (let k = n - 1; k >= 0; k--) {
    let sum = rows[k][n];
    for (let j = k + 1; j < n; j++) sum -= rows[k][j] * x[j];
    x[k] = sum / rows[k][k];
  }
  return x;
}
