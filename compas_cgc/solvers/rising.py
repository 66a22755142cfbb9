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
from ..model.measures import is_held_all_round
from ..model.problem import CGCProblem
from ..model.result import Solution
from ..model.verdict import Verdict
from ..model.verdict import verdict
from .projection.settings import ProjectionSettings

__all__ = ["GROWTH", "Bracket", "Carried", "Rising"]

LEAST = 1 / 64  # smallest factor that is tried over the first one; a surface that fails at a total curvature of 0.008 rad has another cause
# factor from one target to the next; the height of a dome grows by a fifth, a step that the search follows from the last surface
GROWTH = 1.5
# factor between targets that are tried from the surfaces of a coarser mesh; differences of 5 % are within the accuracy of the search
FALL = 0.95
HIGH = 8 * np.pi  # total curvature that is never the limit [rad]; two whole spheres


class Carried(NamedTuple):
    """A fair surface for targets times a factor."""

    factor: float
    vertices: FloatArray  # (n, 3) [L]
    judged: Verdict


class Bracket(NamedTuple):
    """The largest factor on the targets that was found to be carried, and the smallest above that was not."""

    carried: Optional[Carried]
    beyond: Optional[float]


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
    """

    def __init__(self, problem: CGCProblem, tolerance: float, solves: int, work: Work, most: float = math.inf):
        self.problem, self._tolerance, self._work, self._most = problem, tolerance, work, most
        self._solves, self.count = solves, 0
        self.trail: list[Carried] = []
        self._solve = _solver(problem)
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

    def tried(self, factor: float, vertices: Optional[FloatArray]) -> Optional[Carried]:
        """Return the fair surface for a factor, from a shape (n, 3) if there is one; None without any."""
        self.count += 1
        carried = self._led(factor, vertices)
        if carried is not None:
            self.trail.append(carried)
        return carried

    def _led(self, factor: float, vertices: Optional[FloatArray]) -> Optional[Carried]:
        with self._work.counted():
            solution = self._solve(factor, vertices)
        if solution.status != "converged":
            return None
        shape = replace(self.problem, targets=factor * self.problem.targets, vertices=solution.vertices)
        judged = verdict(shape, self.problem.vertices)
        return Carried(factor, solution.vertices, judged) if judged.fair else None

    def begun(self) -> Bracket:
        """Return a gentle surface, or the smallest factor that was not carried."""
        factor = first = GENTLE_TOTAL_CURVATURE / self._total
        carried = self.tried(factor, None)
        while carried is None and factor > LEAST * first and not self.over:
            factor /= 4.0
            carried = self.tried(factor, None)
        return Bracket(carried, factor if carried is None else None)

    def near(self, shapes: Iterable[tuple[float, FloatArray]]) -> Bracket:
        """Return the surface for the first factor that is carried, from shapes (n, 3) for factors that fall."""
        beyond: Optional[float] = None
        for factor, vertices in shapes:
            if beyond is not None and (self.over or factor > FALL * beyond):
                continue
            carried = self.tried(factor, vertices)
            if carried is not None:
                return Bracket(carried, beyond)
            beyond = factor
        return Bracket(None, beyond)

    def narrowed(self, bracket: Bracket, growth: float = GROWTH) -> Bracket:
        """Return the bracket that rising targets, and then halving, come to."""
        carried, beyond = bracket
        while carried is not None and not self.over and carried.factor < self._most:
            if beyond is not None and beyond - carried.factor <= self._tolerance * carried.factor:
                break
            if beyond is None and carried.factor * self._total > HIGH:
                break
            factor = growth * carried.factor if beyond is None else 0.5 * (carried.factor + beyond)
            found = self.tried(factor, carried.vertices)
            if found is None and self._is_spent:
                break  # It was cut short, which tells nothing of the supports.
            carried, beyond = (found, beyond) if found is not None else (carried, factor)
            growth = min(GROWTH, growth**2)
        return Bracket(carried, beyond)


def _solver(problem: CGCProblem) -> Callable[[float, Optional[FloatArray]], Solution]:
    """Return what solves for a factor on the targets, from a shape (n, 3) if there is one."""
    if is_held_all_round(problem) and not problem.goals:
        from .newton.normal_newton import newton

        def by_newton(factor: float, vertices: Optional[FloatArray]) -> Solution:
            own = replace(problem, targets=factor * problem.targets, vertices=problem.vertices if vertices is None else vertices)
            return newton(own)._replace(method="newton")

        return by_newton
    from .polish.posed import takes_goals

    if takes_goals(problem):
        from .polish.polisher import polish
        from .polish.settings import PolishSettings

        def by_bending(factor: float, vertices: Optional[FloatArray]) -> Solution:
            own = replace(problem, targets=factor * problem.targets)
            return polish(own, settings=PolishSettings(evenness=0.0), start=vertices)._replace(method="bending")

        return by_bending
    from .projection.projector import Projector

    cold = Projector(problem)
    # Where the last surface does not lead on, no other start is asked: the limit is that of this branch.
    warm = Projector(problem, settings=ProjectionSettings(retry=False))

    def by_projection(factor: float, vertices: Optional[FloatArray]) -> Solution:
        return (cold if vertices is None else warm).solve(factor * problem.targets, vertices)._replace(method="projection")

    return by_projection
