"""Globalization: which steps a solve takes, one start after the other."""

from __future__ import annotations

from collections.abc import Generator
from typing import Union

import numpy as np

from ...discrete.space_form import SpaceFormEquations
from ...linalg import SingularMatrixError
from ...meshing.existence import Overload
from ...meshing.existence import overload
from ...model.laws import types_of
from ..constants import RUNAWAY
from ..constants import WITHIN_REACH
from .damped import at_rounding
from .damped import damped_newton
from .elliptic import elliptic_steps
from .membrane import membrane
from .settings import NewtonSettings
from .system import Shape
from .system import Step
from .system import System

__all__ = ["Outcome", "exact_steps", "is_near", "steps_of"]

BOUNDS = (1.0, 10.0, 100.0)  # factors on Λ of successive starts; three decades between a well-posed and an exact operator
SAME = 1e-3  # distance relative to the diagonal up to which two starts are the same; Newton's method leads to the same surface from both

Outcome = tuple[str, Union[str, Overload]]  # status, and what was noticed where it is not "converged"


class _RanAway(Exception):
    pass


def steps_of(system: System, start: Shape, settings: NewtonSettings) -> Generator[Step, None, Outcome]:
    """Yield the steps of a solve, and return how it ended.

    From a start near the target, or where the settings say so, Newton's method right
    away; else after elliptic steps from there; if that fails, the same from a membrane.
    """
    if system.meets(start, settings.tolerance):
        return "converged", ""
    only_given = settings.start == "given" or bool((types_of(system.targets) < 0).any())
    near = settings.start == "auto" and is_near(system, start)
    try:
        if only_given or near:
            outcome = yield from _by_newton(system, start, settings)
            if only_given or outcome == "converged":
                return outcome, "start"
        own = system.problem
        excess = overload(start.vertices, own.faces, own.targets, own.asked)
        if excess is not None:
            return "infeasible", excess
        outcome = yield from _from_elliptic(system, start, settings)
        if outcome != "converged":
            taut = membrane(system)
            if float(np.abs(taut - start.vertices).max()) > SAME * system.size:
                outcome = yield from _from_elliptic(system, system.measure(taut), settings)
    except SingularMatrixError:
        return "stalled", "singular"
    return outcome, "target"


def exact_steps(system: System, shape: Shape, settings: NewtonSettings) -> Generator[Step, None, Outcome]:
    """Yield Newton's steps from a solved shape to one that is exact, and return how they ended."""
    if isinstance(system.equations, SpaceFormEquations):
        complaint = system.equations.complaint(shape.vertices)
        if complaint:
            return "infeasible", complaint
    try:
        return (yield from _by_newton(system, shape, settings)), "start"
    except SingularMatrixError:
        return "stalled", "singular"


def is_near(system: System, shape: Shape) -> bool:
    """Return whether Newton's method needs no other start than a shape."""
    scale = np.where(types_of(system.targets) > 0, system.targets, system.scale)
    return bool((np.abs(shape.curvature - system.targets) <= WITHIN_REACH * scale).all())


def _by_newton(system: System, shape: Shape, settings: NewtonSettings) -> Generator[Step, None, str]:
    """Yield Newton's steps and return how they ended."""
    steps = damped_newton(system, shape, settings.tolerance, settings.shortest)
    try:
        shape, below = yield from _followed(system, shape, steps)
    except _RanAway:
        return "diverged"
    return "converged" if below or at_rounding(system, shape) else "stalled"


def _from_elliptic(system: System, shape: Shape, settings: NewtonSettings) -> Generator[Step, None, str]:
    """Yield elliptic steps, then Newton's; where only those stall, go on nearer to their equations. Return how it ended."""
    outcome = "stalled"
    for factor in BOUNDS:
        try:
            shape, near = yield from _followed(system, shape, elliptic_steps(system, shape, factor * settings.anisotropy))
        except _RanAway:
            return "diverged"
        outcome = yield from _by_newton(system, shape, settings)
        if outcome == "converged" or not near:
            break
    return outcome


def _followed(system: System, shape: Shape, steps: Generator[Step, None, bool]) -> Generator[Step, None, tuple[Shape, bool]]:
    """Yield the steps; return the last shape and what the steps return."""
    while True:
        try:
            step = next(steps)
        except StopIteration as end:
            return shape, end.value
        shape = step.shape
        far = float(np.abs(shape.vertices - system.problem.vertices).max())
        if not (np.isfinite(shape.largest) and far < RUNAWAY * system.size):
            raise _RanAway
        yield step
