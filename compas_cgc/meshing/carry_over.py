"""Smooth interpolation of scattered values by blended local polynomials."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from .._compiled import kernel
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["CarryOver"]

DEGREE = 4
POINTS_PER_COEFFICIENT = 2.2  # points per coefficient of a fit
BLENDED_FITS = 5  # polynomials blended at a place
SOFTENING = 0.05  # softening of a point's own weight, relative to the mean squared distance of its neighbours
COINCIDENCE = 1e-9  # relative distance below which only the polynomial of the point itself counts


class CarryOver:
    """Interpolation of values from points to places in the plane by blended local polynomials.

    Polynomials of degree four are reproduced exactly; with few points the degree is lower.

    Parameters
    ----------
    points
        ``(k, 2)`` points with known values [L].
    places
        ``(n, 2)`` places of evaluation [L].

    Examples
    --------
    >>> x, y = np.divmod(np.arange(100.0), 10)
    >>> carry = CarryOver(np.column_stack([x, y]), np.array([[3.3, 4.4]]))
    >>> carry((x**2 * y).reshape(-1, 1)).round(6).tolist()
    [[47.916]]

    References
    ----------
    Franke and Nielson, *Smooth interpolation of large sets of scattered data*, doi:10.1002/nme.1620151110.
    """

    def __init__(self, points: FloatArray, places: FloatArray):
        self._points, self._places = points, np.ascontiguousarray(places)
        tree = cKDTree(points)
        self._degree, self._around, self._scale, self._solver = _fits(points, tree)
        many = min(BLENDED_FITS + 1, len(points))
        distance, near = tree.query(places, many)
        distance, self._near = distance.reshape(len(places), many), near.reshape(len(places), many)
        self._weight = np.ones((len(places), 1))
        if many > 1:
            # Franke-Little weights blend the polynomials smoothly.
            reach = distance[:, -1:] * (1.0 + COINCIDENCE)
            weight = np.square((reach - distance[:, :-1]) / np.maximum(distance[:, :-1], COINCIDENCE * reach))
            self._near, self._weight = np.ascontiguousarray(self._near[:, :-1]), weight / weight.sum(axis=1, keepdims=True)

    def __call__(self, values: FloatArray) -> FloatArray:
        """Return the values (n, d) at the places for values (k, d) at the points."""
        coefficients = np.einsum("kcm,kmd->kcd", self._solver, values[self._around])
        return _evaluated(self._points, self._places, self._near, self._weight, self._scale, coefficients, self._degree)


def _fits(points: FloatArray, tree: cKDTree) -> tuple[int, IntArray, FloatArray, FloatArray]:
    """Return the degree, neighbours of each point (k, m), their reach (k,) [L], and matrices from values to coefficients (k, c, m)."""
    degree = DEGREE
    while degree and POINTS_PER_COEFFICIENT * (degree + 1) * (degree + 2) / 2 > len(points):
        degree -= 1
    count = min(len(points), int(np.ceil(POINTS_PER_COEFFICIENT * (degree + 1) * (degree + 2) / 2)))
    distance, around = tree.query(points, count)
    distance, around = distance.reshape(len(points), -1), around.reshape(len(points), -1)
    scale = np.maximum(distance[:, -1], np.finfo(float).tiny)
    x, y = np.moveaxis((points[around] - points[:, None]) / scale[:, None, None], 2, 0)
    terms = np.stack([x ** (i - j) * y**j for i in range(degree + 1) for j in range(i + 1)], axis=-1)
    square = x * x + y * y
    weight = (1.0 - 0.8 * square) / np.sqrt(square + SOFTENING * square.mean(axis=1, keepdims=True) + np.finfo(float).tiny)
    # Normal equations are faster than decompositions and accurate enough for these degrees.
    left = np.swapaxes(weight[..., None] ** 2 * terms, 1, 2)
    normal = left @ terms
    lift = 1e-13 * np.trace(normal, axis1=1, axis2=2)
    return degree, around, scale, np.linalg.solve(normal + lift[:, None, None] * np.eye(terms.shape[2]), left)


@kernel()
def _evaluated(
    points: FloatArray, places: FloatArray, near: IntArray, weight: FloatArray, scale: FloatArray, coefficients: FloatArray, degree: int
) -> FloatArray:
    result = np.zeros((len(places), coefficients.shape[2]))
    for n in range(len(places)):
        for b in range(near.shape[1]):
            k = near[n, b]
            x, y = (places[n, 0] - points[k, 0]) / scale[k], (places[n, 1] - points[k, 1]) / scale[k]
            term, row = 0, weight[n, b]
            for i in range(degree + 1):
                part = row
                for j in range(i + 1):
                    power = part * x ** (i - j)
                    for d in range(result.shape[1]):
                        result[n, d] += power * coefficients[k, term, d]
                    part *= y
                    term += 1
    return result
