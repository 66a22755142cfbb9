"""The branch of fairest surfaces that one of them lies on, as the targets change."""

from __future__ import annotations

from typing import Optional

from numpy.typing import ArrayLike

from ...discrete.arrays import FloatArray
from ...linalg import SingularMatrixError
from ...model.problem import CGCProblem
from ...model.result import Solution
from .at_rest import rests
from .at_rest import to_rest
from .measure import shows_layout
from .optimality import optimality
from .projector import Projector
from .projector import ready
from .sequential import Reached
from .settings import AUTO
from .settings import ProjectionSettings

__all__ = ["Branch", "branch_through"]

LEAST = 1 / 8  # part of the way to other targets that is taken at once
MATRICES = 8  # tried on the way


class Branch:
    """The fairest surfaces of one drawing that lead on from one of them: each is where rounding alone says, whatever the way to it.

    Parameters
    ----------
    projector
        Of the drawing, without anything that is asked but K.
    targets
        ``(n,)`` of the surface [1/L^2].
    vertices
        ``(n, 3)`` the surface [L].

    Raises
    ------
    SingularMatrixError
        If there are many fairest surfaces side by side.
    """

    def __init__(self, projector: Projector, targets: FloatArray, vertices: FloatArray):
        self._projector, self._system = projector, projector.system
        local = projector.posed(targets, vertices)
        equations = self._system.equations(local.targets)
        self._targets = local.targets
        self._solved = optimality(self._system, self._system.at(local.vertices, equations), equations)
        self._here = Reached(self._solved.point, self._solved.multipliers)

    def to(self, targets: ArrayLike) -> Optional[Solution]:
        """Return the surface of the branch for other targets (n,), None where it is not found, or not as good by angle defects alone."""
        system, local = self._system, self._projector.posed(targets)
        there = self._walked(local)
        if there is None:
            return None
        layout = self._projector.settings.measure == AUTO and shows_layout(system, system.equations(local.targets), there.point.vertices)
        return None if layout else self._projector.found_at(there.point, targets)

    def _walked(self, local: CGCProblem) -> Optional[Reached]:
        """Go from the targets of the first surface to others, all the way or part by part."""
        system, first = self._system, self._targets
        here, solved, done, part = self._here, self._solved, 0.0, 1.0
        for _ in range(MATRICES):
            goal = min(1.0, done + part)
            equations = system.equations(local.targets if goal == 1.0 else first + goal * (local.targets - first))
            there = to_rest(solved, equations, here)
            if there is None:
                part /= 2.0
                if part < LEAST:
                    break
                continue
            if goal == 1.0:
                return there
            here, done = there, goal
            try:
                solved = optimality(system, here.point, equations, here.multipliers)
            except SingularMatrixError:
                break
        return None


def branch_through(problem: CGCProblem, vertices: FloatArray, settings: ProjectionSettings) -> Optional[Branch]:
    """Return the branch through the surface (n, 3) of a problem, None where the problem is of a kind that has none."""
    if problem.goals or settings.measure not in (AUTO, "defect"):
        return None
    projector = ready(problem, settings)
    if not rests(projector.system, projector.system.equations(problem.targets)):
        return None
    try:
        return Branch(projector, problem.targets, vertices)
    except SingularMatrixError:
        return None
