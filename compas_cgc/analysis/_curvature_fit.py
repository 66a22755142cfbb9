"""Spline surfaces whose own K is the one asked for: the curvature is fitted along with the points."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import solveh_banded

from ..discrete.arrays import FloatArray
from ._splines import Knots
from ._splines import Shape
from ._splines import basis
from ._splines import bending
from ._splines import shape_of

__all__ = ["curvature_fitted"]

STEPS = 8
TRIALS = 4  # of a step, each damped more
ENOUGH = 0.01  # part of the cost, below which a step is the last
NEAR = 0.5  # of the distance allowed, which weighs as much as ...
MOST = 0.7  # of it, from where on they do
CLOSE = 0.005  # ... this error of K, against the K asked for
FLAT = 0.02  # least K that errors are measured against, where the size is 1
# How much looser points are held, and times `CLOSE` from which on errors of K count less and less: no smooth surface has some corners.
STAGES = ((16.0, 40.0), (8.0, 20.0), (4.0, 10.0), (2.0, 10.0), (1.0, 10.0), (1.0, 10.0), (1.0, 10.0), (1.0, 5.0), (1.0, 2.5), (1.0, 1.25))
BEGUN = 4  # of these stages are left out where the surface has nearly that K
STIFF = 1e-9  # weight of the bending
DAMPED = 1e-6  # weight of a step, against the mean of the diagonal


def curvature_fitted(
    control: FloatArray,
    knots: Knots,
    points: FloatArray,
    uv: FloatArray,
    weights: FloatArray,
    places: FloatArray,
    K: float,
    within: float,
    begun: bool = False,
) -> FloatArray:
    """Return control points (a, b, 3) of a surface that is near the points and has nearly the K asked for, by Gauss and Newton.

    A mesh knows its K to its edge length squared, and of a spline through its vertices K is no better than second
    differences are. Within a hair's breadth of the vertices there is a surface that has it.

    Parameters
    ----------
    control
        ``(a, b, 3)`` of a surface near the points.
    knots
        Of both directions.
    points, uv, weights
        ``(n, 3)`` points of a region of size 1, their parameters ``(n, 2)`` and weights ``(n,)``.
    places
        ``(k, 2)`` parameters at which K is asked for.
    K
        The K asked for, where the size is 1.
    within
        Distance that the points may have from the surface; those that are farther count more and more.
    begun
        Whether the control points are those of a surface that has nearly this K already, with which the first stages are done.
    """
    a, b, _ = control.shape
    size = a * b
    near = basis(uv, knots)
    orders = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    parts = [basis(places, knots, order) for order in orders]
    bends = bending(knots, (a, b))
    whole, own = sparse.identity(3, format="csr"), np.ones(len(points))
    # The coordinates of a control point one after the other: neighbours are near in the normal equations, which are a band.
    by_control = np.arange(3 * size).reshape(3, -1).T.ravel()
    scale = CLOSE * max(abs(K), FLAT)
    x, damping = control.reshape(-1, 3), DAMPED

    def cost(x: FloatArray, outlier: float, near_by: float) -> tuple[float, Shape]:
        shape = shape_of(*(part @ x for part in parts))
        off, error = points - near @ x, (shape.gaussian - K) / scale
        far = float((weights * own) @ (off**2).sum(axis=1)) / (weights.sum() * near_by**2)
        bent = STIFF / near_by**2 * float(np.einsum("ij,ij->", x, bends @ x))
        return far + bent + outlier**2 * float(np.mean(np.log1p((error / outlier) ** 2))), shape

    best, least_off = x, np.inf
    for looser, outlier in STAGES[BEGUN if begun else 0 :]:
        near_by = looser * NEAR * within
        stiff = STIFF / near_by**2 * bends
        far = np.linalg.norm(points - near @ x, axis=1)
        own *= np.maximum(1.0, far / (looser * MOST * within)) ** 2
        weighted = near.multiply((weights * own / weights.sum())[:, None]).T.tocsr() / near_by**2
        by_points = weighted @ near
        least, shape = cost(x, outlier, near_by)
        for _ in range(STEPS):
            error = (shape.gaussian - K) / scale
            robust = 1.0 / (1.0 + (error / outlier) ** 2)
            gradients = _gradients(shape)
            J = sparse.hstack([sum(part.multiply(own[:, k, None]) for part, own in zip(parts, gradients)) for k in range(3)])
            J = J.tocsc()[:, by_control] / scale
            JW = J.multiply((robust / len(places))[:, None]).T.tocsr()
            normal = (sparse.kron(by_points + stiff, whole) + JW @ J).tocsr()
            right = (weighted @ (points - near @ x) - stiff @ x).ravel() - JW @ error
            for _ in range(TRIALS):
                new = x + _banded_solution(normal, damping * normal.diagonal().mean(), right).reshape(-1, 3)
                found, at = cost(new, outlier, near_by)
                if found < least:
                    break
                damping *= 10.0
            else:
                break
            damping = max(0.1 * damping, DAMPED)
            gained, least, x, shape = least - found, found, new, at
            if gained < ENOUGH * least:
                break
        if looser <= 1.0:
            far = np.linalg.norm(points - near @ x, axis=1)
            off = max(1.0, float(far.max()) / within) * max(1.0, float(np.median(np.abs(shape.gaussian - K))) / scale)
            best, least_off = (x, off) if off < least_off else (best, least_off)
    return best.reshape(a, b, 3)


def _banded_solution(normal: sparse.csr_matrix, damping: float, right: FloatArray) -> FloatArray:
    """Solve symmetric positive definite equations (n, n) that have a band, with a number added to their diagonal."""
    lower = sparse.tril(normal, format="coo")
    below = lower.row - lower.col
    band = np.zeros((int(below.max(initial=0)) + 1, len(right)))
    band[below, lower.col] = lower.data
    band[0] += damping
    return np.asarray(solveh_banded(band, right, lower=True, overwrite_ab=True, check_finite=False), dtype=np.float64)


def _gradients(shape: Shape) -> tuple[FloatArray, ...]:
    """Return the derivatives (k, 3) of K by each of the five derivatives of the surface."""
    u, v, uu, uv, vv, n, K = shape
    q = np.maximum((n**2).sum(axis=1), 1e-300)
    e, f, g = ((second * n).sum(axis=1)[:, None] / (q**2)[:, None] for second in (uu, uv, vv))
    by_normal = g * uu + e * vv - 2.0 * f * uv - (4.0 * K / q)[:, None] * n
    of_u, of_v = (np.asarray(np.cross(*pair), dtype=np.float64) for pair in ((v, by_normal), (by_normal, u)))
    return of_u, of_v, g * n, -2.0 * f * n, e * n
