"""Spline surfaces fitted to points and to a prescribed K."""

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

STEPS = 8  # Gauss-Newton steps per stage
TRIALS = 4  # tries of a step with increasing damping
MIN_GAIN = 0.01  # a stage ends when a step reduces the cost by less than this fraction
REFERENCE_DISTANCE = 0.5  # distance of a point, relative to the allowed one, that costs as much as REFERENCE_ERROR
PENALTY_DISTANCE = 0.7  # distance relative to the allowed one beyond which the weight of a point grows
REFERENCE_ERROR = 0.005  # error of K relative to its target
CURVATURE_FLOOR = 0.02  # smallest reference for errors of K, for a region of size 1
# Factors on the distances, and errors of K in units of REFERENCE_ERROR beyond which they are outliers, such as at corners.
STAGES = ((16.0, 40.0), (8.0, 20.0), (4.0, 10.0), (2.0, 10.0), (1.0, 10.0), (1.0, 10.0), (1.0, 10.0), (1.0, 5.0), (1.0, 2.5), (1.0, 1.25))
SKIPPED_STAGES = 4  # stages skipped if the start nearly has its K
BENDING_WEIGHT = 1e-9  # weight of the bending energy
MIN_DAMPING = 1e-6  # Levenberg-Marquardt damping relative to the mean of the diagonal


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
    """Return the control points (a, b, 3) of a spline near the points whose K is nearly prescribed, by damped Gauss-Newton.

    The K of a spline through the vertices of a mesh is only as accurate as second differences of the vertices. A spline with
    an accurate K exists at a small distance from them, which this fit finds.

    Parameters
    ----------
    control
        ``(a, b, 3)`` control points of the initial surface.
    knots
        Knots in both directions.
    points, uv, weights
        ``(n, 3)`` points of a region of size 1, their parameters ``(n, 2)`` and weights ``(n,)``.
    places
        ``(k, 2)`` parameters at which K is prescribed.
    K
        Prescribed K for a region of size 1.
    within
        Allowed distance of the points from the surface; points beyond it get increasing weights.
    begun
        Whether the initial surface nearly has this K, so that the first stages are skipped.
    """
    a, b, _ = control.shape
    size = a * b
    near = basis(uv, knots)
    orders = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    parts = [basis(places, knots, order) for order in orders]
    bends = bending(knots, (a, b))
    whole, own = sparse.identity(3, format="csr"), np.ones(len(points))
    # Interleave the coordinates of control points, so that the normal equations are banded.
    by_control = np.arange(3 * size).reshape(3, -1).T.ravel()
    scale = REFERENCE_ERROR * max(abs(K), CURVATURE_FLOOR)
    x, damping = control.reshape(-1, 3), MIN_DAMPING

    def cost(x: FloatArray, outlier: float, near_by: float) -> tuple[float, Shape]:
        shape = shape_of(*(part @ x for part in parts))
        off, error = points - near @ x, (shape.gaussian - K) / scale
        far = float((weights * own) @ (off**2).sum(axis=1)) / (weights.sum() * near_by**2)
        bent = BENDING_WEIGHT / near_by**2 * float(np.einsum("ij,ij->", x, bends @ x))
        return far + bent + outlier**2 * float(np.mean(np.log1p((error / outlier) ** 2))), shape

    best, least_off = x, np.inf
    for looser, outlier in STAGES[SKIPPED_STAGES if begun else 0 :]:
        near_by = looser * REFERENCE_DISTANCE * within
        stiff = BENDING_WEIGHT / near_by**2 * bends
        far = np.linalg.norm(points - near @ x, axis=1)
        own *= np.maximum(1.0, far / (looser * PENALTY_DISTANCE * within)) ** 2
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
            damping = max(0.1 * damping, MIN_DAMPING)
            gained, least, x, shape = least - found, found, new, at
            if gained < MIN_GAIN * least:
                break
        if looser <= 1.0:
            far = np.linalg.norm(points - near @ x, axis=1)
            off = max(1.0, float(far.max()) / within) * max(1.0, float(np.median(np.abs(shape.gaussian - K))) / scale)
            best, least_off = (x, off) if off < least_off else (best, least_off)
    return best.reshape(a, b, 3)


def _banded_solution(normal: sparse.csr_matrix, damping: float, right: FloatArray) -> FloatArray:
    """Return the solution of banded symmetric positive definite equations (n, n) with `damping` added to the diagonal."""
    lower = sparse.tril(normal, format="coo")
    below = lower.row - lower.col
    band = np.zeros((int(below.max(initial=0)) + 1, len(right)))
    band[below, lower.col] = lower.data
    band[0] += damping
    return np.asarray(solveh_banded(band, right, lower=True, overwrite_ab=True, check_finite=False), dtype=np.float64)


def _gradients(shape: Shape) -> tuple[FloatArray, ...]:
    """Return the derivatives (k, 3) of K with respect to each of the five derivatives of the surface."""
    u, v, uu, uv, vv, n, K = shape
    q = np.maximum((n**2).sum(axis=1), 1e-300)
    e, f, g = ((second * n).sum(axis=1)[:, None] / (q**2)[:, None] for second in (uu, uv, vv))
    by_normal = g * uu + e * vv - 2.0 * f * uv - (4.0 * K / q)[:, None] * n
    of_u, of_v = (np.asarray(np.cross(*pair), dtype=np.float64) for pair in ((v, by_normal), (by_normal, u)))
    return of_u, of_v, g * n, -2.0 * f * n, e * n
