/** Gaussian curvature of a triangle mesh: angle defects over mixed Voronoi areas (doi:10.1007/978-3-662-05105-4_2). */

/**
 * Return K at every vertex where it is measured, NaN elsewhere.
 * @param {ArrayLike<number>} xyz coordinates, three per vertex
 * @param {ArrayLike<number>} faces vertices, three per face
 * @param {ArrayLike<number>} asked 1 where K is measured, per vertex
 * @returns {Float64Array}
 */
export function gaussianCurvature(xyz, faces, asked) {
  const count = xyz.length / 3;
  const defect = new Float64Array(count).fill(2 * Math.PI);
  const area = new Float64Array(count);
  const side = [new Float64Array(3), new Float64Array(3), new Float64Array(3)];
  for (let f = 0; f < faces.length; f += 3) {
    // side[k] runs from corner k + 1 to corner k + 2, so it lies opposite corner k.
    for (let k = 0; k < 3; k++) {
      const from = 3 * faces[f + ((k + 1) % 3)];
      const to = 3 * faces[f + ((k + 2) % 3)];
      for (let axis = 0; axis < 3; axis++) side[k][axis] = xyz[to + axis] - xyz[from + axis];
    }
    const double = crossLength(side[0], side[1]);
    const cosine = [0, 1, 2].map((k) => -dot(side[(k + 1) % 3], side[(k + 2) % 3]));
    const obtuse = cosine.findIndex((value) => value < 0);
    for (let k = 0; k < 3; k++) {
      const vertex = faces[f + k];
      defect[vertex] -= Math.atan2(double, cosine[k]);
      if (obtuse >= 0) area[vertex] += double / (k === obtuse ? 4 : 8);
      else {
        const [next, last] = [(k + 1) % 3, (k + 2) % 3];
        area[vertex] += (dot(side[next], side[next]) * cosine[next] + dot(side[last], side[last]) * cosine[last]) / (8 * double);
      }
    }
  }
  return defect.map((value, vertex) => (asked[vertex] ? value / area[vertex] : Number.NaN));
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function crossLength(a, b) {
  return Math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}
