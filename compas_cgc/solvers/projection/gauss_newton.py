"""Gauss-Newton with least-norm steps and backtracking."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete import face_normals
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ..constants import LOOSE_RESIDUAL
from ..constants import PATIENCE
from ..constants import SHORTEST
from ..constants import TIGHT_RESIDUAL
from .iterate import Point
from .system import System

__all__ = ["FINISH", "FULFILLED", "Taken", "Turning", "descend", "descend_to_rounding", "line_search"]

DECREASE = 0.1  # fraction of the predicted decrease that a step has to bring; 0.01 accepts steps that rounding makes near convergence
SLOW = 0.9  # factor on the merit within PATIENCE; slower searches do not converge within the step limit
FULFILLED = 1e-8  # residual relative to the prescribed curvature from which steps converge quadratically; the root of the rounding error
FINISH = 4  # steps that have to gain at the end [steps]; rounding level is reached if they do not
TURN = 0.5  # cosine of the largest turn of a face in a step; 60°, a face that turns farther may turn over


class Taken(NamedTuple):
    """A step that was taken."""

    vertices: FloatArray  # (n, 3)
    length: float  # part of the full step
    trials: int
    settled: bool = True  # whether nothing but the equations is left to be met
    equations: Optional[CurvatureEquations] = None  # those that it was for, where they are not the ones asked
    system: Optional[System] = None  # the one that it was taken in, where that has other triangles


def descend(
    system: System,
    equations: CurvatureEquations,
    start: Point,
    slow: float = SLOW,
    patience: int = PATIENCE,
    finish: Optional[int] = None,
) -> Iterator[Taken]:
    """Take steps from a start for as long as `patience` of them bring the merit down to the part `slow`.

    No step starts where every residual is within its rounding: on a flat surface, where no move changes K to first order, it would
    lead anywhere. A start like that is a step of length zero. With a `finish`, so many steps do from where the equations are nearly
    fulfilled.

    The linear systems are solved as loosely as quadratic convergence allows
    (Eisenstat and Walker, doi:10.1137/0917003).
    """
    here, kept = start, None
    merits = [here.merit]
    tolerance = min(LOOSE_RESIDUAL, max(TIGHT_RESIDUAL, system.missing(here, equations)))
    if here.fulfils(0.0, system.floor):
        yield Taken(here.vertices, 0.0, 1)
    while not here.fulfils(0.0, system.floor):
        step, kept = system.step(here, equations, tolerance, kept)
        found = line_search(system, equations, here, step) if np.isfinite(step).all() else None
        if found is None:
            return
        there, length, trials = found
        tolerance = min(LOOSE_RESIDUAL, max(TIGHT_RESIDUAL, (there.merit / here.merit) ** 2))
        here = there
        merits.append(here.merit)
        yield Taken(here.vertices, length, trials)
        if finish is not None and system.missing(here, equations) <= FULFILLED:
            patience, finish, merits = finish, None, [here.merit]
        if len(merits) > patience and merits[-1] > slow * merits[-1 - patience]:
            return


def descend_to_rounding(system: System, equations: CurvatureEquations, start: Point) -> Iterator[Taken]:
    """Take steps from a start, patiently while the equations are far from fulfilled, and until `FINISH` of them gain little then.

    On an irregular mesh some vertex may come near to where no move of its own changes its angles, which takes short steps to pass.
    """
    return descend(system, equations, start, finish=FINISH)


def line_search(system: System, equations: CurvatureEquations, here: Point, step: FloatArray) -> Optional[tuple[Point, float, int]]:
    """Return the first of the halved steps that makes the merit smaller, without a sharp fold."""
    length, trials = 1.0, 0
    turning = Turning(system, here.vertices)
    while length >= SHORTEST:
        trials += 1
        vertices = here.vertices + length * step
        if turning.allows(vertices):
            there = system.at(vertices, equations)
            if there.merit <= (1.0 - DECREASE * length) * here.merit:
                return there, length, trials
        length /= 2
    return None


class Turning:
    """The faces of a shape (n, 3), to be held against those of other shapes.

    Linear equations mean nothing for a move that turns a face over.
    """

    def __init__(self, system: System, vertices: FloatArray):
        self._system = system
        self._normals = face_normals(vertices, system.faces)
        self._folds = np.minimum(system.folds(self._normals), 0.0)

    def allows(self, vertices: FloatArray) -> bool:
        """Return whether no sound face of a shape (n, 3) has turned far, and no edge folds more sharply than a right angle."""
        turned = face_normals(vertices, self._system.faces)
        upright = np.einsum("ij,ij->i", self._normals, turned) >= TURN
        return bool(upright[self._system.sound].all() and (self._system.folds(turned) >= self._folds).all())
