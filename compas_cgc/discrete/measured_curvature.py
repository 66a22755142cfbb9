"""Curvature of any triangle mesh by mid-edge normals, with the angles for which shape operators vary most evenly."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ._memo import remembered
from .arrays import TINY
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Vectors
from .arrays import Vertices
from .mid_edge import OCCURRENCES
from .mid_edge import MidEdgeMesh
from .mid_edge import ShapeOperators
from .topology import edge_faces

__all__ = ["LEAST_FACES", "MeasuredCurvature", "even_angles", "linear_residuals", "measured_curvature"]

LEAST_FACES = 4  # faces of a patch; a linear function passes through three
JUMPS = 1e-2  # weight of jumps across edges; they decide where no patch does, as at a corner with a single triangle
BENDING = 1e-9  # weight of bending; it decides for a triangle without neighbours alone
PRECISION = 1e-12  # residual of conjugate gradients relative to the right side, in the scaled norm; 4,500 rounding errors
MAX_ROUNDS = 500  # rounds of conjugate gradients [rounds]; bounds the time on meshes with slivers
RECENT = 2  # surfaces whose curvature is remembered; verdict, laws and colours read the same surface
# area of a triangle relative to the mean below which it has no normal and is left out; half of the digits of its normal are lost
DEGENERATE = 1e-9


class MeasuredCurvature(NamedTuple):
    """Curvatures of a mesh, averaged over the triangles of one region at one vertex; NaN where these have no area."""

    pairs: IntArray  # (p, 2) vertex and region
    gaussian: FloatArray  # (p,) [1/L^2]
    mean: FloatArray  # (p,) [1/L]
    areas: FloatArray  # (p,) [L^2]
    bending: FloatArray  # (m,) integral of the sum of the squared principal curvatures over each triangle
    angles: FloatArray  # (a,) of the edges, from the mean normal of the triangles that share them [rad]

    def at_vertices(self, values: FloatArray, count: int) -> FloatArray:
        """Return values of the pairs (p,) at `count` vertices, means by area where regions meet, NaN where there are none."""
        known = np.isfinite(values)
        at, weight = self.pairs[known, 0], self.areas[known]
        with np.errstate(invalid="ignore"):
            return np.asarray(np.bincount(at, weight * values[known], count) / np.bincount(at, weight, count), dtype=np.float64)


def measured_curvature(vertices: Vertices, faces: Faces, creases: IntArray, regions: IntArray) -> MeasuredCurvature:
    """Measure the curvature of a triangle mesh up to its creases and free edges.

    The angles of mid-edge normals are those for which the shape operators of the triangles around a vertex come nearest to a
    linear function: one sparse linear system. On smooth surfaces the error is of second order in the length of edges, on regular
    and irregular meshes, beside creases and free edges, except where a corner has one triangle alone, there of first order. An average
    stands for the curvature at the centroid of its triangles.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    creases
        ``(c, 2)`` edges along which the surface may fold.
    regions
        ``(m,)`` numbers of the regions between the creases.

    Raises
    ------
    MeshError
        If an edge does not join exactly two faces of opposite direction.

    References
    ----------
    Grinspun, Gingold, Reisman, Zorin, doi:10.1111/j.1467-8659.2006.00974.x. Morley, doi:10.1017/S0001925900004546.
    """
    return _measured(vertices, faces, np.asarray(creases, np.int64).reshape(-1, 2), regions)


def _measure(vertices: Vertices, faces: Faces, creases: IntArray, regions: IntArray) -> MeasuredCurvature:
    normals, double = face_frames(vertices, faces)
    sound = double > DEGENERATE * double.mean()
    if not sound.any():
        none = np.zeros(0)
        return MeasuredCurvature(np.zeros((0, 2), np.int64), none, none, none, np.zeros(len(faces)), none)
    mesh = _mesh(faces[sound], creases, regions[sound], len(vertices), normals[sound])
    angles = even_angles(mesh, vertices)
    operators = mesh.at(vertices, angles)
    averages, bending = mesh.averages(operators), np.zeros(len(faces))
    bending[sound] = operators.bending
    return MeasuredCurvature(mesh.pairs, averages.gaussian, averages.mean, averages.areas, bending, angles)


# Verdict, laws and colours read the same surface.
_measured = remembered(_measure, recent=RECENT)


def even_angles(mesh: MidEdgeMesh, vertices: Vertices) -> FloatArray:
    """Return the angles (a,) for which the shape operators of vertices (n, 3) vary most evenly within every region."""
    flat = mesh.at(vertices, np.zeros(len(mesh.angles.ends)))
    return _most_even_angles(mesh, flat, vertices, face_frames(vertices, mesh.faces)[0])


def face_frames(vertices: Vertices, faces: Faces) -> tuple[Vectors, FloatArray]:
    """Return the unit normals of the faces (m, 3), zero where they have no area, and twice their areas (m,)."""
    crosses = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    double = np.sqrt(np.einsum("mx,mx->m", crosses, crosses))
    return crosses / np.maximum(double, TINY)[:, None], double


def _mesh(faces: Faces, creases: IntArray, regions: IntArray, n: int, normals: Vectors) -> MidEdgeMesh:
    """Return the mesh whose angles are measured from the mean normals of the faces that share them."""
    plain = MidEdgeMesh(faces, creases, regions, np.zeros((n, 3)))
    own = plain.angles
    references = np.zeros((len(own.ends), 3))
    for corner in range(3):
        np.add.at(references, own.of_faces[:, corner], normals)
    plain.references = references
    return plain


def _most_even_angles(mesh: MidEdgeMesh, flat: ShapeOperators, vertices: Vertices, normals: Vectors) -> FloatArray:
    """Return the angles (a,) that minimise the unevenness of the shape operators, which are linear in them."""
    count = len(mesh.angles.ends)
    inverse = sparse.diags(1.0 / flat.areas)
    uneven = (inverse @ _unevenness(mesh, flat.areas, vertices, normals) @ inverse).tocsr()
    index, slopes = mesh.angles.of_faces, flat.angle_slopes
    rows = 6 * len(index)
    by_angles = sparse.csr_matrix((slopes.ravel(), np.repeat(index, 6, axis=0).ravel(), np.arange(0, 3 * rows + 1, 3)), shape=(rows, count))
    onto_angles = by_angles.T.tocsr()

    def pulled(tensors: FloatArray) -> FloatArray:
        """Return half the derivatives of the unevenness (a,) at some tensors (m, 6)."""
        return np.asarray(onto_angles @ (OCCURRENCES * (uneven @ tensors)).ravel(), dtype=np.float64)

    own = uneven.diagonal()[:, None] * np.einsum("mek,e->mk", slopes**2, OCCURRENCES)
    scale = 1.0 / np.bincount(index.ravel(), own.ravel(), count)
    return _solved(lambda angles: pulled((by_angles @ angles).reshape(-1, 6)), scale, -pulled(flat.tensors))


def _solved(times: Callable[[FloatArray], FloatArray], scale: FloatArray, right: FloatArray) -> FloatArray:
    """Return the solution of a symmetric system by conjugate gradients; scaled by (a,), its condition is some 50 on every mesh.

    Sums are NumPy's own, so that the last bits are the same with every BLAS.
    """
    x, r = np.zeros_like(right), right
    z = scale * r
    direction, product = z, float(np.einsum("i,i", r, z))
    least = PRECISION**2 * product
    for _ in range(MAX_ROUNDS):
        if product <= least:
            break
        image = times(direction)
        length = product / float(np.einsum("i,i", direction, image))
        x, r = x + length * direction, r - length * image
        z = scale * r
        before, product = product, float(np.einsum("i,i", r, z))
        direction = z + product / before * direction
    return x


def _unevenness(mesh: MidEdgeMesh, areas: FloatArray, vertices: Vertices, normals: Vectors) -> sparse.csr_matrix:
    """Return the quadratic form (m, m) of what one entry of the shape operators differs from linear functions."""
    m = len(mesh.faces)
    residuals = _patch_residuals(mesh, areas, vertices, normals)
    edges = edge_faces(mesh.faces)
    region_of = mesh.pairs[mesh.pair_of[:, 0], 1]
    left, right = edges[edges[:, 3] >= 0, 2:].T
    inside = region_of[left] == region_of[right]
    left, right = left[inside], right[inside]
    weight = np.sqrt(JUMPS / 3.0 * (areas[left] + areas[right]))
    rows = np.arange(len(left))
    entries = np.concatenate([weight, -weight]), (np.concatenate([rows, rows]), np.concatenate([left, right]))
    jumps = sparse.csr_matrix(entries, shape=(len(left), m))
    return (residuals.T @ residuals + jumps.T @ jumps + BENDING * sparse.diags(areas)).tocsr()


def _patch_residuals(mesh: MidEdgeMesh, areas: FloatArray, vertices: Vertices, normals: Vectors) -> sparse.csr_matrix:
    """Return the operator of what values of the faces (m,) differ from the linear functions fitted to each pair, weighted by area."""
    start, face_of = mesh.incidence.indptr, mesh.incidence.indices
    sizes, first = np.diff(start), 0
    rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for size in np.unique(sizes[sizes >= LEAST_FACES]).tolist():
        own = face_of[start[np.flatnonzero(sizes == size)][:, None] + np.arange(size)]
        residual = linear_residuals(own, areas, vertices[mesh.faces].mean(axis=1), normals)
        row = first + np.arange(own.size).reshape(own.shape)
        first += own.size
        rows.append(np.repeat(row, size))
        columns.append(np.broadcast_to(own[:, None], residual.shape).ravel())
        values.append(residual.ravel())
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sparse.csr_matrix(entries, shape=(first, len(mesh.faces)))


def linear_residuals(faces: IntArray, areas: FloatArray, centroids: Vectors, normals: Vectors) -> FloatArray:
    """Return the matrices (g, k, k) of what values of faces (g, k) differ from the linear functions fitted to them.

    Parameters
    ----------
    faces
        ``(g, k)`` of the patches.
    areas, centroids, normals
        ``(m,)``, ``(m, 3)``, ``(m, 3)`` of all faces: squares are weighted by area, places are taken in the plane of the mean normal.
    """
    along, across = _tangents(normals[faces].sum(axis=1))
    offsets = centroids[faces] - centroids[faces].mean(axis=1, keepdims=True)
    u, v = np.einsum("gkx,gx->gk", offsets, along), np.einsum("gkx,gx->gk", offsets, across)
    radius, weight = np.sqrt((u**2 + v**2).mean(axis=1))[:, None], np.sqrt(areas[faces])
    basis = np.linalg.qr(np.stack([np.ones_like(u), u / radius, v / radius], axis=2) * weight[..., None])[0]
    return np.asarray((np.eye(faces.shape[1]) - basis @ basis.transpose(0, 2, 1)) * weight[:, None])


def _tangents(normals: Vectors) -> tuple[Vectors, Vectors]:
    """Return two unit vectors each (g, 3) that are perpendicular to vectors and to each other."""
    helper = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    along = np.cross(normals, helper)
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = np.cross(normals, along)
    return along, across / np.linalg.norm(across, axis=1)[:, None]
