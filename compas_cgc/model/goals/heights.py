"""Contradictions between goals about heights: admissible ranges per vertex, crown, volume and path length."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete import boundary_vertices
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import Sentence
from ..constraints import Constraint
from ..constraints import Fixed
from ..constraints import Height
from ..constraints import OnPlane
from ..constraints import indices
from ..constraints import unit
from ..problem import CGCProblem
from ..roles import FIXED
from ..tolerances import NEGLIGIBLE
from ..tolerances import UPRIGHT_COSINE
from .binding import bind
from .binding import support_height
from .inequalities import Above
from .inequalities import Below
from .inequalities import Clearance
from .inequalities import NearPlane
from .names import goal_name
from .places import EdgeInPlan
from .places import Level
from .wholes import Length
from .wholes import Rise
from .wholes import Volume

__all__ = ["about", "height_clashes"]

# part of the plan area that boundary edges may cut off at corners of their line; an edge of a tenth of the size at a right angle cuts 0.5
# %
VOLUME_TOLERANCE = 0.02
CONTRADICTION = Sentence("{} and {} contradict each other{}; remove one of them")


class _Range(NamedTuple):
    """Admissible heights of some vertices, and the goal that sets them."""

    vertices: IntArray
    low: float
    high: float
    name: str


class _Heights(NamedTuple):
    """Admissible heights of every vertex under all goals."""

    low: FloatArray  # (n,)
    high: FloatArray  # (n,)
    source_low: IntArray  # (n,) index into `names`, -1 if no goal bounds the height
    source_high: IntArray  # (n,)
    names: list[str]

    def name_of_low(self, vertex: int) -> str:
        return self.names[self.source_low[vertex]]

    def name_of_high(self, vertex: int) -> str:
        return self.names[self.source_high[vertex]]


class _Ends(NamedTuple):
    """A prescribed highest or lowest height of the surface, and the goal that sets it."""

    height: float
    name: str


def height_clashes(problem: CGCProblem) -> Iterator[str]:
    """Return messages for goals without a common height: at a vertex, at the crown or the lowest point, of a volume, along a path."""
    size = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    rounding = NEGLIGIBLE * size
    ranges = list(_ranges(problem))
    heights = _together(problem, ranges)
    crossed = np.flatnonzero(heights.low > heights.high + rounding)
    if len(crossed):
        at = int(crossed[0])
        yield CONTRADICTION.format(heights.name_of_low(at), heights.name_of_high(at), f" at vertex {at}")
        return
    level = list(_level_edges(problem, heights, rounding))
    crown, bottom = _end(problem, 1.0), _end(problem, -1.0)
    ends = [*_of_crown(problem, heights, crown, rounding), *_of_bottom(problem, heights, bottom, rounding)]
    yield from level + ends
    if not level and not ends:
        yield from _volumes(problem, heights, crown, bottom)
        yield from _paths(problem, heights, rounding)


def about(problem: CGCProblem, goal: Constraint) -> IntArray:
    """Return the vertices of the drawing to which a position or inequality goal applies."""
    if isinstance(goal, (Height, OnPlane, Fixed)):
        return indices(goal.vertices, len(problem.vertices))
    return bind(problem.with_goals([goal], add=False)).sides[0].candidates(problem.vertices)


def _ranges(problem: CGCProblem) -> Iterator[_Range]:
    """Return the admissible heights of movable vertices; supports that violate a goal have messages of their own."""
    for goal in problem.goals:
        between = _between(goal)
        if between is None:
            continue
        at = about(problem, goal)
        yield _Range(at[problem.roles[at] != FIXED], *between, _name(goal))
    for goal in problem.goals:
        if isinstance(goal, Fixed):
            for vertex in np.setdiff1d(about(problem, goal), np.flatnonzero(problem.roles == FIXED)).tolist():
                z = float(problem.vertices[vertex, 2])
                yield _Range(np.array([vertex]), z, z, f"the fixed height {z:.4g} of vertex {vertex}")


def _between(goal: Constraint) -> Optional[tuple[float, float]]:
    """Return the lowest and highest height that a goal admits, None if it does not restrict heights."""
    if isinstance(goal, Height):
        return None if isinstance(goal.vertices, str) else (goal.height, goal.height)
    if isinstance(goal, (Above, Clearance)):
        return goal.height, np.inf
    if isinstance(goal, Below):
        return -np.inf, goal.height
    if isinstance(goal, (NearPlane, OnPlane)) and abs(unit(goal.normal, "the normal of a plane")[2]) >= 1.0 - UPRIGHT_COSINE:
        z, near = float(goal.point[2]), goal.distance if isinstance(goal, NearPlane) else 0.0
        return z - near, z + near
    return None


def _name(goal: Constraint) -> str:
    return f"the level plane at {float(goal.point[2]):.6g}" if isinstance(goal, OnPlane) else goal_name(goal)


def _together(problem: CGCProblem, ranges: list[_Range]) -> _Heights:
    n = len(problem.vertices)
    low, high = np.full(n, -np.inf), np.full(n, np.inf)
    source_low, source_high = np.full(n, -1), np.full(n, -1)
    names = [own.name for own in ranges]
    for number, own in enumerate(ranges):
        raised, lowered = own.vertices[own.low > low[own.vertices]], own.vertices[own.high < high[own.vertices]]
        low[raised], source_low[raised] = own.low, number
        high[lowered], source_high[lowered] = own.high, number
    fixed = problem.roles == FIXED
    low[fixed] = high[fixed] = problem.vertices[fixed, 2]
    return _Heights(low, high, source_low, source_high, names)


def _level_edges(problem: CGCProblem, heights: _Heights, rounding: float) -> Iterator[str]:
    """Return messages for contradictory heights along a level edge."""
    for place in bind(problem).places:
        if not isinstance(place, Level):
            continue
        ring = np.asarray(place.vertices, dtype=np.int64)
        floor, ceiling = int(ring[np.argmax(heights.low[ring])]), int(ring[np.argmin(heights.high[ring])])
        if heights.low[floor] > heights.high[ceiling] + rounding:
            one, other = _source(problem, heights.source_low, heights, floor), _source(problem, heights.source_high, heights, ceiling)
            yield CONTRADICTION.format(one, other, f" on {goal_name(place)}, whose vertices have the same height")


def _source(problem: CGCProblem, says: IntArray, heights: _Heights, vertex: int) -> str:
    """Return what sets the height of a vertex: the name of a goal, or its support."""
    if says[vertex] >= 0:
        return heights.names[says[vertex]]
    return f"the height {problem.vertices[vertex, 2]:.4g} of the support at vertex {vertex}"


def _end(problem: CGCProblem, side: float) -> Optional[_Ends]:
    """Return the prescribed height of the crown (side 1) or of the lowest vertex (side -1), None if no goal prescribes it."""
    ends = []
    for goal in problem.goals:
        if isinstance(goal, Rise) and goal.rise * side > 0.0:
            ends.append(_Ends(support_height(problem) + goal.rise, goal_name(goal)))
        elif isinstance(goal, Height) and isinstance(goal.vertices, str) and side > 0.0:
            ends.append(_Ends(goal.height, goal_name(goal)))
    return min(ends, key=lambda end: side * end.height, default=None)


def _of_crown(problem: CGCProblem, heights: _Heights, crown: Optional[_Ends], rounding: float) -> Iterator[str]:
    if crown is None:
        return
    free = problem.roles != FIXED
    low = np.where(free, heights.low, -np.inf)
    top = int(np.argmax(low))
    if low[top] > crown.height + rounding:
        yield CONTRADICTION.format(heights.name_of_low(top), crown.name, "")
    highest = int(np.argmax(heights.high))
    if heights.high[highest] < crown.height - rounding:
        ceiling = int(np.argmax(np.where(free, heights.high, -np.inf)))
        yield CONTRADICTION.format(_source(problem, heights.source_high, heights, ceiling), crown.name, "")
    at = _support(problem, 1.0)
    if at is not None and problem.vertices[at, 2] > crown.height + rounding:
        yield f"{crown.name} lies below the support at vertex {at}, whose height is {problem.vertices[at, 2]:.4g}; increase it"


def _of_bottom(problem: CGCProblem, heights: _Heights, bottom: Optional[_Ends], rounding: float) -> Iterator[str]:
    if bottom is None:
        return
    free = problem.roles != FIXED
    high = np.where(free, heights.high, np.inf)
    under = int(np.argmin(high))
    if high[under] < bottom.height - rounding:
        yield CONTRADICTION.format(heights.name_of_high(under), bottom.name, "")
    lowest = int(np.argmin(heights.low))
    if heights.low[lowest] > bottom.height + rounding:
        floor = int(np.argmin(np.where(free, heights.low, np.inf)))
        yield CONTRADICTION.format(_source(problem, heights.source_low, heights, floor), bottom.name, "")
    at = _support(problem, -1.0)
    if at is not None and problem.vertices[at, 2] < bottom.height - rounding:
        yield f"{bottom.name} lies above the support at vertex {at}, whose height is {problem.vertices[at, 2]:.4g}; lower it"


def _support(problem: CGCProblem, side: float) -> Optional[int]:
    """Return the highest support (side 1) or the lowest (side -1)."""
    fixed = np.flatnonzero(problem.roles == FIXED)
    return int(fixed[np.argmax(side * problem.vertices[fixed, 2])]) if len(fixed) else None


def _volumes(problem: CGCProblem, heights: _Heights, crown: Optional[_Ends], bottom: Optional[_Ends]) -> Iterator[str]:
    """Return messages for volumes too large or too small for the admissible heights, where the plan stays as drawn."""
    plan = _held_plan(problem)
    if plan is None:
        return
    highest, lowest = int(np.argmax(heights.high)), int(np.argmin(heights.low))
    free = problem.roles != FIXED
    for goal in problem.goals:
        if not isinstance(goal, Volume):
            continue
        level = support_height(problem) if goal.level is None else goal.level
        top = _Ends(float(heights.high[highest]), "")
        if crown is not None and crown.height <= top.height:
            top = crown
        most = plan * (top.height - level)
        if goal.volume > most + VOLUME_TOLERANCE * abs(most):
            name = top.name or _source(problem, heights.source_high, heights, int(np.argmax(np.where(free, heights.high, -np.inf))))
            yield CONTRADICTION.format(goal_name(goal), name, f": that height allows at most {max(most, 0.0):.4g}")
        floor = _Ends(float(heights.low[lowest]), "")
        if bottom is not None and bottom.height >= floor.height:
            floor = bottom
        least = plan * (floor.height - level)
        if goal.volume < least - VOLUME_TOLERANCE * abs(least):
            name = floor.name or _source(problem, heights.source_low, heights, int(np.argmin(np.where(free, heights.low, np.inf))))
            yield CONTRADICTION.format(goal_name(goal), name, f": that height needs at least {least:.4g}")


def _held_plan(problem: CGCProblem) -> Optional[float]:
    """Return the plan area if supports or goals keep the whole boundary over its drawn line, else None."""
    faces = problem.faces[problem.real_faces]
    held = problem.roles == FIXED
    for goal in problem.goals:
        if isinstance(goal, (EdgeInPlan, Level)) and goal.points is None:
            held = held | np.isin(np.arange(len(held)), _named(problem, goal))
    if not held[boundary_vertices(problem.vertices, faces)].all():
        return None
    a, b, c = (problem.vertices[faces[:, k], :2] for k in range(3))
    u, v = b - a, c - a
    return 0.5 * abs(float((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()))


def _named(problem: CGCProblem, goal: Constraint) -> IntArray:
    places = bind(problem.with_goals([goal], add=False)).places
    return np.concatenate([np.asarray(place.vertices, dtype=np.int64) for place in places]) if places else np.zeros(0, np.int64)


def _paths(problem: CGCProblem, heights: _Heights, rounding: float) -> Iterator[str]:
    """Return messages for paths that are shorter than the height differences along them."""
    for goal in problem.goals:
        if not isinstance(goal, Length):
            continue
        path = np.asarray(goal.vertices, dtype=np.int64)
        known = path[heights.low[path] >= heights.high[path] - rounding]
        climbs = np.abs(np.diff(heights.low[known]))
        if len(climbs) and goal.length < climbs.sum() - rounding:
            worst = int(np.argmax(climbs))
            ends = (known[worst], known[worst + 1])
            said = next((heights.names[heights.source_low[end]] for end in ends if heights.source_low[end] >= 0), "its supports")
            yield CONTRADICTION.format(goal_name(goal), said, f": its height differences add up to {climbs.sum():.4g}")
