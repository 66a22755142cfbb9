"""Goals that cannot be met together, or at all, told before a solve."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...discrete import boundary_vertices
from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ..constraints import AtHeight
from ..constraints import Constraint
from ..problem import CGCProblem
from ..roles import FIXED
from .binding import bind
from .binding import support_height
from .binding import unknown_regions
from .heights import about
from .heights import height_clashes
from .inequalities import Above
from .inequalities import Below
from .inequalities import Clearance
from .inequalities import NearPlane
from .inequalities import Within
from .names import goal_name
from .places import EdgeInPlan
from .places import Level
from .plans import plan_clashes
from .wholes import Area
from .wholes import Length
from .wholes import Rise
from .wholes import Unknown
from .wholes import Volume

__all__ = ["goal_problems", "refuse_impossible"]

LARGE = 50.0  # length, against the size of the mesh, that must be in other units
SLIGHT = 5e-4  # rise, against the size of the mesh, that must be in other units
SAME = 1e-9  # difference, against the size of the mesh, that is none


def refuse_impossible(problem: CGCProblem) -> None:
    """Refuse goals that contradict each other or the drawing.

    Raises
    ------
    ProblemError
        With a sentence for each that names the goals and the mend.
    """
    found = goal_problems(problem)
    if found:
        raise ProblemError(found)


def goal_problems(problem: CGCProblem) -> list[str]:
    """Return what keeps goals from being met: a sentence for each that names the goals and the mend."""
    if not problem.constraints:
        return []
    try:
        unknown_regions(problem)
        found = [*_empty(problem), *_out_of_scale(problem)]
        if found:
            return found
        bind(problem)
        apart = list(plan_clashes(problem)) or height_clashes(problem)
        found = [*_pairs(problem), *_held(problem), *apart, *_too_small(problem)]
    except ProblemError as error:
        return error.problems
    return list(dict.fromkeys(found))


def _empty(problem: CGCProblem) -> Iterator[str]:
    """Tell goals that are about nothing."""
    count = int(problem.regions()[problem.real_faces].max(initial=-1)) + 1
    for goal in problem.constraints:
        if isinstance(goal, Unknown) and not isinstance(goal.regions, str) and not len(goal.regions):
            yield f"{goal_name(goal)} names no region; name regions from 0 to {count - 1}, or 'all', or leave it out"
        elif isinstance(goal, Clearance):
            where = goal.where
            if isinstance(where, (int, np.integer)):
                if not 0 <= where < count:
                    yield f"{goal_name(goal)} is over region {where}, but the mesh has {count}; name one from 0 to {count - 1}"
            elif not len(bind(_only(problem, goal)).sides[0].candidates(problem.vertices)):
                yield f"{goal_name(goal)} is over a place where the mesh has nothing; move the place under the mesh, in the drawing's units"
        elif isinstance(goal, (Above, Below, NearPlane, EdgeInPlan, Level, AtHeight)) and not isinstance(goal.vertices, str):
            if not len(goal.vertices):
                yield f"{goal_name(goal)} names no vertices; name some, or leave it out"
            elif isinstance(goal, EdgeInPlan) and goal.points is None and len(set(goal.vertices)) < 2:
                yield f"{goal_name(goal)} names one vertex, which is no edge; name the vertices along an edge in their order, or 'free'"


def _only(problem: CGCProblem, goal: Constraint) -> CGCProblem:
    return problem.with_constraints([goal], add=False)


def _size(problem: CGCProblem) -> float:
    return float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))


def _out_of_scale(problem: CGCProblem) -> Iterator[str]:
    """Tell numbers in other units than those of the drawing."""
    size, middle = _size(problem), float(problem.vertices[:, 2].mean())
    mend = "give it in the units of the drawing"
    for goal in problem.constraints:
        far = _reach(goal, middle)
        if far > LARGE * size:
            yield f"{goal_name(goal)} is far larger than the mesh, whose size is {size:.4g}; {mend}"
        elif isinstance(goal, Rise) and far < SLIGHT * size:
            yield f"{goal_name(goal)} is nothing beside the size of the mesh, {size:.4g}; {mend}"


def _reach(goal: Constraint, middle: float) -> float:
    """Return the length that a goal speaks of, from a middle height on, zero where it speaks of none [L]."""
    if isinstance(goal, Rise):
        return abs(goal.rise)
    if isinstance(goal, AtHeight):
        return abs(goal.height - middle)
    if isinstance(goal, (Above, Clearance)):
        return goal.height - middle
    if isinstance(goal, Below):
        return middle - goal.height
    if isinstance(goal, Volume):
        return goal.volume ** (1 / 3)
    if isinstance(goal, Area):
        return goal.area**0.5
    return goal.length if isinstance(goal, Length) else 0.0


def _pairs(problem: CGCProblem) -> Iterator[str]:
    """Tell two numbers for one thing."""
    size = _size(problem)
    seen: dict[object, tuple[float, str]] = {}
    for goal in problem.constraints:
        key: object
        if isinstance(goal, AtHeight) and isinstance(goal.vertices, str):
            key, value = "crown", goal.height
        elif isinstance(goal, Rise):
            key, value = ("crown" if goal.rise > 0 else "bottom"), support_height(problem) + goal.rise
        elif isinstance(goal, Volume):
            key, value = ("volume", goal.level), goal.volume / size**2
        elif isinstance(goal, Area):
            key, value = "area", goal.area / size
        elif isinstance(goal, Length):
            path = tuple(goal.vertices)
            key, value = ("length", min(path, path[::-1])), goal.length
        else:
            continue
        if key in seen and abs(seen[key][0] - value) > SAME * size:
            yield f"{seen[key][1]} and {goal_name(goal)} contradict each other; take one of them away"
        seen[key] = (value, goal_name(goal))


def _held(problem: CGCProblem) -> Iterator[str]:
    """Tell supports on the wrong side of something."""
    rounding = SAME * _size(problem)
    supports = np.flatnonzero(problem.roles == FIXED)
    for goal in problem.constraints:
        if isinstance(goal, Within) and isinstance(goal.vertices, str) and len(supports):
            inside = goal.slack(problem.vertices[supports])[0]
            if inside.min() < -rounding:
                vertex = int(supports[np.argmin(inside)])
                yield f"{goal_name(goal)} leaves out the support at vertex {vertex}, {-inside.min():.4g} outside; widen it or free that"
        if isinstance(goal, AtHeight) and not isinstance(goal.vertices, str):
            named = np.intersect1d(about(problem, goal), supports)
            off = np.abs(problem.vertices[named, 2] - goal.height)
            if off.max(initial=0.0) > rounding:
                vertex = int(named[np.argmax(off)])
                support = f"the support at vertex {vertex}, {problem.vertices[vertex, 2]:.4g}"
                yield f"{goal_name(goal)} is not that of {support}; free it, or take it out of the goal Height"
    for side in bind(problem).sides:
        at = side.candidates(problem.vertices)
        fixed = at[problem.roles[at] == FIXED]
        if not len(fixed):
            continue
        slack: FloatArray = side.goal.slack(problem.vertices[fixed])[0]
        if slack.min() < -rounding:
            vertex = int(fixed[np.argmin(slack)])
            yield f"{side.name} cannot be kept at vertex {vertex}, a support {-slack.min():.4g} on the wrong side; free it, or leave it out"


def _too_small(problem: CGCProblem) -> Iterator[str]:
    """Tell areas and lengths that a fixed edge or fixed ends do not allow."""
    faces = problem.faces[problem.real_faces]
    rim = boundary_vertices(problem.vertices, faces)
    for goal in problem.constraints:
        if isinstance(goal, Area) and rim.any() and (problem.roles[rim] == FIXED).all():
            a, b, c = (problem.vertices[faces[:, k]] for k in range(3))
            least = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a).sum(axis=0)))
            if goal.area <= least * (1.0 + SAME):
                yield f"{goal_name(goal)} is no more than the {least:.6g} that the fixed edge encloses; ask for more"
        elif isinstance(goal, Length) and any(one == other for one, other in zip(goal.vertices, goal.vertices[1:])):
            yield f"{goal_name(goal)} names a vertex twice in a row; name the vertices of a path once each, in their order"
        elif isinstance(goal, Length):
            first, last = problem.vertices[goal.vertices[0]], problem.vertices[goal.vertices[-1]]
            ends = problem.roles[[goal.vertices[0], goal.vertices[-1]]]
            least = float(np.linalg.norm(last - first))
            if (ends == FIXED).all() and goal.length < least:
                yield f"{goal_name(goal)} is shorter than the way between its fixed ends, {least:.6g}; ask for more"
