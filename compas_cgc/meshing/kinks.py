"""Kinks of parametric surfaces along lines of constant parameter."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray

__all__ = ["KINK_ANGLE", "angles_between", "sharp_parameters", "sharp_seam"]

KINK_ANGLE = np.radians(10.0)  # least angle between the normals on both sides of a crease
SAMPLES = 16  # sample points along a line
STEP = 1e-5  # distance of the normals from the line, relative to the parameter range


def sharp_parameters(
    evaluate: Callable[[FloatArray], FloatArray], domain: FloatArray, spans: Sequence[Sequence[float]]
) -> list[tuple[int, float]]:
    """Return the kinks of a surface as pairs of parameter axis, 0 or 1, and value.

    A spline surface can have kinks only at knots: at those of full multiplicity, or where control points coincide.

    Parameters
    ----------
    evaluate
        Function from parameters (k, 2) to points (k, 3).
    domain
        ``(2, 2)`` first and last value of each parameter.
    spans
        Knots in both directions.
    """
    found = []
    for axis, knots in enumerate(spans):
        low, high = domain[axis]
        step = STEP * (high - low)
        inside = [knot for knot in np.unique(np.asarray(knots, dtype=np.float64)) if low + 2 * step < knot < high - 2 * step]
        found += [(axis, float(knot)) for knot in inside if _turn(evaluate, domain, axis, knot) > KINK_ANGLE]
    return found


def angles_between(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the angles (k,) between vectors (k, 3) [rad]."""
    return np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), np.einsum("ij,ij->i", one, other))


def _turn(evaluate: Callable[[FloatArray], FloatArray], domain: FloatArray, axis: int, value: float) -> float:
    """Return the largest angle by which the normal turns across a line of constant parameter [rad]."""
    step = STEP * np.ptp(domain[axis])
    one, other = (_normals(evaluate, _along(domain, axis, value + way * step), domain) for way in (-1, 1))
    return float(angles_between(one, other).max())


def sharp_seam(evaluate: Callable[[FloatArray], FloatArray], domain: FloatArray, axis: int, tolerance: float) -> bool:
    """Check whether a surface is closed in a parameter direction, 0 or 1, with a kink at its seam."""
    low, high = domain[axis]
    ends = [evaluate(_along(domain, axis, value)) for value in (low, high)]
    if np.linalg.norm(ends[0] - ends[1], axis=1).max() > tolerance:
        return False
    step = STEP * (high - low)
    one, other = (_normals(evaluate, _along(domain, axis, value), domain) for value in (low + step, high - step))
    return bool(angles_between(one, other).max() > KINK_ANGLE)


def _along(domain: FloatArray, axis: int, value: float) -> FloatArray:
    """Return parameters (k, 2) along a line on which one parameter is constant."""
    parameters = np.full((SAMPLES, 2), value)
    low, high = domain[1 - axis]
    parameters[:, 1 - axis] = np.linspace(low, high, SAMPLES + 2)[1:-1]
    return parameters


def _normals(evaluate: Callable[[FloatArray], FloatArray], parameters: FloatArray, domain: FloatArray) -> FloatArray:
    """Return normals (k, 3) by differences on one side of a line of constant parameter."""
    steps = 0.5 * STEP * np.diag(np.ptp(domain, axis=1))
    u, v = (evaluate(parameters + step) - evaluate(parameters - step) for step in steps)
    return np.cross(u, v)
