"""NURBS surfaces as arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline

from .arrays import FloatArray

__all__ = ["NurbsPatch"]


class NurbsPatch(NamedTuple):
    """A NURBS surface.

    Parameters
    ----------
    control
        ``(a, b, 4)`` control points in homogeneous coordinates ``(w x, w y, w z, w)`` [L].
    knots
        The knots in both directions, ``(a + degree + 1,)`` and ``(b + degree + 1,)``.
    degrees
        The degrees in both directions.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0.0, 0.0, 1.0, 1.0])
    >>> corners = np.array([[[0, 0, 0, 1], [0, 1, 0, 1]], [[1, 0, 0, 1], [1, 1, 1, 1]]], dtype=float)
    >>> NurbsPatch(corners, (knots, knots), (1, 1)).at(np.array([0.5]), np.array([0.5])).tolist()
    [[[0.5, 0.5, 0.25]]]
    """

    control: FloatArray
    knots: tuple[FloatArray, FloatArray]
    degrees: tuple[int, int]

    def at(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return the points on a grid of parameters (len(u), len(v), 3) [L]."""
        along = BSpline(self.knots[0], self.control, self.degrees[0])(u)
        points: FloatArray = np.swapaxes(BSpline(self.knots[1], np.swapaxes(along, 0, 1), self.degrees[1])(v), 0, 1)
        return points[..., :3] / points[..., 3:]

    def placed(self, origin: FloatArray, axes: FloatArray) -> NurbsPatch:
        """Return the surface with its coordinates along axes (3, 3), the rows, from an origin (3,)."""
        weights = self.control[..., 3:]
        points = self.control[..., :3] @ axes + weights * origin
        return self._replace(control=np.concatenate([points, weights], axis=-1))

    def scaled(self, factor: float) -> NurbsPatch:
        """Return the surface with its coordinates multiplied by a factor."""
        return self._replace(control=self.control * [factor, factor, factor, 1.0])
