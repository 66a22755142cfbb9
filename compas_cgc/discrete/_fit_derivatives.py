"""Derivatives of the truncation error of polynomial fits by the coordinates, in closed form."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ._least_squares import substituted
from ._local_fits import COLUMNS
from ._local_fits import Fit
from ._local_fits import _powers
from ._local_fits import corners_of
from ._local_fits import fan_corners
from ._local_fits import fit_columns
from ._local_fits import fits_around
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Mask
from .arrays import Vectors
from .arrays import Vertices

__all__ = ["fitted_with_slopes"]


def fitted_with_slopes(
    V: Vertices, N: Vectors, F: Faces, through: Mask, wanted: Mask, degree: int, rings: int
) -> tuple[FloatArray, sparse.csr_matrix]:
    """Return the columns of `LocalFits` (n, 12) of unpinned fits, NaN elsewhere, and the derivatives of the truncation (n, 3n) [1/L^3].

    The frames and weights of the fits are held constant; their derivatives are of the order of the residuals.
    """
    n = len(V)
    out = np.full((n, COLUMNS), np.nan)
    at: list[IntArray] = [np.zeros(0, np.int64)]
    by: list[IntArray] = [np.zeros(0, np.int64)]
    slopes: list[FloatArray] = [np.zeros((0, 3))]
    for fit in fits_around(V, N, F, through, wanted, degree, rings, False):
        out[fit.rows] = fit_columns(fit)
        moved = _truncation_slopes(fit)
        at += [np.repeat(fit.rows, np.count_nonzero(fit.there, axis=1)), fit.rows]
        by += [fit.others[fit.there], fit.rows]
        # The truncation depends on positions relative to the vertex only.
        slopes += [moved[fit.there], -moved.sum(axis=1)]
    row, column, values = np.repeat(np.concatenate(at), 3), np.concatenate(by), np.concatenate(slopes).ravel()
    places = (3 * column[:, None] + np.arange(3)).ravel()
    values = np.where(np.isfinite(values), values, 0.0)
    return out, sparse.csr_matrix((values, (row, places)), shape=(n, 3 * n))


def _truncation_slopes(fit: Fit) -> FloatArray:
    """Return the derivatives (k, c, 3) of the truncation of fits by their points [1/L^3]."""
    u, v, _ = fit.places
    r, powers = fit.heights, _powers(u, v, _degree(fit.terms))
    along_u, along_v = _slopes(u, v, powers, r)
    defect = _defect_slopes(fit)
    by_heights = np.zeros_like(r)
    for k, power in enumerate(powers):
        by_heights[:, k] = np.einsum("kc,kc->k", defect[2], power)
    by_heights[:, :5] -= _gaussian_slopes(r)
    # Derivatives by the heights, through the least squares; a tangential move changes the height above the fit by the slope.
    height = np.einsum("kt,ktc->kc", substituted(fit.factor, by_heights), fit.weighted)
    height *= np.divide(1.0, fit.unweighted, out=np.zeros_like(u), where=fit.there)
    aside = defect[2] - height
    moved = np.stack([defect[0] + aside * along_u, defect[1] + aside * along_v, height], axis=2) * fit.there[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((moved @ fit.frames) / fit.scale[:, None, None] ** 3, dtype=np.float64)


def _defect_slopes(fit: Fit) -> FloatArray:
    """Return the derivatives (3, k, c) of defect over area of the fans projected onto the fits, by their points."""
    u, v, _ = fit.places
    points = np.stack([u, v, fit.lifted], axis=2)
    row, left, right = fan_corners(fit.around, fit.group)
    a, b = points[row, left], points[row, right]
    angle, share = corners_of(a, b)
    k, c = u.shape
    area = np.bincount(row, share, k)
    with np.errstate(divide="ignore", invalid="ignore"):
        K = (2.0 * np.pi - np.bincount(row, angle, k)) / area
        ends = np.concatenate([row * c + left, row * c + right])
        slopes = np.concatenate([-(one + K[row, None] * other) / area[row, None] for one, other in _corner_slopes(a, b)])
    return np.array([np.bincount(ends, axis, k * c).reshape(k, c) for axis in slopes.T], dtype=np.float64)


def _corner_slopes(a: FloatArray, b: FloatArray) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """Return the derivatives (k, 3) of the angles between two sides and of their shares of the mixed area, by each side."""
    normal = np.stack([a[:, i] * b[:, j] - a[:, j] * b[:, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)
    double, dot, aa, bb = (np.einsum("ij,ij->i", x, y)[:, None] for x, y in ((normal, normal), (a, b), (a, a), (b, b)))
    double = np.sqrt(double)
    obtuse = (dot < 0) | (aa < dot) | (bb < dot)
    part = np.where(dot < 0, 0.25, 0.125)
    quotient = (2.0 * aa * bb - dot * (aa + bb)) / double

    def by(x: FloatArray, y: FloatArray, xx: FloatArray, yy: FloatArray) -> tuple[FloatArray, FloatArray]:
        # a x (a x b) and b x (a x b) are combinations of the sides.
        angle = (dot * x - xx * y) / (xx * double)
        twice = (yy * x - dot * y) / double
        sharp = 0.125 * ((4.0 * yy - 2.0 * dot) * x - (xx + yy) * y - quotient * twice) / double
        return angle, np.where(obtuse, part * twice, sharp)

    return by(a, b, aa, bb), by(b, a, bb, aa)


def _gaussian_slopes(r: FloatArray) -> FloatArray:
    """Return the derivatives (k, 5) of the Gaussian curvature of polynomials by their first five coefficients."""
    a, b, uu, uv, vv = r[:, 0], r[:, 1], 2.0 * r[:, 2], r[:, 3], 2.0 * r[:, 4]
    g = 1.0 + a * a + b * b
    K = (uu * vv - uv * uv) / g**2
    return np.column_stack([-4.0 * K * a / g, -4.0 * K * b / g, 2.0 * vv / g**2, -2.0 * uv / g**2, 2.0 * uu / g**2])


def _slopes(u: FloatArray, v: FloatArray, powers: list[FloatArray], r: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives (k, c) of polynomials at points, from the monomials there."""
    by_u, by_v = np.zeros_like(u), np.zeros_like(u)
    lower = [np.ones_like(u), *powers]
    first, before = 0, 0  # places of the monomials of a degree and of the degree below, whose first is the constant
    for degree in range(1, _degree(len(powers)) + 1):
        for q in range(degree + 1):
            height = r[:, first + q, None]
            if q < degree:
                by_u += (degree - q) * height * lower[before + q]
            if q:
                by_v += q * height * lower[before + q - 1]
        before, first = first + 1, first + degree + 1
    return by_u, by_v


def _degree(terms: int) -> int:
    """Return the degree of polynomials with a number of terms besides the constant."""
    return int((np.sqrt(8.0 * terms + 9.0) - 3.0) / 2.0)
