"""Branch points of saddles: places where K = 0 whatever is asked, and the asymptotic directions turn around them."""

from __future__ import annotations

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.local_fits import LocalFits
from ..meshing.boundary import boundary_loops
from .problem import CGCProblem
from .roles import FIXED

__all__ = ["DEEP", "branch_points", "depth"]

DEEP = 3  # edges from supports, free edges and creases from where fits look all ways
FLAT = 0.5  # K of fits, against the target, above which a saddle has none there
LEVEL = 0.05  # height of a support over the plane through all, against the largest, that goes neither up nor down


def branch_points(problem: CGCProblem, fits: LocalFits) -> IntArray:
    """Return the vertices of faces around which the principal directions turn more than the supports need (k,).

    Where K < 0 both principal curvatures keep their signs, so that their directions are without singularities. A surface that
    meets its angle defects may have some all the same: there three valleys or more meet, as in the middle of a monkey saddle,
    and any smooth surface through its vertices has K = 0. Each turns the directions by half a turn around one face, which is counted
    off the second fundamental forms at its corners (the index of a line field, Hopf). Supports that go up and down n times along
    an edge all round ask for n - 2 of these.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets, without dummies.
    fits
        Of its vertices.

    Returns
    -------
    (k,) int
        None where the surface has holes, creases, goals, columns, or K >= 0 somewhere, as it is not known there how many are needed.
    """
    nothing = np.zeros(0, np.int64)
    asked = problem.asked
    if not asked.any() or not (problem.targets[asked] < 0.0).all() or len(problem.creases) or problem.constraints:
        return nothing
    known = (depth(problem) > 1) & asked & np.isfinite(fits.bending[:, 0])
    faces = problem.faces[known[problem.faces].all(axis=1)]
    turns = _turns(problem.vertices, faces, fits.bending)
    # What noise turns one way it turns back beside it.
    count = -int(turns.sum())
    if count <= 0:
        return nothing
    with np.errstate(invalid="ignore"):
        found = faces[(turns < 0) & (fits.gaussian > FLAT * problem.targets)[faces].any(axis=1)]
    loops = boundary_loops(problem.faces)
    if len(loops) != 1 or ((problem.roles == FIXED) & ~np.isin(np.arange(len(asked)), loops[0])).any():
        return nothing
    needed = max(0, _waves(problem, loops[0]) - 2)
    return np.unique(found) if min(count, len(found)) > needed else nothing


def depth(problem: CGCProblem) -> IntArray:
    """Return how many edges vertices are away from the next one where no K is asked, DEEP where that or more (n,)."""
    found = np.where(problem.asked, DEEP, 0)
    for ring in range(1, DEEP):
        beside = problem.faces[(found[problem.faces] < ring).any(axis=1)]
        found[beside] = np.minimum(found[beside], ring)
    return found


def _turns(V: FloatArray, faces: IntArray, bending: FloatArray) -> IntArray:
    """Return the half turns that the principal directions take around faces (m,)."""
    normals = face_normals(V, faces)
    first = V[faces[:, 1]] - V[faces[:, 0]]
    first = first / np.maximum(np.linalg.norm(first, axis=1), np.finfo(float).tiny)[:, None]
    second: FloatArray = np.asarray(np.cross(normals, first), dtype=np.float64)
    # The form without its trace, in the plane of the face: its two entries turn twice as fast as the directions.
    corners = bending[faces]
    along = _as_tensors(first, first) - _as_tensors(second, second)
    x, y = 0.5 * np.einsum("mct,mt->mc", corners, along), np.einsum("mct,mt->mc", corners, _as_tensors(first, second))
    u, v = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    turned = np.arctan2(x * v - y * u, x * u + y * v).sum(axis=1)
    return np.asarray(np.rint(turned / (2.0 * np.pi)), dtype=np.int64)


def _as_tensors(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return what products with tensors (k, 6) as in :class:`LocalFits` make the forms of two vectors (k, 3)."""
    return np.column_stack([*(a * b).T, *((a[:, i] * b[:, j] + a[:, j] * b[:, i]) / np.sqrt(2.0) for i, j in ((1, 2), (2, 0), (0, 1)))])


def _waves(problem: CGCProblem, loop: IntArray) -> int:
    """Return how many times the supports on an edge all round go up and down over the plane through them; level ones may do so in turns."""
    V = problem.vertices
    held = problem.roles[loop] == FIXED
    at = V[loop[held]]
    middle = at - at.mean(axis=0)
    ends = V[loop]
    up = np.cross(ends, np.roll(ends, -1, axis=0)).sum(axis=0)
    up = up / max(float(np.linalg.norm(up)), np.finfo(float).tiny)
    plan = middle - np.outer(middle @ up, up)
    heights = middle @ up - plan @ np.linalg.lstsq(plan, middle @ up, rcond=None)[0]
    most, size = float(np.abs(heights).max(initial=0.0)), float(np.abs(middle).max(initial=0.0))
    groups = int(np.count_nonzero(held & ~np.roll(held, 1)))
    if most <= 1e-6 * size:
        return groups // 2
    sides = np.sign(heights[np.abs(heights) > LEVEL * most])
    return int(np.count_nonzero(sides != np.roll(sides, 1))) // 2
