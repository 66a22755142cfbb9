"""Supports that a region of K > 0 cannot pass through: it bulges to one side, and they ask it for both."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete._memo import remembered
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.normals import unit_vectors
from ..discrete.plan import cross
from ..meshing import boundary_loops
from .goals.places import EdgeInPlan
from .problem import CGCProblem
from .roles import FIXED

__all__ = ["two_sided_supports"]

MOST = 14  # supports of a region, of which all threes are looked at; of more only those on one line
LINED = 60  # supports of a region, of which all pairs are
NEAR = 1e-6  # distance from a line, against the size of the mesh, that is none
LEVEL = 1e-6  # height, likewise
WITHIN = 1e-3  # least share of a corner in a point within a triangle
STRAIGHT = 1e-14  # 1 - cosine of the turn between edges of a straight side
PARTS = 8  # that lines and sides are cut into to see whether they lie in the region


class _Between(NamedTuple):
    """A support that lies in plan between others of its region."""

    vertex: int
    others: tuple[int, ...]
    over: float  # how high over the straight way between them [L]
    along: bool = False  # whether that runs along the edge of the region


def two_sided_supports(problem: CGCProblem) -> list[str]:
    """Return a sentence for every region of K > 0 whose supports no surface that bulges to one side passes through.

    In plan such a surface is the graph of a function that is convex or concave over every straight line in its region. A
    support in plan between two others, or three, says which: the surface is a dome where it lies higher than they, a bowl
    where it lies lower, and neither where it lies level with them.
    """
    return [said for region in range(int(problem.regions().max(initial=-1)) + 1) for said in _of_region(problem, region)]


def _of_region(problem: CGCProblem, region: int) -> Iterator[str]:
    V, F = problem.vertices, problem.faces[problem.regions() == region]
    own = problem.region_vertices(region)
    asked, supports = problem.asked & own, np.flatnonzero((problem.roles == FIXED) & own)
    if not asked.any() or not (problem.targets[asked] > 0).all() or not 3 <= len(supports) <= LINED:
        return
    plan = V[:, :2]
    crosses = _crosses(plan[F])
    if not ((crosses > 0).all() or (crosses < 0).all()):
        return
    size = float(np.linalg.norm(np.ptp(V, axis=0)))
    over: Optional[_Between] = None
    under: Optional[_Between] = None
    for found in _between(problem, F, supports, size):
        if abs(found.over) <= LEVEL * size:
            if not found.along:
                at, others = problem.names.vertices[found.vertex], _named(problem, found)
                height = float(problem.vertices[found.vertex, 2])
                yield (
                    f"the region {region} has K > 0, but its support at vertex {at} lies level between those at {others}, and a smooth "
                    f"surface of K > 0 is never straight; raise it over {height:.4g}, or lead a crease through it"
                )
                return
        elif found.over > 0:
            # Of what one support lies over it has to come under all of it, and over all of what it lies under.
            over = found if over is None or (found.vertex == over.vertex and found.over > over.over) else over
        else:
            under = found if under is None or (found.vertex == under.vertex and found.over < under.over) else under
    if over is not None and under is not None:
        names = problem.names.vertices
        highest, lowest = (float(problem.vertices[found.vertex, 2]) - found.over for found in (over, under))
        yield (
            f"the region {region} has K > 0 and so bulges to one side, but its support at vertex {names[over.vertex]} lies "
            f"{over.over:.3g} over those at {_named(problem, over)}, as of a dome, and that at {names[under.vertex]} "
            f"{-under.over:.3g} under those at {_named(problem, under)}, as of a bowl; raise the second over "
            f"{lowest:.4g} or lower the first under {highest:.4g}, or lead a crease through it"
        )


def _named(problem: CGCProblem, found: _Between) -> str:
    names = [str(problem.names.vertices[other]) for other in found.others]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _between(problem: CGCProblem, F: IntArray, supports: IntArray, size: float) -> Iterator[_Between]:
    """Return the supports that lie in plan within straight lines and triangles of others that lie in the region."""
    plan, z = problem.vertices[:, :2], problem.vertices[:, 2]
    held = any(isinstance(own, EdgeInPlan) for own in problem.constraints)
    rim = boundary_vertices(problem.vertices, problem.faces)
    pairs, shares = _pairs_around(plan, supports, size)
    sides = _straight_sides(plan, F)
    beside = np.asarray((sides[pairs[:, 0]] & sides[pairs[:, 1]]).any(axis=1))
    # A free edge that nothing keeps over its line need not stay there.
    free = beside & rim[pairs].all(axis=1) & (rim[supports] | np.isnan(shares)).all(axis=1)
    kept = np.flatnonzero(~free | held)
    for (a, b), share, side in zip(pairs[kept].tolist(), shares[kept], beside[kept].tolist()):
        on = np.isfinite(share)
        if not side and not _inside(plan, F, plan[a] + np.linspace(0.0, 1.0, PARTS + 1)[:, None] * (plan[b] - plan[a]), size):
            continue
        along = side or _along_rim(plan, F, plan[a], plan[b], size)
        for c, t in zip(supports[on].tolist(), share[on]):
            if held or not (along and rim[[a, b, c]].all()):
                yield _Between(c, (a, b), float(z[c] - (1.0 - t) * z[a] - t * z[b]), along)
    if len(supports) > MOST:
        return
    grid = np.array([(i, j, PARTS - i - j) for i in range(PARTS + 1) for j in range(PARTS + 1 - i)]) / PARTS
    for three in combinations(supports.tolist(), 3):
        corners = plan[list(three)]
        twice = float(_crosses(corners[None])[0])
        others = np.setdiff1d(supports, three)
        if abs(twice) <= NEAR * size**2 or not len(others):
            continue
        shares = np.column_stack([_crosses(np.stack([_put(corners, k, point) for point in plan[others]])) / twice for k in range(3)])
        on = (shares > WITHIN).all(axis=1)
        if on.any() and _inside(plan, F, grid @ corners, size):
            for c, own in zip(others[on].tolist(), shares[on]):
                yield _Between(c, three, float(z[c] - own @ z[list(three)]))


@remembered
def _pairs_around(plan: FloatArray, supports: IntArray, size: float) -> tuple[IntArray, FloatArray]:
    """Return pairs of supports that others lie between (p, 2), and how far along the way of each pair (p, k), NaN where beside it."""
    places = plan[supports]
    first, second = np.triu_indices(len(supports), 1)
    along = places[second] - places[first]
    square = np.einsum("ij,ij->i", along, along)
    apart = square > 0.0
    first, second, along, square = first[apart], second[apart], along[apart], square[apart]
    away = places[None] - places[first][:, None]
    share = np.einsum("pki,pi->pk", away, along) / square[:, None]
    off = np.abs(away[..., 0] * along[:, 1:] - away[..., 1] * along[:, :1]) / np.sqrt(square)[:, None]
    share[~((off <= NEAR * size) & (share > WITHIN) & (share < 1.0 - WITHIN))] = np.nan
    some = np.isfinite(share).any(axis=1)
    return np.column_stack([supports[first], supports[second]])[some], share[some]


@remembered
def _straight_sides(plan: FloatArray, F: IntArray) -> Mask:
    """Return which vertices lie on which straight sides of the edge of some faces in plan (n, s)."""
    on: list[IntArray] = []
    for loop in boundary_loops(F):
        ahead = unit_vectors(plan[np.roll(loop, -1)] - plan[loop])
        corners = np.flatnonzero(np.einsum("ij,ij->i", ahead, np.roll(ahead, 1, axis=0)) < 1.0 - STRAIGHT)
        for begin, end in zip(corners, np.roll(corners, -1)):
            on.append(np.take(loop, np.arange(begin, end + 1 if end > begin else end + len(loop) + 1), mode="wrap"))
    sides = np.zeros((len(plan), len(on)), bool)
    for k, side in enumerate(on):
        sides[side, k] = True
    return sides


def _put(corners: FloatArray, k: int, point: FloatArray) -> FloatArray:
    changed = corners.copy()
    changed[k] = point
    return changed


def _crosses(corners: FloatArray) -> FloatArray:
    """Return twice the signed areas of triangles in plan (m, 3, 2)."""
    return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _along_rim(plan: FloatArray, F: IntArray, a: FloatArray, b: FloatArray, size: float) -> bool:
    """Return whether a line within the region runs along its edge."""
    across = np.array([a[1] - b[1], b[0] - a[0]]) / np.linalg.norm(b - a)
    middle = a + np.linspace(0.0, 1.0, PARTS + 1)[1:-1, None] * (b - a)
    step = 1e-3 * size
    return not (_inside(plan, F, middle + step * across, size) and _inside(plan, F, middle - step * across, size))


def _inside(plan: FloatArray, F: IntArray, points: FloatArray, size: float) -> bool:
    """Return whether points (p, 2) all lie on faces."""
    corners = plan[F]
    twice = _crosses(corners)
    slack = NEAR * size * np.sqrt(np.abs(twice))
    inside = np.ones((len(points), len(F)), bool)
    for k in range(3):
        one, other = corners[:, k], corners[:, (k + 1) % 3]
        side = other - one
        away = points[:, None, :] - one[None]
        inside &= np.sign(twice) * (side[:, 0] * away[..., 1] - side[:, 1] * away[..., 0]) >= -slack
    return bool(inside.any(axis=1).all())
