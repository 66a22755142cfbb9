"""Space forms: sphere, plane and hyperbolic plane in one set of formulas.

Points are ``(X0, X1, X2)`` with ``X0² + K (X1² + X2²) = 1``, where X1 and X2 are lengths and the pole is ``(1, 0, 0)``: the sphere
of radius ``1/√K`` with its height divided by that radius, the plane ``(1, x, y)``, or the hyperboloid in Minkowski space.
Rigid motions are matrices (3, 3) that preserve this: SO(3), SE(2) and SO(2, 1). All formulas are smooth at K = 0.
"""

from __future__ import annotations

import math

import numpy as np

from ..discrete.arrays import FloatArray

__all__ = [
    "chords",
    "from_lifted",
    "geodesics",
    "lifted",
    "lifted_places",
    "midpoint",
    "normalised",
    "on_form",
    "places",
    "rotation",
    "straight",
    "to_pole",
    "turned",
]


def on_form(flat: FloatArray, K: float) -> FloatArray:
    """Return the points (n, 3) on the side of the pole with given X1 and X2 (n, 2) [L]."""
    squares = np.einsum("ij,ij->i", flat, flat)
    return np.column_stack([np.sqrt(np.maximum(1.0 - K * squares, 0.0)), flat])


def heights(points: FloatArray) -> FloatArray:
    """Return ``(X0 - 1) / K`` (n,) [L^2], computed without cancellation, also for K = 0."""
    return -(points[:, 1] ** 2 + points[:, 2] ** 2) / (1.0 + points[:, 0])


def places(points: FloatArray, K: float) -> FloatArray:
    """Return points (n, 3) as coordinates x, y, z with the pole at the origin [L].

    On a sphere z is the height, zero at the top; on the hyperboloid it is the timelike coordinate.
    """
    return lifted_places(lifted(points), K)


def lifted(points: FloatArray) -> FloatArray:
    """Return points (n, 3) as ``(X0 - 1) / K, X1, X2``: free of cancellation, and chords are straight lines."""
    return np.column_stack([heights(points), points[:, 1:]])


def from_lifted(points: FloatArray, K: float) -> FloatArray:
    """Return lifted points (n, 3), such as points of chords, projected to the surface, see :func:`normalised`."""
    return normalised(np.column_stack([1.0 + K * points[:, 0], points[:, 1:]]), K)


def normalised(points: FloatArray, K: float) -> FloatArray:
    """Return points (n, 3) near the surface projected onto it along rays from its centre."""
    return points / np.sqrt(points[:, 0] ** 2 + K * (points[:, 1] ** 2 + points[:, 2] ** 2))[:, None]


def lifted_places(points: FloatArray, K: float) -> FloatArray:
    """Return the coordinates of lifted points (n, 3) as in :func:`places` [L]."""
    return np.column_stack([points[:, 1:], math.copysign(math.sqrt(abs(K)), K) * points[:, 0]])


def straight(difference: FloatArray, K: float) -> FloatArray:
    """Return the straight lengths of differences of lifted points (..., 3), in Minkowski space for K < 0 [L]."""
    square = difference[..., 1] ** 2 + difference[..., 2] ** 2 + K * difference[..., 0] ** 2
    return np.sqrt(np.maximum(square, 0.0))


def chords(first: FloatArray, second: FloatArray, K: float) -> FloatArray:
    """Return the chord lengths between points (n, 3), in Minkowski space for K < 0 (n,) [L]."""
    flat = first[:, 1:] - second[:, 1:]
    square = np.einsum("ij,ij->i", flat, flat) + K * (heights(first) - heights(second)) ** 2
    return np.sqrt(np.maximum(square, 0.0))


def geodesics(chord: FloatArray, K: float) -> FloatArray:
    """Return the geodesic lengths of chords (n,) [L]."""
    if K == 0.0:
        return chord
    root = math.sqrt(abs(K))
    half = 0.5 * root * np.asarray(chord)
    return 2.0 / root * (np.arcsin(np.minimum(half, 1.0)) if K > 0.0 else np.arcsinh(half))


def midpoint(points: FloatArray, K: float) -> FloatArray:
    """Return the point (3,) on the surface in the direction of the mean of points (n, 3)."""
    mean = points.mean(axis=0)
    return mean / math.sqrt(mean[0] ** 2 + K * (mean[1] ** 2 + mean[2] ** 2))


def rotation(angle: float) -> FloatArray:
    """Return the rotation about the pole (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def to_pole(point: FloatArray, K: float) -> FloatArray:
    """Return the rigid motion (3, 3) along a geodesic that moves a point (3,) to the pole."""
    distance = math.hypot(point[1], point[2])
    if distance == 0.0:
        return np.eye(3) if point[0] > 0.0 else np.diag([-1.0, -1.0, 1.0])
    turn = rotation(math.atan2(point[2], point[1]))
    back = np.array([[point[0], K * distance, 0.0], [-distance, point[0], 0.0], [0.0, 0.0, 1.0]])
    return turn @ back @ turn.T


def turned(points: FloatArray, motion: FloatArray) -> FloatArray:
    """Return points (n, 3) after a rigid motion (3, 3)."""
    return points @ motion.T
