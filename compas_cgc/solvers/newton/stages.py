"""Stages of a solve: from a shape that has its K by angle defects on to one that has it in the measure asked for."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.smooth_measure import is_irregular
from ...discrete.space_form import EXACT
from .system import Shape
from .system import System

__all__ = ["Stages"]

ROUNDS = 20  # of the smooth measure
STILL = 1e-10  # change of its targets, against the largest, that is none
SLOW = 0.95  # ratio of two changes in turn up to which a target is extrapolated


class Stages:
    """The systems of one solve, the first by angle defects.

    The targets of the smooth measure follow the shape until they stand still, a deferred correction (Stetter,
    doi:10.1007/BF01432879); as each depends on few vertices around its own, each is sped up on its own (Aitken).

    Parameters
    ----------
    first
        The system by angle defects.
    measure
        The one asked for.
    """

    def __init__(self, first: System, measure: str):
        self.first, self.measure = first, measure
        self.rounds: list[FloatArray] = []  # targets since the last extrapolation
        self.count = 0

    def following(self, system: System, shape: Shape) -> Optional[System]:
        """Return the system to go on with from a shape that meets one; None where that was the last."""
        first = self.first
        if self.measure in EXACT:
            exact = first.exactly(self.measure)
            return exact if system is first else None
        problem = first.problem
        if self.measure == "defect" or not problem.real_faces.all() or self.count == ROUNDS:
            # With dummies fits would look across the edge at faces that are not there.
            return None
        if self.measure == "auto" and system is first and not is_irregular(shape.vertices, problem.faces, problem.asked, problem.targets):
            return None
        self.count += 1
        targets = first.smooth_targets(shape.vertices)
        if np.abs(targets - system.equations.targets)[first.asked].max(initial=0.0) <= STILL * first.scale:
            return None
        return first.with_targets(self._sped_up(targets))

    def _sped_up(self, targets: FloatArray) -> FloatArray:
        self.rounds.append(targets)
        if len(self.rounds) < 3:
            return targets
        one, two, three = self.rounds
        self.rounds = []
        with np.errstate(all="ignore"):
            ratio = (three - two) / (two - one)
            limit = three + (three - two) * ratio / (1.0 - ratio)
        return np.where(np.isfinite(limit) & (np.abs(ratio) < SLOW), limit, three)

    def measure_of(self, system: System) -> str:
        """Return the measure in which a shape that meets a system has its targets."""
        if system is self.first:
            return "defect"
        return self.measure if self.measure in EXACT else "smooth"
