"""Stages of a solve: from a shape that has its K by angle defects on to one that has it in the measure asked for."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.smooth_measure import is_irregular
from ...discrete.space_form import EXACT
from ...model.tolerances import ROUNDING
from ..constants import CONVERGED
from .globalization import is_near
from .system import Shape
from .system import System

__all__ = ["Stages"]

ROUNDS = 20  # rounds of the smooth measure [rounds]; bounds the time where the layout error changes with every round
KEPT = 4  # rounds from which the next targets are mixed [rounds]; older ones belong to shapes too far away (Anderson mixing)


class Stages:
    """The systems of one solve, the first by angle defects.

    What the layout of the mesh adds to angle defects follows the shape until it stands still, a deferred correction (Stetter,
    doi:10.1007/BF01432879), mixed from the last rounds (Anderson, doi:10.1145/321296.321305).

    Parameters
    ----------
    first
        The system by angle defects.
    measure
        The one asked for.
    tolerance
        Change of the layout, relative to the largest target, that counts as none; at least what rounding leaves.
    """

    def __init__(self, first: System, measure: str, tolerance: float):
        self.first, self.measure, self.still = first, measure, max(CONVERGED, tolerance)
        self.rounds: list[tuple[FloatArray, FloatArray]] = []  # layouts that were met, and those of the shape then
        self.count = 0

    def beginning(self, shape: Shape) -> System:
        """Return the system to begin with: of a shape near to its targets in the smooth measure, that of these."""
        first = self.first
        half = len(shape.curvature) and float(np.median(np.abs(shape.curvature))) > 0.5 * first.scale
        if self.measure != "smooth" or not first.problem.real_faces.all() or not half:
            return first
        told = first.with_layout(first.layout_at(shape.vertices))
        return told if is_near(told, told.measure(shape.vertices)) else first

    def following(self, system: System, shape: Shape) -> Optional[System]:
        """Return the system to go on with from a shape that meets one; None where that was the last."""
        first = self.first
        if self.measure in EXACT:
            exact = first.exactly(self.measure)
            return exact if system is first else None
        problem = system.problem
        if self.measure == "defect" or not problem.real_faces.all() or self.count == ROUNDS:
            # With dummies fits would look across the edge at faces that are not there.
            return None
        if self.measure == "auto" and not self.count and not is_irregular(shape.vertices, problem.faces, problem.asked, problem.targets):
            return None
        self.count += 1
        met, told = system.layout, system.layout_at(shape.vertices)
        if np.abs(told - met)[system.asked].max(initial=0.0) <= self.still * system.scale:
            return None
        self.rounds = [*self.rounds[-KEPT:], (met, told)]
        return system.with_layout(self._mixed())

    def _mixed(self) -> FloatArray:
        """Return the layout that would stand still, were that of a shape linear in the one it met."""
        met, told = (np.array(layouts).T for layouts in zip(*self.rounds))
        if met.shape[1] == 1:
            return told[:, -1]
        left = (told - met)[self.first.asked]
        share = np.linalg.lstsq(np.diff(left), left[:, -1], rcond=ROUNDING)[0]
        return told[:, -1] - np.diff(told) @ share

    def measure_of(self, system: System) -> str:
        """Return the measure in which a shape that meets a system has its targets."""
        if self.measure in EXACT:
            return "defect" if system is self.first else self.measure
        return "smooth" if system.layout.any() else "defect"
