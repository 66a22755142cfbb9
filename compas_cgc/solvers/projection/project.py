"""One call from a problem to the nearest fair surface of the curvature asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Callable
from typing import Optional

from ...model.constraints import Constraint
from ...model.problem import CGCProblem
from ...model.result import Solution
from ...model.result import SolveState
from .projector import Projector
from .settings import ProjectionSettings

__all__ = ["project"]


def project(
    problem: CGCProblem,
    settings: Optional[ProjectionSettings] = None,
    constraints: Sequence[Constraint] = (),
    callback: Optional[Callable[[SolveState], object]] = None,
) -> Solution:
    r"""Move the vertices by the least that gives them the curvature asked for.

    Unknown are the three coordinates of every vertex that may move; there is an equation
    :math:`r_i = \text{defect}_i - \bar K_i A_i = 0` at every internal vertex, and none on
    creases and free edges. Of the many solutions, every step of Gauss-Newton takes the one
    that is smallest in a fairness metric,

    .. math:: \min \tfrac12\, dx^T W\, dx \quad \text{subject to} \quad J\, dx = -r,

    with W the area-weighted distance plus the bending energy of the move, and is shortened
    until it brings what it promises. K may have any sign; no dummy mesh is needed.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets. The vertices are the shape to stay near to.
    settings
        Parameters.
    constraints
        What is asked of vertices besides K; lengths in model units.
    callback
        Called with a :class:`~compas_cgc.model.result.SolveState` after every step. To cancel,
        return True or raise ``StopIteration``.

    Returns
    -------
    Solution
        With the best shape that was reached.

    Raises
    ------
    ProblemError
        If a constraint cannot be.

    References
    ----------
    Tang, Sun, Gomes, Wallner, Pottmann, *Form-finding with polyhedral meshes made simple*,
    doi:10.1145/2601097.2601213.
    """
    return Projector(problem, settings, constraints).solve(callback=callback)
