"""How much work a solve by `auto` may take: a problem without a surface should be told soon."""

from __future__ import annotations

import math
from typing import Callable
from typing import Optional
from typing import TypeVar

from ..errors import joined
from ..linalg.work import Work
from ..linalg.work import rights
from ..model.problem import CGCProblem
from ..model.result import Solution
from .settings import Settings

__all__ = ["FLOW_STEP", "Allowance"]

EACH = 16_500  # work of one attempt [right sides]; a thousand take 0.3 s for 1,000 vertices, so an attempt ends after 5 s
ALL = 20_000  # work of all attempts [right sides]; six seconds for 1,000 vertices, so that a second attempt remains after a long one
SMALL = 400  # vertices that smaller meshes are counted as [vertices]; they need as many steps as larger ones, and each takes little time
REASONS = 2500  # work reserved for a search for the reason of a failure [right sides]; less than a second for 1,000 vertices
FLOW_STEP = 40  # work of a step of the flow [right sides]; estimate of the time, which affects the work limit only
GIVEN_UP = "; this attempt reached the limit on computation, which method='projection' does not have"


Found = TypeVar("Found", Solution, Optional[Solution])


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

    def for_reasons(self) -> Work:
        """Return the work that a search for why there is no fair surface may take: what is left, and what is kept for that."""
        return Work(max(0.0, self._left) + REASONS * self._unit)

    @property
    def spent(self) -> bool:
        """Whether nothing is left."""
        return self._left <= 0.0

    def solved(self, run: Callable[[], Found]) -> Found:
        """Return the solution of a run within the work that it may take, None if the run has none."""
        granted = min(self._left, EACH * self._unit)
        work = Work(granted if self._left < math.inf else math.inf)
        with work.counted():
            solution = run()
        if self._left < math.inf:
            self._left -= granted - max(0.0, work.left)
        if solution is None or not work.spent or solution.status != "stalled":
            return solution
        return solution._replace(message=joined([solution.message, GIVEN_UP], ""))
