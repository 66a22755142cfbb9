"""Damped Newton's method: backtracking that keeps a convex surface convex."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Generator
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...model.laws import types_of
from ..constants import ARMIJO
from ..constants import LOOSE_RESIDUAL
from ..constants import PATIENCE
from .system import Shape
from .system import Step
from .system import System

__all__ = ["at_rounding", "damped_newton"]

CRAWL = 0.25  # damping factor of a short step; shorter ones gain less than a quarter of the residual
WORTHWHILE = 0.1  # factor on the residual that a step with old factors has to bring; another one pays if it gains a digit
ROUNDING = 10.0  # multiple of the estimated rounding error up to which a residual is zero; single errors add up over a ring


def damped_newton(system: System, shape: Shape, tolerance: float, shortest: float) -> Generator[Step, None, bool]:
    """Yield Newton's steps until the errors of K are below the tolerance, and return True.

    Return False when no step makes them smaller, or only ever shorter ones do.

    The derivative is exact, the unknowns are moves along the present normals. A step is
    halved while it does not lessen the norm of the residuals, or while it turns a vertex
    inside out that is convex and to stay so (K̄ > 0, H > 0): beyond that the equation is
    not elliptic any more. The last step is repeated with the same factors as long as it
    gains, down to rounding; on large meshes with the derivative renewed.

    Parameters
    ----------
    system
        The problem.
    shape
        The first shape.
    tolerance
        Largest |K - K̄| to stop at, against the largest |K̄|.
    shortest
        Smallest damping factor.

    Raises
    ------
    SingularMatrixError
        If the equations have no solution to first order.
    """
    crawled = 0
    while not system.meets(shape, tolerance):
        J = system.equations.jacobian(shape.vertices, shape.normal)
        move = system.solving_nearly(J, LOOSE_RESIDUAL)(-shape.residual)
        step = _shortened(system, shape, move, shortest)
        crawled = crawled + 1 if step is None or step.length < CRAWL else 0
        if step is None or crawled > PATIENCE:
            return False
        shape = _repeated(system, step.shape, tolerance)
        yield step._replace(shape=shape)
    return True


def at_rounding(system: System, shape: Shape) -> bool:
    """Return whether the residuals are what rounding the coordinates leaves."""
    return bool((np.abs(shape.residual) <= ROUNDING * system.rounding_floor(shape)).all())


def _shortened(system: System, shape: Shape, move: FloatArray, shortest: float) -> Optional[Step]:
    norm = np.linalg.norm(shape.residual)
    convex = (types_of(system.targets) > 0) & (shape.mean > 0)
    length, trials = 1.0, 1
    while length >= shortest:
        there = system.moved(shape, length * move, shape.normal)
        lessened = np.linalg.norm(there.residual) <= (1 - ARMIJO * length) * norm
        if lessened and (there.mean[convex] > 0).all():
            return Step(there, length, trials)
        length, trials = length / 2, trials + 1
    return None


def _repeated(system: System, shape: Shape, tolerance: float) -> Shape:
    """Return the shape after steps with the factors at hand, for as long as they pay."""
    while shape.largest > 0:
        solve: Callable[[FloatArray], FloatArray] = system.solver.solve
        if system.many:
            if system.meets(shape, tolerance):
                return shape
            solve = system.solving_nearly(system.equations.jacobian(shape.vertices, shape.normal), LOOSE_RESIDUAL)
        there = system.moved(shape, solve(-shape.residual), shape.normal)
        if not there.largest < (0.5 if system.meets(shape, tolerance) else WORTHWHILE) * shape.largest:
            return shape
        shape = there
    return shape
