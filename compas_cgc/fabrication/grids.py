"""Coordinates for dividing regions: in plan, or along lines of curvature."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.csgraph import minimum_spanning_tree

from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete import vertex_normals
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..discrete.laplacian import cotangent_laplacian
from ..linalg import factorise
from ..meshing import boundary_loops

__all__ = ["curvature_coordinates", "plan_axes", "plan_coordinates", "square_coordinates"]

UMBILIC_RATIO = 0.2  # median difference of the principal curvatures over the largest curvature below which directions are undefined
CORNER = np.radians(45.0)  # least turn of the boundary in plan at a corner
ROW_TOLERANCE = 1e-6  # tolerance for whole numbers of rows
SMOOTHING_EDGES = 2.0  # smoothing length of lines of curvature in edge lengths
REGULARISATION = 1e-8  # fixes the constant up to which coordinates are determined


def plan_axes(vertices: Vertices, faces: Faces) -> FloatArray:
    """Return two axes of the plan of a mesh and its facing direction (3, 3); the first axis is as near to x as possible."""
    up = (face_areas(vertices, faces)[:, None] * face_normals(vertices, faces)).sum(axis=0)
    long = float(np.linalg.norm(up))
    up = up / long if long > 0.0 else np.array([0.0, 0.0, 1.0])
    if abs(up[2]) > 0.5:
        # The plan of a roof is horizontal.
        up = np.array([0.0, 0.0, np.copysign(1.0, up[2])])
    along = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    along -= (along @ up) * up
    along /= np.linalg.norm(along)
    return np.array([along, np.cross(up, along), up])


def plan_coordinates(vertices: Vertices, faces: Faces) -> FloatArray:
    """Return the coordinates of vertices in plan (n, 2) [L]."""
    return vertices @ plan_axes(vertices, faces)[:2].T


def square_coordinates(vertices: Vertices, faces: Faces) -> Optional[FloatArray]:
    """Return coordinates along the sides of a region with four corners (n, 2) [L], None for other regions.

    On a structured mesh they follow its rows; otherwise they are harmonic, with boundary values proportional to plan lengths. Ranges
    are the mean plan lengths of opposite sides.
    """
    loops = boundary_loops(faces)
    if len(loops) != 1:
        return None
    axes = plan_axes(vertices, faces)
    loop = loops[0]
    plan = vertices[loop] @ axes[:2].T
    ahead = np.roll(plan, -1, axis=0) - plan
    turn = np.angle((ahead @ [1.0, 1.0j]) / (np.roll(ahead, 1, axis=0) @ [1.0, 1.0j]))
    corners = np.flatnonzero(np.abs(turn) > CORNER)
    if len(corners) != 4 or (turn[corners] < 0.0).any():
        return None
    sides = np.roll(plan[corners], -1, axis=0) - plan[corners]
    corners = np.roll(corners, -int(np.argmax(sides[:, 0] / np.linalg.norm(sides, axis=1))))
    step = np.linalg.norm(ahead, axis=1)
    at = [(corners[k] + np.arange((corners[(k + 1) % 4] - corners[k]) % len(loop))) % len(loop) for k in range(4)]
    lengths = [float(step[own].sum()) for own in at]
    inner = np.setdiff1d(np.unique(faces), loop)
    result = np.zeros((len(vertices), 2))
    rows = [len(at[0]), len(at[1])]
    if rows == [len(at[2]), len(at[3])]:
        result[loop] = _around_square(at, np.ones(len(loop)))
        result[inner] = _spread(_neighbours(faces, len(vertices)), inner, loop, result[loop])
        number = result * rows
        if np.abs(number - np.round(number)).max() > ROW_TOLERANCE:
            rows = []
    else:
        rows = []
    if not rows:
        result[loop] = _around_square(at, step)
        result[inner] = _spread(-cotangent_laplacian(vertices, faces), inner, loop, result[loop])
    return result * [0.5 * (lengths[0] + lengths[2]), 0.5 * (lengths[1] + lengths[3])]


def _around_square(sides: list[IntArray], step: FloatArray) -> FloatArray:
    """Return the positions of four sides on the unit square (k, 2), proportional to the lengths `step` (k,)."""
    place = np.zeros((len(step), 2))
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for k, own in enumerate(sides):
        share = (np.cumsum(step[own]) - step[own]) / step[own].sum()
        place[own] = square[k] + share[:, None] * (square[(k + 1) % 4] - square[k])
    return place


def _neighbours(faces: Faces, n: int) -> sparse.csr_matrix:
    """Return the graph Laplacian with unit weights (Tutte, doi:10.1112/plms/s3-13.1.743)."""
    joined = sparse.csr_matrix((np.ones(faces.size), (faces.ravel(), np.roll(faces, -1, axis=1).ravel())), shape=(n, n))
    joined = ((joined + joined.T) > 0).astype(np.float64).tocsr()
    return (sparse.diags(np.asarray(joined.sum(axis=1)).ravel()) - joined).tocsr()


def _spread(laplacian: sparse.csr_matrix, inner: IntArray, loop: IntArray, values: FloatArray) -> FloatArray:
    """Return the harmonic values of inner vertices (k, 2) for given values along a loop."""
    if not len(inner):
        return np.empty((0, 2))
    rows = laplacian.tocsr()[inner]
    return factorise(rows[:, inner].tocsr(), symmetric=True).solve(-(rows[:, loop] @ values))


def curvature_coordinates(vertices: Vertices, faces: Faces) -> FloatArray:
    """Return coordinates along the two families of lines of curvature (n, 2) [L].

    Their gradients fit the principal directions in least squares, weighted by the difference of the principal curvatures.
    Directions of neighbours are matched modulo right angles along a spanning tree through the most distinct ones. The
    coordinates are smooth over a few edges, and over more near umbilics. Where directions are undefined, as on a sphere,
    plan coordinates are returned.
    """
    direction, weight, largest = _principal_directions(vertices, faces)
    axes = plan_axes(vertices, faces)
    normals = face_normals(vertices, faces)
    if np.median(weight) <= UMBILIC_RATIO * largest:
        return plan_coordinates(vertices, faces)
    direction = _combed(direction, weight, normals, faces, axes[0])
    gradient = _gradient(vertices, faces)
    sure = face_areas(vertices, faces) * (weight / weight.max() + 1e-3)
    weights = sparse.diags(np.repeat(sure, 3))
    system = (gradient.T @ weights @ gradient + _bending(vertices, faces)).tocsr()
    system = (system + REGULARISATION * sparse.diags(system.diagonal() + system.diagonal().mean())).tocsr()
    right = np.column_stack([gradient.T @ (weights @ own.ravel()) for own in (direction, np.cross(normals, direction))])
    return factorise(system, symmetric=True).solve(right)


def _principal_directions(vertices: Vertices, faces: Faces) -> tuple[FloatArray, FloatArray, float]:
    """Return the direction of the larger principal curvature (m, 3), the difference of both (m,), and the largest of all [1/L].

    The second fundamental form of a face follows from the change of vertex normals along its edges (Rusinkiewicz,
    doi:10.1109/TDPVT.2004.1335277).
    """
    normals, at = face_normals(vertices, faces), vertex_normals(vertices, faces)
    corners, turns = vertices[faces], at[faces]
    first = corners[:, 1] - corners[:, 0]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    frame = np.stack([first, np.cross(normals, first)], axis=1)
    edges = np.einsum("fcx,fex->fec", frame, np.roll(corners, -1, axis=1) - corners)
    bends = np.einsum("fcx,fex->fec", frame, np.roll(turns, -1, axis=1) - turns)
    zero = np.zeros(len(faces))
    rows = []
    for e in range(3):
        u, v = edges[:, e].T
        rows += [np.column_stack([u, v, zero]), np.column_stack([zero, u, v])]
    A, b = np.stack(rows, axis=1), bends.reshape(len(faces), 6)
    form = np.linalg.solve(np.einsum("fij,fik->fjk", A, A), np.einsum("fij,fi->fj", A, b)[:, :, None])[:, :, 0]
    p, q, r = form.T
    angle = 0.5 * np.arctan2(2 * q, p - r)
    direction = np.cos(angle)[:, None] * frame[:, 0] + np.sin(angle)[:, None] * frame[:, 1]
    return direction, np.hypot(p - r, 2 * q), float(np.abs(np.column_stack([p + r, p - r])).max(initial=0.0))


def _combed(direction: FloatArray, weight: FloatArray, normals: FloatArray, faces: Faces, along: FloatArray) -> FloatArray:
    """Return directions rotated by multiples of 90 degrees to agree with their neighbours, starting from the most distinct one."""
    edges = edge_faces(faces)
    left, right = edges[edges[:, 3] >= 0, 2:].T
    unsure = 2.0 - np.minimum(weight[left], weight[right]) / weight.max()
    tree = minimum_spanning_tree(sparse.csr_matrix((unsure, (left, right)), shape=(len(faces), len(faces))))
    order, before = breadth_first_order(tree, int(np.argmax(weight)), directed=False)
    result = direction.copy()
    for f in order:
        wanted = along if before[f] < 0 else result[before[f]]
        turned = np.cross(normals[f], direction[f])
        choices = np.array([direction[f], turned, -direction[f], -turned])
        result[f] = choices[np.argmax(choices @ wanted)]
    return result


def _bending(vertices: Vertices, faces: Faces) -> sparse.csr_matrix:
    """Return the smoothing matrix (n, n): the squared Laplacian at inner vertices."""
    corners = vertices[faces]
    edge = float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).mean())
    area = np.bincount(faces.ravel(), np.repeat(face_areas(vertices, faces) / 3.0, 3), len(vertices))
    inner = ~boundary_vertices(vertices, faces)
    laplacian = cotangent_laplacian(vertices, faces)
    return laplacian @ sparse.diags(inner * (SMOOTHING_EDGES * edge) ** 2 / area) @ laplacian


def _gradient(vertices: Vertices, faces: Faces) -> sparse.csr_matrix:
    """Return the gradient matrix (3 m, n) of vertex functions in faces."""
    corners = vertices[faces]
    normals, double = face_normals(vertices, faces), 2.0 * face_areas(vertices, faces)
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    slopes = np.cross(normals[:, None], opposite) / double[:, None, None]
    rows = 3 * np.arange(len(faces))[:, None, None] + np.arange(3)
    columns = np.broadcast_to(faces[:, :, None], slopes.shape)
    return sparse.csr_matrix(
        (slopes.ravel(), (np.broadcast_to(rows, slopes.shape).ravel(), columns.ravel())), shape=(3 * len(faces), len(vertices))
    )
