"""One call from a mesh to a surface of piecewise constant Gaussian curvature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Callable
from typing import Optional

import numpy as np

from ..datastructures import CGCMesh
from ..datastructures.check import problems_of_keys
from ..model.checks import Names
from ..model.checks import check
from ..model.checks import refuse
from ..model.problem import DUMMY
from ..model.problem import CGCProblem
from ..model.result import Solution
from ..model.result import SolveResult
from ..model.result import SolveState
from .registry import METHODS
from .registry import SETTINGS
from .registry import run
from .selection import run_auto

if TYPE_CHECKING:
    from ..model.constraints import Constraint
    from .registry import Settings

__all__ = ["METHODS", "solve", "solve_problem"]


def solve(
    mesh: CGCMesh,
    method: str = "auto",
    settings: Optional[Settings] = None,
    callback: Optional[Callable[[SolveState], object]] = None,
    constraints: Sequence[Constraint] = (),
) -> SolveResult:
    """Return the surface whose Gaussian curvature is the target in every region.

    Parameters
    ----------
    mesh
        Mesh with supports, creases and targets; it is not changed.
    method
        ``"auto"`` (default)
            Picks one of the others by the problem and the settings, says which and why,
            and tries the next when one stalls.
        ``"flow"``
            The paper's filtered Gaussian curvature flow with its strategies for creases,
            for K̄ >= 0, finished by Newton's method.
        ``"newton"``
            One unknown per vertex along its normal; for K̄ > 0 over fixed edges, or from
            a start near the target; creases are held. The fastest on large meshes.
        ``"projection"``
            The fair surface nearest to the mesh, for K̄ of any sign, with free edges and
            creases and with constraints.
    settings
        :class:`FlowSettings`, :class:`NewtonSettings` or :class:`ProjectionSettings`;
        with ``"auto"`` they choose their method.
    callback
        Called with a :class:`~compas_cgc.model.result.SolveState` after every step; return
        True or raise ``StopIteration`` to cancel.
    constraints
        What is asked of vertices besides K, see :mod:`compas_cgc.model.constraints`.
        Vertices are counted in the order of ``mesh.vertices()``.

    Returns
    -------
    SolveResult
        With a copy of the mesh; not converging is a result, not an error.

    Raises
    ------
    ProblemError
        With the fatal sentences of :meth:`CGCMesh.check`.
    ValueError
        If the method is unknown, or the settings or constraints belong to another.

    Examples
    --------
    >>> mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    >>> mesh.set_supports("boundary")
    >>> mesh.set_target(0.01)
    >>> result = solve(mesh)
    >>> result.status, result.method
    ('converged', 'newton')
    """
    _check_arguments(method, settings, constraints)
    refuse(problems_of_keys(mesh))
    problem = CGCProblem.from_mesh(mesh)
    solution = solve_problem(problem, method, settings, callback, constraints, mesh.names())
    return SolveResult(mesh.with_coordinates(solution.vertices[problem.roles != DUMMY]), *solution[1:])


def solve_problem(
    problem: CGCProblem,
    method: str = "auto",
    settings: Optional[Settings] = None,
    callback: Optional[Callable[[SolveState], object]] = None,
    constraints: Sequence[Constraint] = (),
    names: Optional[Names] = None,
) -> Solution:
    """Solve a problem of arrays, see :func:`solve`.

    Parameters
    ----------
    problem
        Vertices and faces with roles, targets and creases.
    method, settings, constraints
        As for :func:`solve`; constraints name vertices by their positions.
    callback
        As for :func:`solve`; it sees the real vertices only.
    names
        What sentences call vertices and faces. Default: their positions.

    Returns
    -------
    Solution
        With all vertices of the problem, in its order.

    Raises
    ------
    ProblemError
        With the fatal sentences of :func:`compas_cgc.model.checks.check`.
    ValueError
        If the method is unknown, or the settings or constraints belong to another.
    """
    _check_arguments(method, settings, constraints)
    refuse(check(problem, names))
    seen = _real_only(callback, problem.roles != DUMMY)
    if method == "auto":
        return run_auto(problem, settings, constraints, seen)
    return run(method, problem, settings, constraints, seen)


def _check_arguments(method: str, settings: Optional[Settings], constraints: Sequence[Constraint]) -> None:
    known = ("auto", *METHODS)
    if method not in known:
        raise ValueError(f"method must be one of {', '.join(known)}, not {method!r}")
    kinds = tuple(SETTINGS.values()) if method == "auto" else (SETTINGS[method],)
    if settings is not None and not isinstance(settings, kinds):
        names = " or ".join(kind.__name__ for kind in kinds)
        raise ValueError(f"the method {method!r} takes {names}, not {type(settings).__name__}")
    if constraints and (method not in ("auto", "projection") or isinstance(settings, (SETTINGS["flow"], SETTINGS["newton"]))):
        raise ValueError("only the method 'projection' holds constraints; use it, or 'auto' without settings of another method")


def _real_only(callback: Optional[Callable[[SolveState], object]], real: np.ndarray) -> Optional[Callable[[SolveState], object]]:
    """Return the callback with the dummies taken out of what it sees."""
    if callback is None:
        return None
    return lambda state: callback(state._replace(vertices=state.vertices[real]))
