"""Newton's method with one K as an unknown, and one goal of the whole surface as the equation for it."""

from __future__ import annotations

from collections.abc import Generator
from typing import Optional

import numpy as np

from ...linalg import SingularMatrixError
from ...model.goals.binding import Equation
from ...model.laws import types_of
from ..constants import ARMIJO
from ..constants import LOCAL_ROUNDING
from ..constants import MAX_STEPS
from .elliptic import elliptic_steps
from .globalization import is_near
from .settings import NewtonSettings
from .system import Shape
from .system import Step
from .system import System

__all__ = ["Sought", "steps_to_goal"]

LARGEST = 0.5  # largest relative change of K in a step; keeps the sign of K
GUESSES = 6  # halvings of the guessed K; the cap over a disk has a larger K than narrower plans can have, up to 64 times

Sought = tuple[str, str, System]  # status, what was noticed, and the system with the K that was found


def steps_to_goal(system: System, start: Shape, goal: Equation, settings: NewtonSettings) -> Generator[Step, None, Sought]:
    r"""Yield steps to the shape and the K that meet the goal c; return how they ended, and the system with that K.

    Elliptic steps lead to the guessed K, unless the start is near that, or to the first of its halves that the rim carries. Every step
    from there solves

    .. math:: \begin{pmatrix} J & -A \\ \nabla c & 0 \end{pmatrix} \begin{pmatrix} du \\ dK \end{pmatrix}
              = \begin{pmatrix} -r \\ h - c \end{pmatrix}

    by two solutions of one factorisation.
    """
    shape, K = start, float(system.problem.targets[system.asked[0]])
    begun = is_near(system, start)
    for _ in range(GUESSES):
        if begun:
            break
        shape, begun = yield from _begun(system.with_curvature(K), start, settings)
        K = K if begun else 0.5 * K
    try:
        for _ in range(MAX_STEPS):
            own = system.with_curvature(K)
            shape = own.measure(shape.vertices)
            if own.meets(shape, settings.tolerance) and abs(goal.value(shape.vertices) - goal.wanted) <= LOCAL_ROUNDING:
                return "converged", "", own
            found = _step(own, shape, K, goal, settings.shortest)
            if found is None:
                return "stalled", "target", own
            step, K = found
            shape = step.shape
            yield step
    except SingularMatrixError:
        return "stalled", "singular", system
    return "stalled", "target", system.with_curvature(K)


def _begun(system: System, start: Shape, settings: NewtonSettings) -> Generator[Step, None, tuple[Shape, bool]]:
    """Yield elliptic steps; return where they end, and whether that is near the targets."""
    steps, shape = elliptic_steps(system, start, settings.anisotropy), start
    while True:
        try:
            step = next(steps)
        except StopIteration as end:
            return shape, end.value
        except SingularMatrixError:
            return shape, False
        shape = step.shape
        yield step


def _step(system: System, shape: Shape, K: float, goal: Equation, shortest: float) -> Optional[tuple[Step, float]]:
    """Return the first of the halved steps that lessens what is missing and keeps what is convex so, and its K."""
    factor = system.solver.factorise(system.equations.jacobian(shape.vertices, shape.normal))
    both = factor.solve(np.column_stack([-shape.residual, shape.area]))
    slope = np.einsum("ij,ij->i", goal.gradient(shape.vertices)[system.asked], shape.normal)
    short = goal.wanted - goal.value(shape.vertices)
    answer = float(slope @ both[:, 1])
    if answer == 0.0 or not np.isfinite(answer):
        return None
    change = (short - float(slope @ both[:, 0])) / answer
    change = float(np.clip(change, -LARGEST * abs(K), LARGEST * abs(K)))
    move = both[:, 0] + change * both[:, 1]
    before = _missing(system, shape, goal)
    convex = (types_of(system.targets) > 0) & (shape.mean > 0)
    length, trials = 1.0, 1
    while length >= shortest:
        other = system.with_curvature(K + length * change)
        there = other.moved(shape, length * move, shape.normal)
        # Near the end a step is rounding; there it has only to do no harm.
        if _missing(other, there, goal) <= max((1 - ARMIJO * length) * before, LOCAL_ROUNDING) and (there.mean[convex] > 0).all():
            return Step(there, length, trials), K + length * change
        length, trials = length / 2, trials + 1
    return None


def _missing(system: System, shape: Shape, goal: Equation) -> float:
    """Return the norm of what is missing, of defects and of the goal."""
    return float(np.hypot(np.linalg.norm(shape.residual), goal.value(shape.vertices) - goal.wanted))
