"""How much work a solve by `auto` may take: a problem without a surface should be told soon."""

from __future__ import annotations

import math
from typing import Callable
from typing import Optional

from ..linalg.work import Work
from ..linalg.work import rights
from ..model.problem import CGCProblem
from ..model.result import Solution
from .settings import Settings

__all__ = ["AS_MEANT", "DRAWN", "FLOW_STEP", "PLANNED", "Allowance"]

# Right sides solved for, with all coordinates unknown, or what takes as long; a thousand take 0.3 s for 1,000 vertices.
EACH, ALL = 16_500, 20_000
DRAWN = 8000  # of them for a search from a drawn shape, which it has lost by then: smoothed, the drawing leads there sooner
PLANNED = 10_000  # and for one from a plan of many vertices, which another mesh of it leads on from
AS_MEANT = 7000  # for that, so that enough is left to smooth what it comes to
SMALL = 400  # vertices, of which smaller meshes are taken to have as many: they are solved soon, and need as many steps
REASONS = 2500  # more of them for a search for why there is none
FLOW_STEP = 40  # that a step of the flow takes as long as
GIVEN_UP = "; it was given up for the time it takes, method='projection' goes on"


class Allowance:
    """What is left of the work that all methods together may take, counted and not timed: the same input has the same result.

    Parameters
    ----------
    problem
        By its vertices work is counted; goals have no more of it.
    settings
        Steps that are given are bound enough.
    """

    def __init__(self, problem: CGCProblem, settings: Optional[Settings]):
        given = settings is not None and settings.to_dict().get("steps") is not None
        self._unit = rights(1, 3 * max(SMALL, len(problem.vertices)))
        self._left = math.inf if given else ALL * self._unit
        self._dearest = 0.0

    def flow_steps(self, most: int) -> int:
        """Return how many steps of the flow are allowed, at most so many."""
        return min(most, max(1, int(self._left / (FLOW_STEP * self._unit)))) if self._left < math.inf else most

    @property
    def as_much_again(self) -> bool:
        """Whether as much is left as the dearest run has taken so far: what starts from nothing may take that again."""
        return self._left >= self._dearest

    def for_reasons(self) -> Work:
        """Return the work that a search for why there is no fair surface may take: what is left, and what is kept for that."""
        return Work(max(0.0, self._left) + REASONS * self._unit)

    @property
    def spent(self) -> bool:
        """Whether nothing is left."""
        return self._left <= 0.0

    def solved(self, run: Callable[[], Optional[Solution]], most: float = math.inf) -> Optional[Solution]:
        """Return what a run comes to within the work that it may take, at most so much, None where that is nothing."""
        granted = min(self._left, min(EACH, most) * self._unit)
        work = Work(granted if self._left < math.inf else math.inf)
        with work.counted():
            solution = run()
        if self._left < math.inf:
            taken = granted - max(0.0, work.left)
            self._left -= taken
            self._dearest = max(self._dearest, taken)
        if solution is None or not work.spent or solution.status != "stalled":
            return solution
        return solution._replace(message=solution.message + GIVEN_UP)
