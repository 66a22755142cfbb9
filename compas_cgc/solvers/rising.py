"""Targets that rise from a gentle surface on, each solved from the last, until one has no fair surface.

The curvatures that are tried do not depend on the targets, only on the area: so the limit is the same number whatever K is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from ..linalg.work import Work
from ..linalg.work import is_spent
from ..model.checks import GENTLE_TOTAL_CURVATURE
from ..model.convex_plans import beyond_convex_plans
from ..model.measures import is_held_all_round
from ..model.problem import CGCProblem
from ..model.result import Solution
from ..model.tolerances import DRAWING_ACCURACY
from ..model.verdict import Verdict
from ..model.verdict import verdict
from .between_lines import between_lines
from .branch_ends import BIFURCATION
from .branch_ends import FOLD
from .branch_ends import PLAN
from .branch_ends import ROUGH
from .branch_ends import folds_back
from .branch_ends import rates
from .choices import choose
from .newton.normal_newton import newton
from .polish.polisher import polish
from .polish.posed import takes_goals
from .polish.settings import PolishSettings
from .projection.projector import Projector
from .projection.settings import ProjectionSettings

__all__ = ["GROWTH", "Bracket", "Carried", "Rising"]

LEAST = 1 / 64  # smallest factor that is tried over the first one; a surface that fails at a total curvature of 0.008 rad has another cause
# factor from one target to the next; the height of a dome grows by a fifth, a step that the search follows from the last surface
GROWTH = 1.5
# factor between targets that are tried from the surfaces of a coarser mesh; differences of 5 % are within the accuracy of the search
FALL = 0.95
# rate of change over that before, up to which a surface is on the same branch; beside a fold it grows by the root of 2 as steps are halved
PACE = 2.0
HIGH = 8 * np.pi  # total curvature that is never the limit [rad]; two whole spheres


_Solve = Callable[[float, Optional[FloatArray]], Optional[Solution]]  # of a factor on the targets, from a shape (n, 3) if there is one
_Way = Callable[[CGCProblem], _Solve]


class Carried(NamedTuple):
    """A fair surface for targets times a factor."""

    factor: float
    vertices: FloatArray  # (n, 3) [L]
    judged: Verdict


class Bracket(NamedTuple):
    """The largest factor on the targets that was found to be carried, and the smallest above that was not."""

    carried: Optional[Carried]
    beyond: Optional[float]
    end: str = ""  # what ends the branch between them, a key of ``ENDS``; empty where that is not known


class Rising:
    """Solves on one mesh for factors on its targets.

    Parameters
    ----------
    problem
        Of finite targets that are not all zero.
    tolerance
        Width of the interval around the limit to stop at, against the limit.
    solves
        Most surfaces to solve for.
    work
        That they may take.
    most
        Factor that is enough.
    ways
        Ways to try; default: those of :func:`solve`. The first that leads to a fair surface is the only one from then on.
    """

    def __init__(
        self, problem: CGCProblem, tolerance: float, solves: int, work: Work, most: float = math.inf, ways: Optional[list[_Way]] = None
    ):
        self.problem, self._tolerance, self._work, self._most = problem, tolerance, work, most
        self._solves, self.count = solves, 0
        self.trail: list[Carried] = []
        self._last: Optional[Solution] = None
        self.ways = ways or _ways(problem)
        self._solve = {way: way(problem) for way in self.ways}
        targets, areas = problem.targets[problem.asked], face_areas(problem.vertices, problem.faces)
        types = problem.types[problem.asked]
        mixed = bool(types.min() < 0 < types.max())
        # Regions of either sign bend within themselves.
        area = float(np.bincount(problem.regions(), areas).max() if mixed else areas.sum())
        self._total = float(np.abs(targets).max()) * area

    @property
    def over(self) -> bool:
        """Whether nothing more is to be tried."""
        return self.count >= self._solves or self._is_spent

    @property
    def _is_spent(self) -> bool:
        return self._work.spent or is_spent()

    def tried(self, factor: float, vertices: Optional[FloatArray] = None) -> Optional[Carried]:
        """Return the fair surface for a factor, from a shape (n, 3) if there is one; None without any."""
        for way in self.ways:
            self._last, carried = self._solved(way, factor, vertices)
            if carried is not None:
                self.ways = [way]
                return carried
        return None

    def _solved(self, way: _Way, factor: float, vertices: Optional[FloatArray]) -> tuple[Optional[Solution], Optional[Carried]]:
        self.count += 1
        with self._work.counted():
            solution = self._solve[way](factor, vertices)
        if solution is None or solution.status != "converged":
            return solution, None
        shape = replace(self.problem, targets=factor * self.problem.targets, vertices=solution.vertices)
        judged = verdict(shape, self.problem.vertices)
        return solution, Carried(factor, solution.vertices, judged) if judged.fair else None

    def _is_on_branch(self, factor: float, vertices: FloatArray) -> bool:
        """Return whether a surface (n, 3) for a factor continues the branch of the last ones, and did not snap to another.

        Each surface between lines is that of a solve, whatever the last one was.
        """
        if self.ways == [_between_lines]:
            return True
        branch = self.trail[-2:]
        pace = rates([*(one.factor for one in branch), factor], [*(one.vertices for one in branch), vertices])
        return len(pace) < 2 or bool(pace[1] <= PACE * pace[0])

    def _leads_back(self, found: Carried, before: Carried) -> bool:
        """Return whether a surface leads back to the one before: it does if symmetry is lost gradually, but not after a snap."""
        size = float(np.ptp(before.vertices, axis=0).max())
        back = self._solved(self.ways[0], before.factor, found.vertices)[1]
        return back is not None and float(np.abs(back.vertices - before.vertices).max()) <= DRAWING_ACCURACY * size

    def begun(self) -> Bracket:
        """Return a gentle surface, or the smallest factor that was not carried."""
        factor = first = GENTLE_TOTAL_CURVATURE / self._total
        carried = self.tried(factor)
        while carried is None and factor > LEAST * first and not self.over:
            factor /= 4.0
            carried = self.tried(factor)
        if carried is None:
            return Bracket(None, factor)
        self.trail = [carried]
        return Bracket(carried, None)

    def near(self, shapes: Iterable[tuple[float, FloatArray]]) -> Bracket:
        """Return the surface for the first factor that is carried, from shapes (n, 3) for factors that fall."""
        beyond: Optional[float] = None
        for factor, vertices in shapes:
            if beyond is not None and (self.over or factor > FALL * beyond):
                continue
            carried = self.tried(factor, vertices)
            if carried is not None:
                self.trail = [carried]
                return Bracket(carried, beyond)
            beyond = factor
        return Bracket(None, beyond)

    def narrowed(self, bracket: Bracket, growth: float = GROWTH) -> Bracket:
        """Return the bracket that rising targets, and then halving, come to.

        If a surface snaps to another one, a shorter step is tried. A factor for which no fair surface was found is tried again from the
        last surface before it.
        """
        carried, beyond = bracket.carried, bracket.beyond
        shortest = 1.0 + self._tolerance
        leads_on = True  # whether nothing that was not carried was tried from the last surface
        while carried is not None and not self.over and carried.factor < self._most:
            room = math.inf if beyond is None else beyond / carried.factor
            if room <= shortest and not leads_on:
                return Bracket(carried, beyond, self._end())
            if beyond is None and carried.factor * self._total > HIGH:
                break
            step = min(growth, room if room <= shortest else math.sqrt(room))
            found = self.tried(step * carried.factor, carried.vertices)
            if found is None and self._is_spent:
                break  # It was cut short, which tells nothing of the supports.
            short = step <= shortest
            if found is not None and (self._is_on_branch(found.factor, found.vertices) or (short and self._leads_back(found, carried))):
                beyond = None if step == room else beyond
                carried, leads_on, growth = found, True, min(GROWTH, step**2)
                self.trail.append(found)
            elif found is not None and not short:
                growth = max(shortest, math.sqrt(step))
            else:
                beyond, leads_on = step * carried.factor, False
        return Bracket(carried, beyond)

    def _end(self) -> str:
        """Return what ends the branch after the last surface that is carried."""
        last, branch = self._last, self.trail
        if last is None:
            return ""
        arrived, beyond = last.status == "converged", branch[-1].factor * (1.0 + self._tolerance)
        shape = replace(self.problem, targets=beyond * self.problem.targets, vertices=last.vertices)
        if beyond_convex_plans(shape, self.problem.vertices):
            return PLAN
        if arrived and self._is_on_branch(beyond, last.vertices):
            return ROUGH
        if folds_back([one.factor for one in branch], [one.vertices for one in branch], beyond):
            return FOLD
        return BIFURCATION if arrived else ""


def _ways(problem: CGCProblem) -> list[_Way]:
    """Return the ways to surfaces of rising targets, in the order in which :func:`solve` tries them."""
    if is_held_all_round(problem) and not problem.goals:
        return [_by_newton]
    lines = [_between_lines] if choose(problem)[0].then else []
    return [*lines, _by_bending if takes_goals(problem) else _by_projection]


def _between_lines(problem: CGCProblem) -> _Solve:
    choice = choose(problem)[0]
    # Lines do not depend on the surface before: a solve finds the same.
    return lambda factor, _: between_lines(replace(problem, targets=factor * problem.targets), choice, None, None)


def _by_newton(problem: CGCProblem) -> _Solve:
    def solved(factor: float, vertices: Optional[FloatArray]) -> Solution:
        return newton(replace(problem, targets=factor * problem.targets, vertices=problem.vertices if vertices is None else vertices))

    return solved


def _by_bending(problem: CGCProblem) -> _Solve:
    settings = PolishSettings(evenness=0.0)
    return lambda factor, vertices: polish(replace(problem, targets=factor * problem.targets), settings=settings, start=vertices)


def _by_projection(problem: CGCProblem) -> _Solve:
    cold = Projector(problem)
    # Where the last surface does not lead on, no other start is asked: the limit is that of this branch.
    warm = Projector(problem, settings=ProjectionSettings(retry=False))
    return lambda factor, vertices: (cold if vertices is None else warm).solve(factor * problem.targets, vertices)
