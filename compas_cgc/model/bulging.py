"""Supports that contradict K > 0: the surface bulges to one side, but the supports require both sides."""

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
from ..errors import Remedy
from ..errors import Sentence
from ..meshing import boundary_loops
from .goals.places import EdgeInPlan
from .problem import CGCProblem
from .roles import FIXED
from .tolerances import DRAWING_ACCURACY

__all__ = ["two_sided_supports"]

# supports of a region beyond which collinear ones only are checked; the number of triples grows with the third power
MAX_SUPPORTS_TRIPLES = 14
MAX_SUPPORTS_PAIRS = 60  # supports of a region beyond which none are checked; 1,770 pairs
# smallest barycentric coordinate of a point inside a triangle; points nearer to its sides are on them within drawing accuracy
MIN_BARYCENTRIC = 1e-3
STRAIGHT_COSINE = 1e-14  # 1 - cosine of the turn between edges of a straight side; 45 rounding errors, a turn of 1.4e-7
SAMPLES = 8  # segments of a line that is tested for lying in the region; leaves gaps narrower than an eighth of it undetected


class _Between(NamedTuple):
    """A support that lies between other supports of its region in plan."""

    vertex: int
    others: tuple[int, ...]
    over: float  # height over the straight line or plane through the others [L]
    along: bool = False  # whether that line runs along the edge of the region


def two_sided_supports(problem: CGCProblem, over_lines: bool = False) -> list[str]:
    """Return a sentence for every region of K > 0 whose supports would need it to bulge to both sides.

    Such a surface is the graph of a function that is either convex or concave over every straight line in the plan of its
    region. A support between two or three others in plan decides which: a dome if it lies higher than they do, a bowl if it
    lies lower. If it lies level with them, neither is possible.

    Parameters
    ----------
    problem
        The problem.
    over_lines
        Whether free edges stay over their drawn lines, and a surface has to be smooth up to them. Default: only where a goal says so
        do they stay there, and a surface may be singular at straight edges.
    """
    label = problem.regions()
    fixed = (problem.roles == FIXED)[problem.faces]
    pairs = np.unique(np.column_stack([np.broadcast_to(label[:, None], fixed.shape)[fixed], problem.faces[fixed]]), axis=0)
    regions = np.flatnonzero(np.bincount(pairs[:, 0]) >= 3)
    return [sentence for region in regions.tolist() for sentence in _of_region(problem, region, over_lines)]


def _of_region(problem: CGCProblem, region: int, over_lines: bool) -> Iterator[str]:
    V, F = problem.vertices, problem.faces[problem.regions() == region]
    own = problem.region_vertices(region)
    asked, supports = problem.asked & own, np.flatnonzero((problem.roles == FIXED) & own)
    if not asked.any() or not (problem.types[asked] > 0).all() or not 3 <= len(supports) <= MAX_SUPPORTS_PAIRS:
        return
    plan = V[:, :2]
    crosses = _crosses(plan[F])
    if not ((crosses > 0).all() or (crosses < 0).all()):
        return
    size = float(np.linalg.norm(np.ptp(V, axis=0)))
    over: Optional[_Between] = None
    under: Optional[_Between] = None
    level: list[_Between] = []
    for found in _between(problem, F, supports, size, over_lines):
        if abs(found.over) <= DRAWING_ACCURACY * size:
            if over_lines or not found.along:
                level.append(found)
        elif found.over > 0:
            # The advice has to hold for all lines over which the same support lies: keep its largest height.
            over = found if over is None or (found.vertex == over.vertex and found.over > over.over) else over
        else:
            under = found if under is None or (found.vertex == under.vertex and found.over < under.over) else under
    names = problem.names.vertices
    walls = _of_walls(problem) if level else set()
    level = [found for found in level if not (found.along and found.vertex in walls)]
    if level:
        height = float(problem.vertices[level[0].vertex, 2])
        text = (
            f"region {region} has K > 0, but its support at vertex {names[level[0].vertex]} lies on the straight line or plane through the "
            f"supports at vertices {_named(problem, level[0])}, and a smooth surface of K > 0 is never straight; raise it above "
            f"z = {height:.4g}, or draw a crease through it"
        )
        alone = {found.vertex for found in level} - walls
        yield Sentence(text, [Remedy("release", sorted(int(names[vertex]) for vertex in alone))] if alone else [])
    elif over is not None and under is not None:
        highest, lowest = (float(problem.vertices[found.vertex, 2]) - found.over for found in (over, under))
        yield (
            f"region {region} has K > 0 and so bulges to one side only, but its support at vertex {names[over.vertex]} lies "
            f"{over.over:.3g} above those at vertices {_named(problem, over)} (a dome), and its support at vertex {names[under.vertex]} "
            f"{-under.over:.3g} below those at vertices {_named(problem, under)} (a bowl); raise the second above z = "
            f"{lowest:.4g}, lower the first below z = {highest:.4g}, or draw a crease through one of them"
        )


def _of_walls(problem: CGCProblem) -> set[int]:
    """Return the supports beside other supports along the rim."""
    held = problem.roles == FIXED
    loops = boundary_loops(problem.faces)
    return {vertex for loop in loops for vertex in loop[held[loop] & (held[np.roll(loop, 1)] | held[np.roll(loop, -1)])].tolist()}


def _named(problem: CGCProblem, found: _Between) -> str:
    names = [str(problem.names.vertices[other]) for other in found.others]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _between(problem: CGCProblem, F: IntArray, supports: IntArray, size: float, over_lines: bool) -> Iterator[_Between]:
    """Return the supports that lie between others in plan, where the line or triangle of the others lies in the region."""
    plan, z = problem.vertices[:, :2], problem.vertices[:, 2]
    held = over_lines or any(isinstance(own, EdgeInPlan) for own in problem.goals)
    rim = boundary_vertices(problem.vertices, problem.faces)
    pairs, shares = _pairs_around(plan, supports, size)
    sides = _straight_sides(plan, F)
    beside = np.asarray((sides[pairs[:, 0]] & sides[pairs[:, 1]]).any(axis=1))
    # A free edge may move away from its line in plan unless a goal keeps it there.
    free = beside & rim[pairs].all(axis=1) & (rim[supports] | np.isnan(shares)).all(axis=1)
    kept = np.flatnonzero(~free | held)
    for (a, b), share, side in zip(pairs[kept].tolist(), shares[kept], beside[kept].tolist()):
        on = np.isfinite(share)
        if not side and not _inside(plan, F, plan[a] + np.linspace(0.0, 1.0, SAMPLES + 1)[:, None] * (plan[b] - plan[a]), size):
            continue
        along = side or _along_rim(plan, F, plan[a], plan[b], size)
        for c, t in zip(supports[on].tolist(), share[on]):
            if held or not (along and rim[[a, b, c]].all()):
                yield _Between(c, (a, b), float(z[c] - (1.0 - t) * z[a] - t * z[b]), along)
    # What lies in a triangle with a corner within a straight wall lies in one with a corner at an end of the wall, too.
    supports = np.setdiff1d(supports, _within_walls(problem, F, size))
    if len(supports) > MAX_SUPPORTS_TRIPLES:
        return
    grid = np.array([(i, j, SAMPLES - i - j) for i in range(SAMPLES + 1) for j in range(SAMPLES + 1 - i)]) / SAMPLES
    for three in combinations(supports.tolist(), 3):
        corners = plan[list(three)]
        twice = float(_crosses(corners[None])[0])
        others = np.setdiff1d(supports, three)
        if abs(twice) <= DRAWING_ACCURACY * size**2 or not len(others):
            continue
        shares = np.column_stack([_crosses(np.stack([_put(corners, k, point) for point in plan[others]])) / twice for k in range(3)])
        on = (shares > MIN_BARYCENTRIC).all(axis=1)
        if on.any() and _inside(plan, F, grid @ corners, size):
            for c, own in zip(others[on].tolist(), shares[on]):
                yield _Between(c, three, float(z[c] - own @ z[list(three)]))


@remembered
def _pairs_around(plan: FloatArray, supports: IntArray, size: float) -> tuple[IntArray, FloatArray]:
    """Return pairs of supports with others between them (p, 2), and the relative positions of these (p, k), NaN off the line."""
    places = plan[supports]
    first, second = np.triu_indices(len(supports), 1)
    along = places[second] - places[first]
    square = np.einsum("ij,ij->i", along, along)
    apart = square > 0.0
    first, second, along, square = first[apart], second[apart], along[apart], square[apart]
    away = places[None] - places[first][:, None]
    share = np.einsum("pki,pi->pk", away, along) / square[:, None]
    off = np.abs(away[..., 0] * along[:, 1:] - away[..., 1] * along[:, :1]) / np.sqrt(square)[:, None]
    share[~((off <= DRAWING_ACCURACY * size) & (share > MIN_BARYCENTRIC) & (share < 1.0 - MIN_BARYCENTRIC))] = np.nan
    some = np.isfinite(share).any(axis=1)
    return np.column_stack([supports[first], supports[second]])[some], share[some]


@remembered
def _straight_sides(plan: FloatArray, F: IntArray) -> Mask:
    """Return which vertices lie on each straight side of the outline of the faces in plan (n, s)."""
    on: list[IntArray] = []
    for loop in boundary_loops(F):
        ahead = unit_vectors(plan[np.roll(loop, -1)] - plan[loop])
        corners = np.flatnonzero(np.einsum("ij,ij->i", ahead, np.roll(ahead, 1, axis=0)) < 1.0 - STRAIGHT_COSINE)
        for begin, end in zip(corners, np.roll(corners, -1)):
            on.append(np.take(loop, np.arange(begin, end + 1 if end > begin else end + len(loop) + 1), mode="wrap"))
    sides = np.zeros((len(plan), len(on)), bool)
    for k, side in enumerate(on):
        sides[side, k] = True
    return sides


def _within_walls(problem: CGCProblem, F: IntArray, size: float) -> IntArray:
    """Return the supports on the straight line between the supports before and behind them along the rim of the faces."""
    V, held, found = problem.vertices, problem.roles == FIXED, []
    for loop in boundary_loops(F):
        before, behind = np.roll(loop, 1), np.roll(loop, -1)
        chord = unit_vectors(V[behind] - V[before])
        off = np.linalg.norm(np.cross(V[loop] - V[before], chord), axis=1)
        found.append(loop[held[loop] & held[before] & held[behind] & (off <= DRAWING_ACCURACY * size)])
    return np.concatenate(found)


def _put(corners: FloatArray, k: int, point: FloatArray) -> FloatArray:
    changed = corners.copy()
    changed[k] = point
    return changed


def _crosses(corners: FloatArray) -> FloatArray:
    """Return twice the signed areas of triangles in plan (m, 3, 2)."""
    return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _along_rim(plan: FloatArray, F: IntArray, a: FloatArray, b: FloatArray, size: float) -> bool:
    """Check whether a line within the region runs along its edge."""
    across = np.array([a[1] - b[1], b[0] - a[0]]) / np.linalg.norm(b - a)
    middle = a + np.linspace(0.0, 1.0, SAMPLES + 1)[1:-1, None] * (b - a)
    step = 1e-3 * size
    return not (_inside(plan, F, middle + step * across, size) and _inside(plan, F, middle - step * across, size))


def _inside(plan: FloatArray, F: IntArray, points: FloatArray, size: float) -> bool:
    """Check whether all points (p, 2) lie on faces."""
    corners = plan[F]
    twice = _crosses(corners)
    slack = DRAWING_ACCURACY * size * np.sqrt(np.abs(twice))
    inside = np.ones((len(points), len(F)), bool)
    for k in range(3):
        one, other = corners[:, k], corners[:, (k + 1) % 3]
        side = other - one
        away = points[:, None, :] - one[None]
        inside &= np.sign(twice) * (side[:, 0] * away[..., 1] - side[:, 1] * away[..., 0]) >= -slack
    return bool(inside.any(axis=1).all())
