"""Detection of contradictory or impossible goals before a solve."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...discrete import boundary_vertices
from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...errors import Remedy
from ...errors import Sentence
from ..constraints import Constraint
from ..constraints import Height
from ..given import MAX_LENGTH_RATIO
from ..problem import CGCProblem
from ..roles import FIXED
from ..tolerances import NEGLIGIBLE
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

__all__ = ["bound_problems", "goal_problems", "refuse_impossible"]

MIN_RISE_RATIO = 5e-4  # rise over the size of the mesh below which it is probably in other units; 1/1,000 for m and mm, halved


def refuse_impossible(problem: CGCProblem) -> None:
    """Refuse goals that contradict each other or the drawing.

    Raises
    ------
    ProblemError
        With one sentence per contradiction that names the goals and a remedy.
    """
    found = goal_problems(problem)
    if found:
        raise ProblemError(found)


def goal_problems(problem: CGCProblem) -> list[str]:
    """Return one sentence per contradiction between goals, supports and drawing; each names the goals and a remedy."""
    if not problem.goals:
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
    """Return messages for goals that apply to nothing."""
    count = int(problem.regions()[problem.real_faces].max(initial=-1)) + 1
    for goal in problem.goals:
        if isinstance(goal, Unknown) and not isinstance(goal.regions, str) and not len(goal.regions):
            yield Sentence("{} names no region; name regions from 0 to {}, or 'all', or remove the goal").format(goal_name(goal), count - 1)
        elif isinstance(goal, Clearance):
            where = goal.where
            if isinstance(where, (int, np.integer)):
                if not 0 <= where < count:
                    yield f"{goal_name(goal)} is over region {where}, but the mesh has regions 0 to {count - 1}; name one of these"
            elif not len(bind(_only(problem, goal)).sides[0].candidates(problem.vertices)):
                yield f"{goal_name(goal)} lies outside the plan of the mesh; give a place under the mesh, in the units of the drawing"
        elif isinstance(goal, (Above, Below, NearPlane, EdgeInPlan, Level, Height)) and not isinstance(goal.vertices, str):
            if not len(goal.vertices):
                yield Sentence("{} names no vertices; name some, or remove the goal").format(goal_name(goal))
            elif isinstance(goal, EdgeInPlan) and goal.points is None and len(set(goal.vertices)) < 2:
                yield f"{goal_name(goal)} names only one vertex; name two or more along an edge in their order, or 'free'"


def _only(problem: CGCProblem, goal: Constraint) -> CGCProblem:
    return problem.with_goals([goal], add=False)


def _size(problem: CGCProblem) -> float:
    return float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))


def _out_of_scale(problem: CGCProblem) -> Iterator[str]:
    """Return messages for values that are probably in other units than the drawing."""
    size, middle = _size(problem), float(problem.vertices[:, 2].mean())
    mend = "check its units: they must be those of the drawing"
    for goal in problem.goals:
        far = _reach(goal, middle)
        if far > MAX_LENGTH_RATIO * size:
            yield f"{goal_name(goal)} is far larger than the mesh, whose size is {size:.3g}; {mend}"
        elif isinstance(goal, Rise) and far < MIN_RISE_RATIO * size:
            yield f"{goal_name(goal)} is negligible against the size of the mesh, {size:.3g}; {mend}"


def bound_problems(problem: CGCProblem) -> Iterator[str]:
    """Return warnings about bounds of the height that have no effect, or hardly leave the level of a support."""
    size, middle = _size(problem), float(problem.vertices[:, 2].mean())
    levels = problem.vertices[problem.supports, 2]
    for goal in problem.goals:
        if isinstance(goal, (Above, Below)):
            beyond = (goal.height - middle) * (1.0 if isinstance(goal, Below) else -1.0)
            over = float(np.abs(goal.height - levels).min(initial=np.inf))
            if beyond > MAX_LENGTH_RATIO * size:
                yield f"{goal_name(goal)} has no effect on a mesh of size {size:.3g}; check its units: they must be those of the drawing"
            elif NEGLIGIBLE * size < over < MIN_RISE_RATIO * size:
                yield (
                    f"{goal_name(goal)} is {over:.3g} from the level of a support, which is negligible against the size of the mesh, "
                    f"{size:.3g}; check its units: they must be those of the drawing"
                )


def _reach(goal: Constraint, middle: float) -> float:
    """Return the characteristic length of a goal, heights measured from `middle`; zero if it has none [L]."""
    if isinstance(goal, Rise):
        return abs(goal.rise)
    if isinstance(goal, Height):
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
    """Return messages for two different values of the same quantity."""
    size = _size(problem)
    seen: dict[object, tuple[float, str]] = {}
    for goal in problem.goals:
        key: object
        if isinstance(goal, Height) and isinstance(goal.vertices, str):
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
        if key in seen and abs(seen[key][0] - value) > NEGLIGIBLE * size:
            yield Sentence("{} and {} contradict each other; remove one of them").format(seen[key][1], goal_name(goal))
        seen[key] = (value, goal_name(goal))


def _held(problem: CGCProblem) -> Iterator[str]:
    """Return messages for supports that violate a goal."""
    rounding = NEGLIGIBLE * _size(problem)
    supports = np.flatnonzero(problem.roles == FIXED)
    for goal in problem.goals:
        if isinstance(goal, Within) and isinstance(goal.vertices, str) and len(supports):
            inside = goal.slack(problem.vertices[supports])[0]
            if inside.min() < -rounding:
                vertex = int(supports[np.argmin(inside)])
                off = f"which lies {-inside.min():.3g} outside; widen the outline or free that vertex"
                yield Sentence(f"{goal_name(goal)} excludes the support at vertex {vertex}, {off}", [Remedy("release", [vertex])])
        if isinstance(goal, Height) and not isinstance(goal.vertices, str):
            named = np.intersect1d(about(problem, goal), supports)
            off = np.abs(problem.vertices[named, 2] - goal.height)
            if off.max(initial=0.0) > rounding:
                vertex = int(named[np.argmax(off)])
                support = f"the height {problem.vertices[vertex, 2]:.4g} of the support at vertex {vertex}"
                text = f"{goal_name(goal)} contradicts {support}; free that vertex, or remove it from the goal Height"
                yield Sentence(text, [Remedy("release", [vertex])])
    for side in bind(problem).sides:
        at = side.candidates(problem.vertices)
        fixed = at[problem.roles[at] == FIXED]
        if not len(fixed):
            continue
        slack: FloatArray = side.goal.slack(problem.vertices[fixed])[0]
        if slack.min() < -rounding:
            vertex = int(fixed[np.argmin(slack)])
            by = f"{-slack.min():.3g}; free that vertex or remove the goal there"
            text = f"{side.name} cannot be met at the support at vertex {vertex}, which violates it by {by}"
            yield Sentence(text, [Remedy("release", [vertex])])


def _too_small(problem: CGCProblem) -> Iterator[str]:
    """Return messages for areas and lengths below the minimum that fixed boundaries and ends allow."""
    faces = problem.faces[problem.real_faces]
    rim = boundary_vertices(problem.vertices, faces)
    for goal in problem.goals:
        if isinstance(goal, Area) and rim.any() and (problem.roles[rim] == FIXED).all():
            a, b, c = (problem.vertices[faces[:, k]] for k in range(3))
            least = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a).sum(axis=0)))
            if goal.area <= least * (1.0 + NEGLIGIBLE):
                yield f"{goal_name(goal)} must be larger than {least:.6g}, the least area that the fixed boundary allows"
        elif isinstance(goal, Length) and any(one == other for one, other in zip(goal.vertices, goal.vertices[1:])):
            yield f"{goal_name(goal)} names a vertex twice in a row; name each vertex of the path once, in order"
        elif isinstance(goal, Length):
            first, last = problem.vertices[goal.vertices[0]], problem.vertices[goal.vertices[-1]]
            ends = problem.roles[[goal.vertices[0], goal.vertices[-1]]]
            least = float(np.linalg.norm(last - first))
            if (ends == FIXED).all() and goal.length < least:
                yield f"{goal_name(goal)} is shorter than the distance {least:.6g} between its fixed ends; increase it"
