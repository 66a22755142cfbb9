/** Curvatures of quadrics fitted to the two rings around each vertex (doi:10.1016/j.cagd.2004.09.004). */

/**
 * Return K, H and both principal curvatures at the requested vertices, NaN elsewhere.
 * @param {ArrayLike<number>} xyz three per vertex
 * @param {ArrayLike<number>} faces
 * @param {number[][]} near neighbours of every vertex
 * @param {ArrayLike<number>} wanted 1 for requested vertices; fits do not extend across others
 * @returns {{K: Float64Array, H: Float64Array, largest: Float64Array, smallest: Float64Array}}
 */
export function quadricCurvatures(xyz, faces, near, wanted) {
  const count = near.length;
  const normals = vertexNormals(xyz, faces);
  const [K, H, largest, smallest] = [0, 1, 2, 3].map(() => new Float64Array(count).fill(Number.NaN));
  const row = new Float64Array(5);
  for (let i = 0; i < count; i++) {
    if (!wanted[i]) continue;
    const ring = new Set(near[i]);
    for (const j of near[i]) if (wanted[j]) for (const k of near[j]) if (k !== i) ring.add(k);
    if (ring.size < 5) continue;
    const n = normals.subarray(3 * i, 3 * i + 3);
    const x = across(n);
    const y = [n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]];
    const scale = Math.max(...near[i].map((j) => Math.hypot(...[0, 1, 2].map((k) => xyz[3 * j + k] - xyz[3 * i + k]))));
    const M = Array.from({ length: 5 }, () => new Float64Array(6));
    for (const j of ring) {
      const d = [0, 1, 2].map((k) => (xyz[3 * j + k] - xyz[3 * i + k]) / scale);
      const [u, v, w] = [x, y, n].map((axis) => d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2]);
      row.set([u, v, 0.5 * u * u, u * v, 0.5 * v * v]);
      const weight = 1 / (u * u + v * v + 1e-3);
      for (let k = 0; k < 5; k++) {
        for (let m = 0; m < 5; m++) M[k][m] += weight * row[k] * row[m];
        M[k][5] += weight * row[k] * w;
      }
    }
    const [p, q, uu, uv, vv] = solved(M);
    const g = 1 + p * p + q * q;
    K[i] = (uu * vv - uv * uv) / (g * g) / (scale * scale);
    H[i] = -((1 + q * q) * uu - 2 * p * q * uv + (1 + p * p) * vv) / (2 * g * Math.sqrt(g)) / scale;
    const spread = Math.sqrt(Math.max(H[i] * H[i] - K[i], 0));
    largest[i] = H[i] + spread;
    smallest[i] = H[i] - spread;
  }
  return { K, H, largest, smallest };
}

/** Solve five normal equations; regularisation handles rings on a conic. */
function solved(M) {
  const lift = 1e-14 * M.reduce((sum, line, k) => sum + line[k], 0);
  for (let k = 0; k < 5; k++) M[k][k] += lift;
  for (let k = 0; k < 5; k++) {
    for (let i = k + 1; i < 5; i++) {
      const factor = M[i][k] / M[k][k];
      for (let j = k; j < 6; j++) M[i][j] -= factor * M[k][j];
    }
  }
  const x = [0, 0, 0, 0, 0];
  for (let k = 4; k >= 0; k--) {
    let sum = M[k][5];
    for (let j = k + 1; j < 5; j++) sum -= M[k][j] * x[j];
    x[k] = sum / M[k][k];
  }
  return x;
}

/** Return a unit vector perpendicular to a normal. */
function across(n) {
  const size = [0, 1, 2].map((k) => Math.abs(n[k]));
  const least = size.indexOf(Math.min(...size));
  const made = [
    [0, n[2], -n[1]],
    [-n[2], 0, n[0]],
    [n[1], -n[0], 0],
  ][least];
  const length = Math.hypot(...made) || 1;
  return made.map((each) => each / length);
}

function vertexNormals(xyz, faces) {
  const out = new Float64Array(xyz.length);
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
    const u = [0, 1, 2].map((k) => xyz[b + k] - xyz[a + k]);
    const v = [0, 1, 2].map((k) => xyz[c + k] - xyz[a + k]);
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const at of [a, b, c]) for (let k = 0; k < 3; k++) out[at + k] += normal[k];
  }
  for (let k = 0; k < out.length; k += 3) {
    const length = Math.hypot(out[k], out[k + 1], out[k + 2]) || 1;
    for (let axis = 0; axis < 3; axis++) out[k + axis] /= length;
  }
  return out;
}
