"""Free edges for methods that need a closed ring of faces around every vertex: a dummy ring for the time of the solve."""

from __future__ import annotations

from typing import Any
from typing import Callable

from ..model.dummy_ring import with_dummy_ring
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import Solution
from ..model.result import SolveState

__all__ = ["solve_carried"]


def solve_carried(solver: Callable[..., Solution], problem: CGCProblem, settings: Any, callback: Callback) -> Solution:
    """Solve with K asked for on free edges too, and return the solution without the ring that carried them.

    Parameters
    ----------
    solver
        Called with the carried problem, ``settings`` and ``callback``.
    problem
        Vertices, faces, roles and targets.
    settings
        Of the solver.
    callback
        Called after every step; it sees the vertices of the problem only.
    """
    own = len(problem.vertices)

    def told(state: SolveState) -> object:
        return callback and callback(state._replace(vertices=state.vertices[:own]))

    solution = solver(with_dummy_ring(problem), settings=settings, callback=callback and told)
    targets = None if solution.targets is None else solution.targets[:own]
    return solution._replace(vertices=solution.vertices[:own], targets=targets)
