"""One call from a mesh to a surface of piecewise constant Gaussian curvature."""

from __future__ import annotations

from typing import Callable
from typing import Optional

import numpy as np

from .datastructures import CGCMesh
from .errors import ProblemError
from .flow import FlowSettings
from .flow import flow
from .problem import DUMMY
from .problem import CGCProblem
from .result import SolveResult
from .result import SolveState

__all__ = ["METHODS", "solve"]

METHODS = ("flow",)


def solve(
    mesh: CGCMesh,
    method: str = "flow",
    settings: Optional[FlowSettings] = None,
    callback: Optional[Callable[[SolveState], object]] = None,
) -> SolveResult:
    """Return the surface whose Gaussian curvature is the target in every region.

    Parameters
    ----------
    mesh
        Mesh with supports, creases and targets; it is not changed. Free edges get a ring
        of dummy faces for the time of the solve.
    method
        ``"flow"``: the paper's filtered Gaussian curvature flow, for K̄ >= 0.
    settings
        Parameters of the method, in model units. Default: scaled from the mesh.
    callback
        Called with a :class:`~compas_cgc.result.SolveState` after every step; return
        True or raise ``StopIteration`` to cancel.

    Returns
    -------
    SolveResult
        With a copy of the mesh; not converging is a result, not an error.

    Raises
    ------
    ProblemError
        With the fatal sentences of :meth:`CGCMesh.check`.
    ValueError
        If the method or a setting is unknown.

    Examples
    --------
    >>> mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    >>> mesh.set_supports("boundary")
    >>> mesh.set_target(0.01)
    >>> solve(mesh).status
    'converged'
    """
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
    fatal = [problem for problem in mesh.check() if problem.fatal]
    if fatal:
        raise ProblemError(fatal)
    problem = CGCProblem.from_mesh(mesh)
    real = problem.roles != DUMMY
    count = len(problem.vertices)
    solution = flow(problem.with_dummy_ring(), settings, _real_only(callback, count, real))
    return SolveResult(
        mesh=mesh.with_coordinates(solution.vertices[:count][real]),
        status=solution.status,
        message=solution.message,
        iterations=solution.iterations,
        seconds=solution.seconds,
        max_error=solution.max_error,
        history=solution.history,
        method=method,
    )


def _real_only(
    callback: Optional[Callable[[SolveState], object]], count: int, real: np.ndarray
) -> Optional[Callable[[SolveState], object]]:
    """Return the callback with the dummies taken out of what it sees."""
    if callback is None:
        return None
    return lambda state: callback(state._replace(vertices=state.vertices[:count][real]))
