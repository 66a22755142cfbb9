/** Vertices split between regions, so that colours and normals end at creases. */

/** The corners of the faces, one per vertex and region. */
export class Wedges {
  /** @param {import('./model.js').Model} model */
  constructor(model) {
    const known = new Map();
    const vertexOf = [];
    const regionOf = [];
    this.index = Uint32Array.from(model.faces, (vertex, corner) => {
      const region = model.regions[Math.floor(corner / 3)];
      const key = vertex * model.targets.length + region;
      let wedge = known.get(key);
      if (wedge === undefined) {
        wedge = vertexOf.length;
        known.set(key, wedge);
        vertexOf.push(vertex);
        regionOf.push(region);
      }
      return wedge;
    });
    this.vertexOf = Uint32Array.from(vertexOf);
    this.regionOf = Uint32Array.from(regionOf);
    this.count = vertexOf.length;
    this.edges = edgesOf(model.faces, this.index, model.count);
  }

  /**
   * Copy the coordinates of the vertices to the wedges.
   * @param {Float32Array} xyz three per vertex
   * @param {Float32Array} out three per wedge
   */
  place(xyz, out) {
    for (let wedge = 0; wedge < this.count; wedge++) {
      const from = 3 * this.vertexOf[wedge];
      out[3 * wedge] = xyz[from];
      out[3 * wedge + 1] = xyz[from + 1];
      out[3 * wedge + 2] = xyz[from + 2];
    }
  }

  /**
   * Compute unit normals of the wedges: the area-weighted mean of the face normals.
   * @param {Float32Array} at coordinates, three per wedge
   * @param {Float32Array} out three per wedge
   */
  normals(at, out) {
    out.fill(0);
    const { index } = this;
    for (let corner = 0; corner < index.length; corner += 3) {
      const [a, b, c] = [3 * index[corner], 3 * index[corner + 1], 3 * index[corner + 2]];
      const [ux, uy, uz] = [at[b] - at[a], at[b + 1] - at[a + 1], at[b + 2] - at[a + 2]];
      const [vx, vy, vz] = [at[c] - at[a], at[c + 1] - at[a + 1], at[c + 2] - at[a + 2]];
      const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      for (const k of [a, b, c]) {
        out[k] += x;
        out[k + 1] += y;
        out[k + 2] += z;
      }
    }
    for (let k = 0; k < out.length; k += 3) {
      const length = Math.hypot(out[k], out[k + 1], out[k + 2]) || 1;
      out[k] /= length;
      out[k + 1] /= length;
      out[k + 2] /= length;
    }
  }

  /**
   * Copy values of vertices to the wedges; a missing value is replaced by the mean of the neighbours in its region.
   * @param {ArrayLike<number>} values per vertex, NaN if missing
   * @returns {Float64Array} per wedge
   */
  spread(values) {
    let own = Float64Array.from(this.vertexOf, (vertex) => values[vertex]);
    // Twice, as at the corner of two creases no neighbour has a value.
    for (let round = 0; round < 2; round++) own = this.filled(own);
    return own;
  }

  filled(own) {
    const sum = new Float64Array(this.count);
    const count = new Float64Array(this.count);
    for (let corner = 0; corner < this.index.length; corner++) {
      const [here, next] = [this.index[corner], this.index[corner % 3 === 2 ? corner - 2 : corner + 1]];
      for (const [to, from] of [
        [here, next],
        [next, here],
      ]) {
        if (Number.isFinite(own[from])) {
          sum[to] += own[from];
          count[to] += 1;
        }
      }
    }
    return own.map((value, wedge) => (Number.isFinite(value) ? value : sum[wedge] / count[wedge]));
  }
}

function edgesOf(faces, index, count) {
  const seen = new Set();
  const edges = [];
  for (let corner = 0; corner < faces.length; corner++) {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const [u, v] = [faces[corner], faces[next]];
    const key = Math.min(u, v) * count + Math.max(u, v);
    if (!seen.has(key)) {
      seen.add(key);
      edges.push(index[corner], index[next]);
    }
  }
  return Uint32Array.from(edges);
}
