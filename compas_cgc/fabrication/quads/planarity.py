"""Planarisation of polygons near a surface."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices
from ...linalg import factorise
from ...meshing.closest_on_mesh import nearest_on_mesh
from ...meshing.closest_points import feet_on_polyline
from .extraction import Polygons

__all__ = ["gaps", "planarised", "polygon_edges"]

STEPS = 40
PLANE_WEIGHT, RIM_WEIGHT, KINK_WEIGHT = 1e4, 10.0, 1e3  # against the distance from the surface
FAIR_WEIGHT, STAY_WEIGHT = 0.3, 0.1  # of changes of the lines' shape and of their places within the surface
PLANE, STILL = 1e-9, 1e-6  # of the size: largest gap at which planarisation ends, and step before which aims no longer change


def polygon_edges(polygons: list[list[int]]) -> IntArray:
    """Return every edge of polygons once (e, 2), in order."""
    pairs = [(a, b) for own in polygons for a, b in zip(own, own[1:] + own[:1])]
    return np.unique(np.sort(np.array(pairs, dtype=np.int64), axis=1), axis=0)


def gaps(points: Vectors, polygons: list[list[int]]) -> FloatArray:
    """Return the largest distance between the diagonals of four consecutive corners of every polygon (f,) [L]; 0 for triangles."""
    quadruples, owner = _quadruples(polygons)
    found = np.zeros(len(polygons))
    if len(quadruples):
        np.maximum.at(found, owner, np.abs(_diagonals(points, quadruples)[0]))
    return found


def planarised(own: Polygons, vertices: Vertices, faces: Faces, rims: list[IntArray], around: bool = True) -> Vectors:
    """Return corners (k, 3) [L] near a surface for which polygons are plane.

    Gauss-Newton steps on the distances between diagonals, from tangent planes of the surface and from the rim, and on changes of the
    shape of the lines; then steps on the distances between diagonals alone.

    Parameters
    ----------
    own
        The polygons.
    vertices, faces
        The surface.
    rims
        Closed paths of vertices along its rims.
    around
        Whether polygons with three corners in line are held in planes, too; this moves others where corners are still to be merged.

    References
    ----------
    Liu, Pottmann, Wallner, Yang, Wang, *Geometric modeling with conical meshes and developable surfaces*, 2006,
    doi:10.1145/1141911.1141941.
    """
    n, start = len(own.vertices), own.vertices
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    quadruples = _quadruples(own.faces, around)[0]
    edges = polygon_edges(own.faces)
    degree = np.bincount(edges.ravel(), minlength=n)
    graph = sparse.coo_matrix((np.ones(2 * len(edges)), (edges.T.ravel(), edges[:, ::-1].T.ravel())), shape=(n, n)).tocsr()
    shape = sparse.kron(sparse.identity(n) - sparse.diags(1.0 / degree) @ graph, np.eye(3), format="csr")
    weight = np.where(own.kinks, KINK_WEIGHT, np.where(own.rim, RIM_WEIGHT, 1.0))
    points = start
    fair, stay = FAIR_WEIGHT**2 * (shape.T @ shape), STAY_WEIGHT**2 * sparse.identity(3 * n)
    curves = [vertices[np.append(rim, rim[0])] for rim in rims]
    metric = fair + stay

    def stepped(away: FloatArray) -> Vectors:
        """Return the step (n, 3) towards planes that the metric makes shortest, back from what corners are away (3n,) from their aims."""
        gap, slopes = _diagonals(points, quadruples)
        matrix = sparse.csr_matrix(PLANE_WEIGHT**2 * (slopes.T @ slopes) + metric)
        return factorise(matrix, symmetric=True).solve(-(PLANE_WEIGHT**2 * (slopes.T @ gap) + away)).reshape(-1, 3)

    def is_plane() -> bool:
        return bool(np.abs(_diagonals(points, quadruples)[0]).max(initial=0.0) <= PLANE * size)

    for _ in range(STEPS):
        off, blocks = _aims(points, own, start, vertices, faces, curves)
        close = sparse.block_diag(list(weight[:, None, None] ** 2 * blocks), format="csr")
        metric = close + fair + stay
        step = stepped(close @ off.ravel() + (fair + stay) @ (points - start).ravel())
        points = points + step
        if is_plane() and np.abs(step).max() <= STILL * size:
            return points
    # On strongly curved surfaces the aims change in every step, so that the steps above do not converge.
    for _ in range(STEPS):
        points = points + stepped(np.zeros(3 * n))
        if is_plane():
            break
    return points


def _aims(
    points: Vectors, own: Polygons, start: Vectors, vertices: Vertices, faces: Faces, curves: list[Vectors]
) -> tuple[Vectors, FloatArray]:
    """Return displacements (k, 3) from the aims of corners, and the projections (k, 3, 3) on the directions that count."""
    feet, normals = nearest_on_mesh(points, vertices, faces)
    off, blocks = points - feet, normals[:, :, None] * normals[:, None]
    for k in np.flatnonzero(own.rim & ~own.kinks).tolist():
        found = [feet_on_polyline(points[k : k + 1], curve) for curve in curves]
        foot, tangent = min(found, key=lambda each: float(np.linalg.norm(each[0] - points[k])))
        off[k], blocks[k] = points[k] - foot[0], np.eye(3) - np.outer(tangent[0], tangent[0])
    off[own.kinks], blocks[own.kinks] = (points - start)[own.kinks], np.eye(3)
    return off, blocks


def _quadruples(polygons: list[list[int]], around: bool = True) -> tuple[IntArray, IntArray]:
    """Return four consecutive corners (q, 4) whose planes make polygons plane, and the polygon of each (q,).

    Three corners in line share a plane with any fourth one, so that polygons of five and more corners need all quadruples around them.
    """
    found = [
        ([own[(k + j) % len(own)] for j in range(4)], f)
        for f, own in enumerate(polygons)
        for k in range(len(own) if around and len(own) > 4 else len(own) - 3)
    ]
    return np.array([each[0] for each in found], dtype=np.int64).reshape(-1, 4), np.array([each[1] for each in found], dtype=np.int64)


def _diagonals(points: Vectors, quadruples: IntArray) -> tuple[FloatArray, sparse.csr_matrix]:
    """Return the distances (q,) between the lines of both diagonals [L], and their derivatives (q, 3k)."""
    a, b, c, d = points[quadruples].transpose(1, 0, 2)
    first, second = c - a, d - b
    normal = np.cross(first, second)
    square = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    unit = normal / np.sqrt(square)[:, None]
    between = b - a
    gap = (unit * between).sum(axis=1)
    # Shares of the diagonals at which they are nearest to each other.
    s = (np.cross(between, second) * normal).sum(axis=1) / square
    t = (np.cross(between, first) * normal).sum(axis=1) / square
    shares = np.column_stack([s - 1.0, 1.0 - t, -s, t])
    values = (shares[:, :, None] * unit[:, None]).reshape(len(gap), -1)
    columns = (3 * quadruples[:, :, None] + np.arange(3)).reshape(len(gap), -1)
    return gap, sparse.csr_matrix((values.ravel(), columns.ravel(), np.arange(0, 12 * len(gap) + 1, 12)), shape=(len(gap), 3 * len(points)))
