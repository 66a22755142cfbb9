"""Branch points of saddles: singularities of the asymptotic directions, where K = 0 whatever the target."""

from __future__ import annotations

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import TINY
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.local_fits import LocalFits
from ..meshing.boundary import boundary_loops
from .problem import CGCProblem
from .roles import FIXED

__all__ = ["DEEP", "branch_points", "depth"]

# distance from supports, free edges and creases beyond which a fit has neighbours on all sides [edges]; one more than the two rings of
# the fit
DEEP = 3
# ratio of the fitted K to a target K̄ < 0, below which a vertex is a flat spot; K is 0 at a branch point, and half of K̄ beside it
FLAT_RATIO = 0.5
LEVEL_RATIO = 0.05  # height of a support over the mean plane relative to the largest, below which it is level; a twentieth makes no valley


def branch_points(problem: CGCProblem, fits: LocalFits) -> IntArray:
    """Return the vertices of faces that carry more branch points than the supports require (k,).

    On a smooth surface with K < 0 the principal directions have no singularities. A mesh whose angle defects meet their targets
    may still have some: three or more valleys meet there, as at the centre of a monkey saddle, and every smooth surface through
    its vertices has K = 0 there. Around such a face the directions make half a turn (the index of a line field, Hopf), which is
    computed from the second fundamental forms at the corners. Supports that go up and down n times along a closed boundary
    require n - 2 branch points.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets, without dummies.
    fits
        Local fits at its vertices.

    Returns
    -------
    (k,) int
        Empty where the surface has holes, creases, goals, columns or K >= 0: the required number is unknown there.
    """
    nothing = np.zeros(0, np.int64)
    asked = problem.asked
    if not asked.any() or not (problem.types[asked] < 0).all() or len(problem.creases) or problem.goals:
        return nothing
    known = (depth(problem) > 1) & asked & np.isfinite(fits.bending[:, 0])
    faces = problem.faces[known[problem.faces].all(axis=1)]
    turns = _turns(problem.vertices, faces, fits.bending)
    # Noise adds pairs of opposite indices, which cancel in the sum.
    count = -int(turns.sum())
    if count <= 0:
        return nothing
    with np.errstate(invalid="ignore"):
        found = faces[(turns < 0) & (fits.gaussian > FLAT_RATIO * problem.targets)[faces].any(axis=1)]
    loops = boundary_loops(problem.faces)
    if len(loops) != 1 or ((problem.roles == FIXED) & ~np.isin(np.arange(len(asked)), loops[0])).any():
        return nothing
    needed = max(0, _waves(problem, loops[0]) - 2)
    return np.unique(found) if min(count, len(found)) > needed else nothing


def depth(problem: CGCProblem) -> IntArray:
    """Return the number of edges to the nearest vertex without a target, at most DEEP (n,)."""
    found = np.where(problem.asked, DEEP, 0)
    for ring in range(1, DEEP):
        beside = problem.faces[(found[problem.faces] < ring).any(axis=1)]
        found[beside] = np.minimum(found[beside], ring)
    return found


def _turns(V: FloatArray, faces: IntArray, bending: FloatArray) -> IntArray:
    """Return the number of half turns of the principal directions around each face (m,)."""
    normals = face_normals(V, faces)
    first = V[faces[:, 1]] - V[faces[:, 0]]
    first = first / np.maximum(np.linalg.norm(first, axis=1), TINY)[:, None]
    second: FloatArray = np.asarray(np.cross(normals, first), dtype=np.float64)
    # The two entries of the traceless form in the plane of the face turn twice as fast as the directions.
    corners = bending[faces]
    along = _as_tensors(first, first) - _as_tensors(second, second)
    x, y = 0.5 * np.einsum("mct,mt->mc", corners, along), np.einsum("mct,mt->mc", corners, _as_tensors(first, second))
    u, v = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    turned = np.arctan2(x * v - y * u, x * u + y * v).sum(axis=1)
    return np.asarray(np.rint(turned / (2.0 * np.pi)), dtype=np.int64)


def _as_tensors(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return rows (k, 6) whose products with tensors as in :class:`LocalFits` evaluate the forms at two vectors (k, 3)."""
    return np.column_stack([*(a * b).T, *((a[:, i] * b[:, j] + a[:, j] * b[:, i]) / np.sqrt(2.0) for i, j in ((1, 2), (2, 0), (0, 1)))])


def _waves(problem: CGCProblem, loop: IntArray) -> int:
    """Return how often the supports on a closed boundary go up and down about their mean plane; level groups count as alternating."""
    V = problem.vertices
    held = problem.roles[loop] == FIXED
    at = V[loop[held]]
    middle = at - at.mean(axis=0)
    ends = V[loop]
    up = np.cross(ends, np.roll(ends, -1, axis=0)).sum(axis=0)
    up = up / max(float(np.linalg.norm(up)), TINY)
    plan = middle - np.outer(middle @ up, up)
    heights = middle @ up - plan @ np.linalg.lstsq(plan, middle @ up, rcond=None)[0]
    most, size = float(np.abs(heights).max(initial=0.0)), float(np.abs(middle).max(initial=0.0))
    groups = int(np.count_nonzero(held & ~np.roll(held, 1)))
    if most <= 1e-6 * size:
        return groups // 2
    sides = np.sign(heights[np.abs(heights) > LEVEL_RATIO * most])
    return int(np.count_nonzero(sides != np.roll(sides, 1))) // 2
