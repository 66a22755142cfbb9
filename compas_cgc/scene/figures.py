"""Vertex colours: quantities at the vertices of a CGC mesh, and their colours."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..io.rhino.colours import largest
from ..io.rhino.colours import signed_colours
from ..model.measures import measured_curvature
from ..model.measures import measured_mean_curvature
from ..model.problem import PosesProblem

__all__ = ["FIGURES", "Coloured", "coloured", "figures"]

FIGURES = ("K", "H", "k_max", "k_min", "error")


class Coloured(NamedTuple):
    """Colours of a quantity."""

    values: FloatArray  # (n,) NaN where undefined
    limit: float  # largest |value|
    colours: IntArray  # (n, 3) red, green, blue, 0..255


def coloured(mesh: PosesProblem, show: str = "K") -> Coloured:
    """Return the colours of a quantity at each vertex: blue below zero, white at zero, red above, grey where undefined.

    Raises
    ------
    ValueError
        If the quantity is unknown.
    """
    if show not in FIGURES:
        raise ValueError(f"show must be one of {', '.join(FIGURES)}, not {show!r}")
    values = figures(mesh)[show]
    limit = largest(values)
    return Coloured(values, limit, signed_colours(values, limit))


def figures(surface: PosesProblem) -> dict[str, FloatArray]:
    """Return K [1/L^2], H, the principal curvatures [1/L] and K - K̄ [1/L^2] at each vertex (n,), NaN where K is not read."""
    problem = surface.to_problem().without_dummies()
    K, H = measured_curvature(problem), measured_mean_curvature(problem)
    # Where the two principal curvatures are equal, rounding, or a second measure of K, can make H² smaller than K.
    half = np.sqrt(np.maximum(H * H - K, 0.0))
    return dict(zip(FIGURES, (K, H, H + half, H - half, K - problem.targets)))
