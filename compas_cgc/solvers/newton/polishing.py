"""Iterative refinement in model coordinates: the last digits of a converged shape."""

from __future__ import annotations

import numpy as np

from ...discrete import _kernels
from ...discrete.arrays import FloatArray
from ...discrete.space_form import EXACT
from ...discrete.space_form import space_form_angle_sums
from ...linalg import SingularMatrixError
from ...model.frame import Frame
from ...model.problem import CGCProblem
from ..constants import ANGLE_ROUNDING
from ..constants import WORTHWHILE
from .system import System

__all__ = ["model_errors", "polished"]


def model_errors(problem: CGCProblem, vertices: FloatArray, measure: str = "defect") -> tuple[FloatArray, FloatArray]:
    """Return the residuals [rad] and K - K̄ [1/L^2] in a measure, at the vertices where K is asked for, (k,) each."""
    asked = problem.asked
    angle, area = (values[asked] for values in _kernels.angle_sums_and_areas(vertices, problem.faces, _kernels.MIXED))
    if measure in EXACT:
        K = np.where(asked, problem.targets, 0.0)
        residual = 2 * np.pi - space_form_angle_sums(vertices, problem.faces, K, measure == "exact-arc")[asked]
    else:
        residual = 2 * np.pi - angle - problem.targets[asked] * area
    return residual, np.divide(residual, area, out=np.full(len(area), np.inf), where=area > 0)


def polished(system: System, problem: CGCProblem, frame: Frame, vertices: FloatArray, measure: str = "defect") -> FloatArray:
    """Return a converged shape with the rounding of its coordinates made up for.

    Where a surface is steep at a fixed edge, rounding a coordinate moves the defects far
    more than their own rounding does. So the last corrections leave two coordinates of
    every vertex as they are and change the third, the one across most of the surface;
    over a plan near the origin it is the smallest and has digits to spare.

    Parameters
    ----------
    system
        The problem in its local frame.
    problem, frame
        The problem in the model, and the way there.
    vertices
        ``(n, 3)`` the last shape in the model.
    measure
        Of K, which the system is for.
    """
    residual = model_errors(problem, vertices, measure)[0]
    if np.abs(residual).max() <= ANGLE_ROUNDING:
        return vertices
    local = frame.to_local(vertices)
    axis = int(np.argmax(np.abs(system.measure(local).normal).sum(axis=0)))
    directions = np.zeros((len(system.asked), 3))
    directions[:, axis] = 1.0
    try:
        system.solver.factorise(system.equations.jacobian(local, directions))
        while True:
            trial = vertices.copy()
            trial[system.asked, axis] += frame.scale * system.solver.solve(-residual)
            remaining = model_errors(problem, trial, measure)[0]
            if not np.abs(remaining).max() < WORTHWHILE * np.abs(residual).max():
                return vertices
            vertices, residual = trial, remaining
    except SingularMatrixError:
        return vertices
