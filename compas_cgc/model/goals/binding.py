"""Goals bound to a problem: equations of the whole surface, position constraints and inequalities."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete import boundary_vertices
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import ProblemError
from ...errors import Sentence
from ...meshing import boundary_loops
from ...meshing.in_outline import vertices_over
from ..constraints import CROWN
from ..constraints import Constraint
from ..constraints import Height
from ..constraints import PositionConstraint
from ..constraints import indices
from ..counts import counted
from ..problem import CGCProblem
from ..roles import DUMMY
from ..roles import FIXED
from ..roles import FREE
from . import measures
from .inequalities import Bound
from .inequalities import Clearance
from .names import goal_name
from .numbers import ALL
from .places import EdgeInPlan
from .places import Level
from .wholes import Area
from .wholes import Length
from .wholes import Rise
from .wholes import Unknown
from .wholes import Volume
from .wholes import Whole

__all__ = [
    "BoundGoals",
    "Equation",
    "Side",
    "UnknownConstant",
    "bind",
    "equations_for_constants",
    "finds_constants",
    "has_constants",
    "held_by_newton",
    "support_height",
    "unknown_constants",
    "unknown_regions",
    "with_level_edges_held",
    "without_constants",
]

NO_EDGE = Sentence("{}: the mesh has no free edge; name the vertices of an edge, or remove the goal")
DIFFERENCE_STEP = 1e-5  # step of a difference quotient [L]; the cube root of the rounding error, which balances truncation and rounding


class Equation(NamedTuple):
    """A prescribed value of one quantity of the whole surface."""

    name: str  # the goal in words
    wanted: float  # prescribed value
    power: int  # dimension of the quantity: n of L^n
    value: Callable[[FloatArray], float]  # of a shape (n, 3)
    gradient: Callable[[FloatArray], FloatArray]  # derivative with respect to the vertices (n, 3)

    def curvature_along(self, vertices: FloatArray, moves: FloatArray) -> FloatArray:
        """Return the derivative of the gradient along displacements (n, 3)."""
        size = float(np.abs(moves).max(initial=0.0))
        if size == 0.0:
            return np.zeros_like(vertices)
        step = DIFFERENCE_STEP / size
        return (self.gradient(vertices + step * moves) - self.gradient(vertices - step * moves)) / (2.0 * step)


class Side(NamedTuple):
    """An inequality for some vertices."""

    name: str  # the goal in words
    goal: Bound
    candidates: Callable[[FloatArray], IntArray]  # vertices of a shape (n, 3) to which it applies


class BoundGoals(NamedTuple):
    """The goals of a problem, sorted by type."""

    equations: tuple[Equation, ...]
    places: tuple[PositionConstraint, ...]
    sides: tuple[Side, ...]

    @property
    def whole(self) -> bool:
        """Whether there are goals other than position constraints."""
        return bool(self.equations or self.sides)


def bind(problem: CGCProblem, named: Optional[Sequence[Constraint]] = None) -> BoundGoals:
    """Return the goals of a problem, bound to its vertices and supports.

    Parameters
    ----------
    problem
        The problem, in any frame.
    named
        Its constraints in the units for messages. Default: its own.

    Raises
    ------
    ProblemError
        If a goal names vertices or regions that do not exist.
    """
    equations: list[Equation] = []
    places: list[PositionConstraint] = []
    sides: list[Side] = []
    for goal, shown in zip(problem.goals, problem.goals if named is None else named):
        name = goal_name(shown)
        if isinstance(goal, EdgeInPlan):
            places += _sheets(problem, goal, name)
        elif isinstance(goal, Level):
            places += _rings(problem, goal, name)
        elif isinstance(goal, Height) and isinstance(goal.vertices, str):
            equations.append(_crown(name, goal.height, 1.0))
        elif isinstance(goal, PositionConstraint):
            places.append(goal)
        elif isinstance(goal, Rise):
            equations.append(_crown(name, goal.rise, 1.0 if goal.rise > 0.0 else -1.0, support_height(problem)))
        elif isinstance(goal, (Volume, Area, Length)):
            equations.append(_whole(problem, goal, name))
        elif isinstance(goal, Bound):
            sides.append(Side(name, goal, _candidates(problem, goal)))
    return BoundGoals(tuple(equations), tuple(places), tuple(sides))


class UnknownConstant(NamedTuple):
    """One number that a solve determines: the constant of a region, or the factor on the drawn constants of several."""

    regions: tuple[int, ...]
    goal: Unknown

    @property
    def is_factor(self) -> bool:
        """Whether drawn constants keep their ratios."""
        return len(self.regions) > 1


def unknown_constants(problem: CGCProblem) -> list[UnknownConstant]:
    """Return the unknown constants, ordered by their first regions.

    Raises
    ------
    ProblemError
        If there is no such region, two goals say different things about one, or ratios of values that are not drawn are to be kept.
    """
    wanted = [own for own in problem.goals if isinstance(own, Unknown)]
    if not wanted:
        return []
    count = int(problem.regions()[problem.real_faces].max(initial=-1)) + 1
    found: list[UnknownConstant] = []
    named: dict[int, Unknown] = {}
    for goal in wanted:
        numbers = range(count) if isinstance(goal.regions, str) else dict.fromkeys(int(region) for region in goal.regions)
        lost = [region for region in numbers if not 0 <= region < count]
        if lost:
            mend = f"name regions from 0 to {count - 1}, or 'all'"
            raise ProblemError([f"the goal Unknown names region {lost[0]}, but the mesh has {counted(count, 'region')}; {mend}"])
        again = [region for region in numbers if region in named]
        if any(replace(named[region], regions=ALL) != replace(goal, regions=ALL) for region in again):
            raise ProblemError([f"two goals Unknown say different things about region {again[0]}; name it in one of them"])
        new = tuple(region for region in numbers if region not in named)
        named.update(dict.fromkeys(new, goal))
        found += [UnknownConstant(regions, goal) for regions in ([new] if goal.ratio and new else [(region,) for region in new])]
    for constant in found:
        _check_constant(problem, constant)
    return sorted(found, key=lambda constant: constant.regions)


def _check_constant(problem: CGCProblem, constant: UnknownConstant) -> None:
    of_law = [region for region in constant.regions if region in problem.laws]
    if of_law and constant.goal.bounds is not None:
        other = problem.laws[of_law[0]]
        raise ProblemError([f"the bounds of the goal Unknown are of K, but region {of_law[0]} has the law {other}; leave the bounds out"])
    for region in constant.regions if constant.is_factor else ():
        law = problem.laws.get(region)
        drawn = problem.targets[problem.region_vertices(region)] if law is None else np.array([law.constant or 0.0])
        if not (np.isfinite(drawn).all() and drawn.all()):
            raise ProblemError([f"the goal Unknown keeps ratios, but region {region} has no value other than 0; set its K, or ratio=False"])


def unknown_regions(problem: CGCProblem) -> list[int]:
    """Return the numbers of the regions with an unknown constant.

    Raises
    ------
    ProblemError
        If there is no such region.
    """
    return sorted(region for constant in unknown_constants(problem) for region in constant.regions)


def support_height(problem: CGCProblem) -> float:
    """Return the mean height of the supports [L].

    Raises
    ------
    ProblemError
        If there are none.
    """
    fixed = problem.vertices[problem.roles == FIXED]
    if not len(fixed):
        mend = "fix vertices (mesh.set_supports, or --supports corners), or give the volume a level"
        raise ProblemError([f"a rise or a volume is measured from the supports, but the mesh has none; {mend}"])
    return float(fixed[:, 2].mean())


def _crown(name: str, wanted: float, side: float, base: float = 0.0) -> Equation:
    """Return the equation for the height of the highest vertex over a base, or of the lowest for side -1."""

    def highest(vertices: FloatArray) -> int:
        return int(np.argmax(side * vertices[:, 2]))

    def gradient(vertices: FloatArray) -> FloatArray:
        result = np.zeros_like(vertices)
        result[highest(vertices), 2] = 1.0
        return result

    return Equation(name, wanted, 1, lambda vertices: float(vertices[highest(vertices), 2]) - base, gradient)


def _whole(problem: CGCProblem, goal: Constraint, name: str) -> Equation:
    faces = problem.faces[problem.real_faces]
    if isinstance(goal, Volume):
        level = support_height(problem) if goal.level is None else goal.level
        return Equation(
            name,
            goal.volume,
            3,
            lambda vertices: measures.volume(vertices, faces, level),
            lambda vertices: measures.volume_gradient(vertices, faces, level),
        )
    if isinstance(goal, Area):
        return Equation(
            name,
            goal.area,
            2,
            lambda vertices: measures.area(vertices, faces),
            lambda vertices: measures.area_gradient(vertices, faces),
        )
    assert isinstance(goal, Length)
    path = np.asarray(goal.vertices, dtype=np.int64)
    return Equation(
        name,
        goal.length,
        1,
        lambda vertices: measures.length(vertices, path),
        lambda vertices: measures.length_gradient(vertices, path),
    )


def _candidates(problem: CGCProblem, goal: Bound) -> Callable[[FloatArray], IntArray]:
    """Return a function that selects the vertices of a shape to which an inequality applies."""
    movable = problem.movable
    faces = problem.faces[problem.real_faces]
    if isinstance(goal, Clearance):
        if isinstance(goal.where, (int, np.integer)):
            at = np.flatnonzero(problem.region_vertices(int(goal.where)) | _on_region(problem, int(goal.where)))
            return _always(at[movable[at]])
        outline = goal.outline()

        def over(vertices: FloatArray) -> IntArray:
            within, reaching = vertices_over(vertices, faces, outline)
            return np.union1d(within, reaching[movable[reaching]])

        return over
    vertices = getattr(goal, "vertices", ALL)
    at = np.flatnonzero(movable) if isinstance(vertices, str) else indices(vertices, len(movable))
    return _always(at)


def _always(at: IntArray) -> Callable[[FloatArray], IntArray]:
    return lambda vertices: at


def _on_region(problem: CGCProblem, region: int) -> np.ndarray:
    inside = np.zeros(len(problem.vertices), bool)
    inside[problem.faces[problem.regions() == region]] = True
    return inside


def _rings(problem: CGCProblem, goal: Level, name: str) -> list[Level]:
    """Return one level goal for every edge that it names."""
    if not isinstance(goal.vertices, str):
        order = np.unique(np.asarray(goal.vertices, dtype=np.int64), return_index=True)
        points = problem.vertices if goal.points is None else np.asarray(goal.points, dtype=np.float64)
        return [replace(goal, vertices=order[0].tolist(), points=points[order[0] if goal.points is None else order[1]])]
    runs = [np.unique(path) for path, _ in _free_edges(problem)]
    if not runs:
        raise ProblemError([NO_EDGE.format(name)])
    return [replace(goal, vertices=path.tolist(), points=problem.vertices[path]) for path in runs]


def with_level_edges_held(problem: CGCProblem) -> CGCProblem:
    """Return the problem with level edges that end at supports held at the height of these, which leaves them no choice."""
    edges = [edge for goal in problem.goals if isinstance(goal, Level) for edge in _rings(problem, goal, goal_name(goal))]
    if not edges:
        return problem
    vertices, roles, left = problem.vertices.copy(), problem.roles.copy(), len(edges) + 1
    while len(edges) < left:  # Edges that meet at the end of a crease have one height.
        left = len(edges)
        for edge in list(edges):
            at, plan = np.asarray(edge.vertices, dtype=np.int64), np.asarray(edge.points, dtype=np.float64)
            fixed = roles[at] == FIXED
            if fixed.any():
                height = vertices[at[fixed], 2].mean()
                vertices[at[~fixed]] = np.column_stack([plan[~fixed, :2], np.full(np.count_nonzero(~fixed), height)])
                roles[at] = FIXED
                edges.remove(edge)
    if np.array_equal(roles, problem.roles):
        return problem  # whose goals for all free edges hold on coarser meshes, too
    others = [goal for goal in problem.goals if not isinstance(goal, Level)]
    return replace(problem, vertices=vertices, roles=roles, goals=(*others, *edges))


def _sheets(problem: CGCProblem, goal: EdgeInPlan, name: str) -> list[PositionConstraint]:
    """Return one edge-in-plan goal for every line that its vertices follow."""
    if isinstance(goal.vertices, str):
        paths = [(path, closed) for path, closed in _free_edges(problem)]
    else:
        paths = [(np.asarray(goal.vertices, dtype=np.int64), goal.closed)]
    if isinstance(goal.vertices, str) and not paths:
        raise ProblemError([NO_EDGE.format(name)])
    found: list[PositionConstraint] = []
    for path, closed in paths:
        line = problem.vertices[path] if goal.points is None else goal.points
        free = path[problem.roles[path] != FIXED]
        if len(free):
            around = closed or (goal.points is not None and goal.closed)
            found.append(replace(goal, vertices=free.tolist(), points=line, closed=around))
    return found


def _free_edges(problem: CGCProblem) -> list[tuple[IntArray, bool]]:
    """Return the runs of free vertices along the boundaries, with the vertices at their ends, and whether each is closed."""
    runs: list[tuple[IntArray, bool]] = []
    for loop in boundary_loops(problem.faces[problem.real_faces]):
        rim = np.asarray(loop, dtype=np.int64)
        held = np.flatnonzero(problem.roles[rim] != FREE)
        if not len(held):
            runs.append((rim, True))
            continue
        rim = np.roll(rim, -held[0])
        stops = [*np.flatnonzero(problem.roles[rim] != FREE).tolist(), len(rim)]
        around = np.append(rim, rim[0])
        runs += [(around[a : b + 1], False) for a, b in zip(stops, stops[1:]) if b > a + 1]
    return runs


def held_by_newton(problem: CGCProblem) -> bool:
    """Check whether the goals are one whole-surface goal and one unknown K > 0 over a fixed boundary, which Newton's method solves."""
    kinds = (Rise, Volume, Area, Length, Unknown)
    mine = [own for own in problem.goals if isinstance(own, kinds) or (isinstance(own, Height) and own.vertices == CROWN)]
    goals = [own for own in mine if not isinstance(own, Unknown)]
    rim = boundary_vertices(problem.vertices, problem.faces)
    held = bool((problem.roles[rim] == FIXED).all() and rim.any() and problem.real_faces.all())
    elliptic = not (problem.types[problem.asked] < 0).any()
    whole = len(mine) == len(problem.goals) and len(goals) == 1 and len(mine) > 1
    return whole and held and elliptic and not len(problem.creases) and len(unknown_regions(problem)) == 1


def equations_for_constants(problem: CGCProblem) -> list[Equation]:
    """Return the equations that determine unknown constants: of the whole surface, and one for every vertex with a height.

    Raises
    ------
    ProblemError
        If a goal names vertices or regions that do not exist.
    """
    bound = bind(problem)
    heights = [own for own in bound.places if isinstance(own, Height)]
    vertices = [(own, vertex) for own in heights for vertex in indices(own.vertices, len(problem.vertices)).tolist()]
    return [*bound.equations, *(_height_at(own.height, vertex) for own, vertex in vertices)]


def _height_at(height: float, vertex: int) -> Equation:
    def gradient(vertices: FloatArray) -> FloatArray:
        result = np.zeros_like(vertices)
        result[vertex, 2] = 1.0
        return result

    return Equation(f"the height {height:.6g} of vertex {vertex}", height, 1, lambda vertices: float(vertices[vertex, 2]), gradient)


def without_constants(problem: CGCProblem) -> CGCProblem:
    """Return the problem without unknown constants and the goals that determine them, see :func:`equations_for_constants`."""
    return replace(problem, goals=tuple(own for own in problem.goals if not isinstance(own, (Unknown, Whole, Height))))


def finds_constants(problem: CGCProblem) -> bool:
    """Check whether unknown constants, K or those of laws, can meet the heights of vertices and the quantities of the whole surface.

    There is at most one of these for each unknown constant, whose sign is drawn. The sign of a single undrawn K is that of a dome.
    """
    unknown = unknown_constants(problem)
    if (problem.roles == DUMMY).any():
        return False
    if not 0 < len(equations_for_constants(problem)) <= len(unknown):
        return False
    return has_constants(problem) or (len(unknown) == 1 and unknown[0].regions[0] not in problem.laws)


def has_constants(problem: CGCProblem) -> bool:
    """Check whether K is drawn in every region without another law, and all unknown constants are drawn and not zero."""
    if not np.isfinite(problem.targets[problem.asked]).all():
        return False
    unknown = unknown_regions(problem)
    of_laws = [problem.laws[region].constant for region in unknown if region in problem.laws]
    of_targets = (problem.targets[problem.region_vertices(region)] for region in unknown if region not in problem.laws)
    return all(of_laws) and all((K != 0.0).all() for K in of_targets)
