"""One call from a problem to the fairest surface of the curvature asked for."""

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
    r"""Return the fairest surface with the curvature asked for.

    Unknown are the three coordinates of every vertex that may move; there is an equation
    :math:`r_i = \text{defect}_i - \bar K_i A_i = 0` at every internal vertex, and none on
    creases and free edges. Of the many solutions it is one that bends least, and keeps to the
    drawing as far as the settings say,

    .. math:: \min \tfrac12\, x^T B x + \tfrac12\, |x - x_0|^2 \quad \text{subject to} \quad r(x) = 0,

    with B the bending energy of the shape and the distance weighed apart in plan and height. The
    way there is sequential quadratic programming from starts of its own or the one given, then Newton's
    method with the second derivatives of the equations, then least-norm steps to rounding. K may
    have any sign; no dummy mesh is needed.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets. The vertices are the drawing, of which the settings say what is kept.
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
    doi:10.1145/2601097.2601213. Bergou, Wardetzky, Harmon, Zorin, Grinspun, *A quadratic bending model for
    inextensible surfaces*, doi:10.2312/SGP/SGP06/227-230.
    """
    return Projector(problem, settings, constraints).solve(callback=callback)
