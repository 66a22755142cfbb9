"""Weights of distances by place."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..errors import CGCError

__all__ = ["importance_at"]


def importance_at(points: Vertices, places: ArrayLike) -> FloatArray:
    """Return the factors (n,) by which distances at points (n, 3) are multiplied.

    Parameters
    ----------
    points
        Points of the design [L].
    places
        Rows (k, 5) of x, y, z, radius, factor, or their numbers one after another: the factor counts within this radius of the point
        [L]. Where places overlap the last one counts.

    Raises
    ------
    CGCError
        If rows are wrong, or no point of the design is within a radius.
    """
    try:
        rows = np.asarray(places, dtype=np.float64)
        rows = rows.reshape(-1, 5) if rows.ndim == 1 else rows
        if rows.ndim != 2 or rows.shape[1] != 5 or not (np.isfinite(rows).all() and (rows[:, 3:] > 0.0).all()):
            raise ValueError
    except (TypeError, ValueError):
        raise CGCError(f"weights must be rows x, y, z, radius, factor with radius and factor above zero, not {places!r:.80}") from None
    factors = np.ones(len(points))
    for *place, radius, factor in rows.tolist():
        away = np.linalg.norm(points - place, axis=1)
        if not (away <= radius).any():
            x, y, z = place
            raise CGCError(
                f"no vertex of the panels is within {radius:.3g} of the weight at ({x:.3g}, {y:.3g}, {z:.3g}); "
                f"the nearest is {away.min():.3g} away: move it to the design, or enlarge its radius"
            )
        factors[away <= radius] = factor
    return factors
