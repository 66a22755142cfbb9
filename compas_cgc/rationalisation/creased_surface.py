"""Spline surfaces that fold along creases."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .cut_functions import CutFunctions
from .spline_surface import SplineSurface

__all__ = ["CreasedSurface"]


@dataclass(frozen=True, eq=False)
class CreasedSurface(SplineSurface):
    """A bicubic spline surface with creases, on both sides of which its basis functions have control points of their own.

    Parameters
    ----------
    further
        ``(e, 4)`` further control points in homogeneous coordinates, those of the other parts of cut functions [L].
    cut
        The functions that are cut.
    """

    further: FloatArray
    cut: CutFunctions

    def _net(self, uv: FloatArray, i: IntArray, j: IntArray) -> FloatArray:
        low, high = self.domain.T
        inside = np.where(self.closed, low + np.mod(uv - low, high - low), np.clip(uv, low, high))
        faces = self.cut.faces_at(inside, i, j)
        every = np.concatenate([self.control.reshape(-1, 4), self.further])
        return every[self.cut.control_points(i, j, faces)]
