"""Where parametric surfaces bend sharply along a line of constant parameter."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray

__all__ = ["JOINT", "angles_between", "sharp_parameters", "sharp_seam"]

JOINT = np.radians(10.0)  # angle between the normals on both sides from which a line is a crease
SAMPLES = 16  # places along a line where it is measured
STEP = 1e-5  # of the range of a parameter, to either side


def sharp_parameters(
    evaluate: Callable[[FloatArray], FloatArray], domain: FloatArray, spans: Sequence[Sequence[float]]
) -> list[tuple[int, float]]:
    """Return where the normal of a surface turns sharply: which parameter, 0 or 1, has which value there.

    A surface of splines can do so at its knots only: at those of full multiplicity, or where control points lie on each other.

    Parameters
    ----------
    evaluate
        Returns the places (k, 3) of parameters (k, 2).
    domain
        ``(2, 2)`` first and last value of each parameter.
    spans
        The knots in each direction.
    """
    found = []
    for axis, knots in enumerate(spans):
        low, high = domain[axis]
        step = STEP * (high - low)
        inside = [knot for knot in np.unique(np.asarray(knots, dtype=np.float64)) if low + 2 * step < knot < high - 2 * step]
        found += [(axis, float(knot)) for knot in inside if _turn(evaluate, domain, axis, knot) > JOINT]
    return found


def angles_between(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the angles (k,) between vectors (k, 3) [rad]."""
    return np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), np.einsum("ij,ij->i", one, other))


def _turn(evaluate: Callable[[FloatArray], FloatArray], domain: FloatArray, axis: int, value: float) -> float:
    """Return the angle by which the normal turns across a line of constant parameter, at most [rad]."""
    step = STEP * np.ptp(domain[axis])
    one, other = (_normals(evaluate, _along(domain, axis, value + way * step), domain) for way in (-1, 1))
    return float(angles_between(one, other).max())


def sharp_seam(evaluate: Callable[[FloatArray], FloatArray], domain: FloatArray, axis: int, tolerance: float) -> bool:
    """Tell whether a surface closes in the direction of a parameter, 0 or 1, and bends sharply where it does."""
    low, high = domain[axis]
    ends = [evaluate(_along(domain, axis, value)) for value in (low, high)]
    if np.linalg.norm(ends[0] - ends[1], axis=1).max() > tolerance:
        return False
    step = STEP * (high - low)
    one, other = (_normals(evaluate, _along(domain, axis, value), domain) for value in (low + step, high - step))
    return bool(angles_between(one, other).max() > JOINT)


def _along(domain: FloatArray, axis: int, value: float) -> FloatArray:
    """Return parameters (k, 2) along a line on which one of them has a value."""
    parameters = np.full((SAMPLES, 2), value)
    low, high = domain[1 - axis]
    parameters[:, 1 - axis] = np.linspace(low, high, SAMPLES + 2)[1:-1]
    return parameters


def _normals(evaluate: Callable[[FloatArray], FloatArray], parameters: FloatArray, domain: FloatArray) -> FloatArray:
    """Return normals (k, 3) by differences that stay on one side of a line of constant parameter."""
    steps = 0.5 * STEP * np.diag(np.ptp(domain, axis=1))
    u, v = (evaluate(parameters + step) - evaluate(parameters - step) for step in steps)
    return np.cross(u, v)
