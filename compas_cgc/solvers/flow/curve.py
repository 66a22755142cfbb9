"""Curve flow: the flow on a plane curve, Example 1 of the paper."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ...discrete.arrays import FloatArray
from ...discrete.arrays import Mask
from ...errors import names_what_was_meant

__all__ = ["CurveResult", "curve_curvature", "curve_flow"]


class CurveResult(NamedTuple):
    """A curve after the flow.

    Parameters
    ----------
    points
        (n, 2) [L].
    gradient
        (n, 2) last gradient (k - k̄) n, zero at the ends.
    curvature
        (n,) k, NaN at the ends.
    max_error
        Largest |k - k̄| away from the ends and the break.
    history
        (steps,) largest |k - k̄| after every step.

    Examples
    --------
    >>> from compas_cgc.solvers.flow import curve_flow
    >>> arch = np.column_stack([np.linspace(0, 2, 21), np.zeros(21)])
    >>> curve_flow(arch, 0.5, steps=5).points.shape
    (21, 2)
    """

    points: FloatArray  # (n, 2) [L]
    gradient: FloatArray  # (n, 2) last gradient (k - k̄) n, zero at the ends
    curvature: FloatArray  # (n,) k, NaN at the ends
    max_error: float  # largest |k - k̄| away from the ends and the break
    history: FloatArray  # (steps,) largest |k - k̄| after every step


def edge_angles(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return length (n-1,) and anticlockwise angle from the x-axis (n-1,) of every edge."""
    edges = np.diff(points, axis=0)
    return np.linalg.norm(edges, axis=1), np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))


def curve_curvature(points: ArrayLike, kind: str = "C1") -> FloatArray:
    """Return the curvature of every inner vertex of a polyline.

    Parameters
    ----------
    points
        ``(n, 2)`` polyline [L].
    kind
        ``"C1"``: the turning angle, Φ_{i-1} - Φ_i [rad]. ``"C2"``: with the angles
        divided by the edges' lengths, Φ_{i-1}/L_{i-1} - Φ_i/L_i [rad/L].

    Returns
    -------
    (n,) float64
        NaN at the two ends; positive where the curve is convex upwards.

    References
    ----------
    Paper, Section 5.1.
    """
    if kind not in ("C1", "C2"):
        raise ValueError(f"kind must be 'C1' or 'C2', not {kind!r}")
    points = np.asarray(points, dtype=np.float64)
    lengths, angles = edge_angles(points)
    if kind == "C2":
        angles = angles / lengths
    k = np.full(len(points), np.nan)
    k[1:-1] = -np.diff(angles)
    return k


@names_what_was_meant()
def curve_flow(
    points: ArrayLike,
    target: float,
    *,
    kind: str = "C1",
    mu: float = 0.05,
    steps: int = 500,
    crease: Optional[int] = None,
    s: float = 1.0,
    e: int = 0,
) -> CurveResult:
    """Move a polyline with fixed ends until its curvature is the target.

    Without filter and line search, as in the paper.

    Parameters
    ----------
    points
        ``(n, 2)`` polyline [L].
    target
        k̄: an angle for C1, an angle over a length for C2.
    kind
        Definition of curvature, see :func:`curve_curvature`.
    mu
        Constant step length. For C2 it must stay below about half the square of an edge.
    steps
        Steps to take.
    crease
        Vertex at which the curve may break: it takes the mean of its neighbours' gradients.
    s
        Strategy S1: factor on the move of that vertex.
    e
        Strategy S2: first steps in which it waits.

    Returns
    -------
    CurveResult
        The curve, and how far it is from the target.

    References
    ----------
    Paper, Example 1.

    Examples
    --------
    >>> arch = np.column_stack([np.linspace(0, 2, 21), np.zeros(21)])
    >>> curve_flow(arch, 0.5, steps=5).points.shape
    (21, 2)
    """
    P = np.array(points, dtype=np.float64)
    if P.ndim != 2 or P.shape[1] != 2 or len(P) < 3:
        raise ValueError(f"points must have the shape (n, 2) with n >= 3, not {P.shape}")
    asked = np.zeros(len(P), bool)
    asked[1:-1] = True
    if crease is not None:
        if not 2 <= crease <= len(P) - 3:
            raise ValueError(f"crease must be a vertex with two inner neighbours, not {crease}")
        asked[crease] = False
    history = np.empty(steps)
    gradient = np.zeros_like(P)
    k = curve_curvature(P, kind)
    for step in range(1, steps + 1):
        gradient = _gradient(P, k, target, asked, crease)
        move = -mu * gradient
        if crease is not None:
            move[crease] *= s if step > e else 0.0
        P = P + move
        k = curve_curvature(P, kind)
        history[step - 1] = np.abs(k - target)[asked].max()
    return CurveResult(P, gradient, k, float(np.abs(k - target)[asked].max()), history)


def _gradient(P: FloatArray, k: FloatArray, target: float, asked: Mask, crease: Optional[int]) -> FloatArray:
    chord = P[2:] - P[:-2]
    normal = np.zeros_like(P)
    normal[1:-1] = np.column_stack([-chord[:, 1], chord[:, 0]]) / np.linalg.norm(chord, axis=1, keepdims=True)
    gradient = np.where(asked, k - target, 0.0)[:, None] * normal
    if crease is not None:
        gradient[crease] = 0.5 * (gradient[crease - 1] + gradient[crease + 1])
    return gradient
