"""Tensor-product spline surfaces, rational or not: points, derivatives and closest points, all at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Optional

import numpy as np
from scipy.interpolate import BSpline

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask

__all__ = ["SplineSurface"]

NEWTON_STEPS = 12  # towards a closest point; neighbours of a known foot point take three
CLOSED = 1e-9  # of the size of the surface, within which two sides are one


@dataclass(frozen=True, eq=False)
class SplineSurface:
    """A NURBS surface.

    Parameters
    ----------
    control
        ``(a, b, 4)`` control points in homogeneous coordinates ``(w x, w y, w z, w)`` [L].
    knots
        The knots in both directions, ``(a + degree + 1,)`` and ``(b + degree + 1,)``.
    degrees
        The degrees in both directions.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0.0, 0.0, 1.0, 1.0])
    >>> corners = np.array([[[0, 0, 0, 1], [0, 1, 0, 1]], [[1, 0, 0, 1], [1, 1, 1, 1]]], dtype=float)
    >>> hypar = SplineSurface(corners, (knots, knots), (1, 1))
    >>> hypar.at(np.array([[0.5, 0.5]])).tolist(), hypar.gaussian(np.array([[0.0, 0.0]])).tolist()
    ([[0.5, 0.5, 0.25]], [-1.0])

    References
    ----------
    Piegl and Tiller, *The NURBS Book*, 1997, chapter 4.
    """

    control: FloatArray
    knots: tuple[FloatArray, FloatArray]
    degrees: tuple[int, int]

    @cached_property
    def domain(self) -> FloatArray:
        """First and last value of each parameter (2, 2)."""
        return np.array([[knots[p], knots[-p - 1]] for knots, p in zip(self.knots, self.degrees)])

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around the control points [L]."""
        points = self.control[..., :3] / self.control[..., 3:]
        return float(np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)))

    @cached_property
    def closed(self) -> tuple[bool, bool]:
        """Whether the two sides at the ends of each parameter are the same curve."""
        points = self.control[..., :3] / self.control[..., 3:]
        found = []
        for axis, (knots, degree) in enumerate(zip(self.knots, self.degrees)):
            clamped = knots[1] == knots[degree] and knots[-2] == knots[-degree - 1]
            count = 1 if clamped else degree
            first, last = (np.take(points, places, axis) for places in (range(count), range(-count, 0)))
            found.append(bool(np.linalg.norm(first - last, axis=2).max() <= CLOSED * self.size))
        return found[0], found[1]

    def at(self, uv: FloatArray) -> FloatArray:
        """Return the points (k, 3) at parameters (k, 2) [L]."""
        return self._quotients(uv, [(0, 0)])[0]

    def tangents(self, uv: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the points and both first derivatives (k, 3) at parameters (k, 2)."""
        point, u, v = self._quotients(uv, [(0, 0), (1, 0), (0, 1)])
        return point, u, v

    def normals(self, uv: FloatArray) -> FloatArray:
        """Return unit normals (k, 3) at parameters (k, 2); zero where the surface has none, such as at a pole."""
        _, u, v = self.tangents(uv)
        normal = np.cross(u, v)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)

    def gaussian(self, uv: FloatArray) -> FloatArray:
        """Return the Gaussian curvature (k,) at parameters (k, 2) [1/L^2]."""
        orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
        _, u, v, uu, w, vv = self._quotients(uv, orders)
        normal = np.cross(u, v)
        square = np.maximum((normal**2).sum(axis=1), 1e-300)
        e, f, g = ((second * normal).sum(axis=1) for second in (uu, w, vv))
        return (e * g - f * f) / square**2

    def principal(self, uv: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the principal curvatures (k, 2), the larger first [1/L], and its angle from the first tangent (k,) [rad]."""
        _, u, v, uu, w, vv = self._quotients(uv, [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)])
        normal = np.cross(u, v)
        normal = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        x = u / np.maximum(np.linalg.norm(u, axis=1), 1e-300)[:, None]
        y = np.cross(normal, x)
        # The second fundamental form in the orthonormal frame (x, y).
        a, b, d = (u * x).sum(axis=1), (v * x).sum(axis=1), (v * y).sum(axis=1)
        a, d = np.where(a > 0.0, a, 1.0), np.where(d != 0.0, d, 1.0)
        e, f, g = ((second * normal).sum(axis=1) for second in (uu, w, vv))
        p, q = e / a**2, (f - e * b / a) / (a * d)
        r = (g - 2.0 * f * b / a + e * b * b / a**2) / d**2
        mean, half = 0.5 * (p + r), np.hypot(0.5 * (p - r), q)
        return np.column_stack([mean + half, mean - half]), 0.5 * np.arctan2(2.0 * q, p - r)

    def foot(self, points: FloatArray, start: FloatArray, held: Optional[Mask] = None) -> FloatArray:
        """Return the parameters (k, 2) of the closest points of the surface, by Gauss-Newton from parameters nearby.

        Parameters
        ----------
        points
            ``(k, 3)`` points [L].
        start
            ``(k, 2)`` parameters of points of the surface nearby.
        held
            ``(k, 2)`` true where a parameter keeps its value, such as along a side of the surface.
        """
        low, high = self.domain.T
        free = np.ones_like(start) if held is None else np.where(held, 0.0, 1.0)
        here, span = start.copy(), high - low
        rest = np.arange(len(points))  # those that still move
        for _ in range(NEWTON_STEPS):
            before = here[rest]
            place, u, v = self.tangents(before)
            off = points[rest] - place
            # A parameter at the end of its range stays there while the closest point lies beyond it.
            slope = np.column_stack([(off * u).sum(axis=1), (off * v).sum(axis=1)])
            beyond = ((before <= low) & (slope < 0.0)) | ((before >= high) & (slope > 0.0))
            active = np.where(beyond & ~np.array(self.closed), 0.0, free[rest])
            u, v = active[:, :1] * u, active[:, 1:] * v
            a, b, c = (u * u).sum(axis=1), (u * v).sum(axis=1), (v * v).sum(axis=1)
            a, c = np.where(a > 0.0, a, 1.0), np.where(c > 0.0, c, 1.0)
            p, q = (off * u).sum(axis=1), (off * v).sum(axis=1)
            determinant = np.maximum(a * c - b * b, 1e-12 * a * c)
            step = np.column_stack([c * p - b * q, a * q - b * p]) / determinant[:, None]
            new = before + np.clip(step, -0.2 * span, 0.2 * span)
            for axis, closes in enumerate(self.closed):
                if closes:
                    new[:, axis] = low[axis] + np.mod(new[:, axis] - low[axis], span[axis])
            here[rest] = np.where(free[rest] > 0.0, np.clip(new, low, high), before)
            rest = rest[(np.abs(here[rest] - before) > 1e-12 * span.max()).any(axis=1)]
            if not len(rest):
                break
        return here

    def _quotients(self, uv: FloatArray, orders: list[tuple[int, int]]) -> list[FloatArray]:
        """Return points or derivatives (k, 3) of the given orders, by the quotient rule; lower orders have to be asked for first."""
        found: dict[tuple[int, int], FloatArray] = {}
        weights: dict[tuple[int, int], FloatArray] = {}
        (first, i), (second, j) = (self._windows(uv[:, axis], axis, max(order[axis] for order in orders)) for axis in range(2))
        net = self._net(uv, i, j)
        rows = [np.einsum("kp,kpqx->kqx", own, net) for own in first]
        for order in orders:
            total = np.einsum("kq,kqx->kx", second[order[1]], rows[order[0]])
            numerator, weights[order] = total[:, :3], total[:, 3:]
            for other in found:
                rest = order[0] - other[0], order[1] - other[1]
                if min(rest) >= 0:
                    times = _binomial(order[0], other[0]) * _binomial(order[1], other[1])
                    numerator = numerator - times * weights[rest] * found[other]
            found[order] = numerator / weights[0, 0]
        return [found[order] for order in orders]

    def _net(self, uv: FloatArray, i: IntArray, j: IntArray) -> FloatArray:
        """Return the control points (k, p + 1, q + 1, 4) of basis functions (k, p + 1) and (k, q + 1) at parameters (k, 2)."""
        return self.control[i[:, :, None], j[:, None, :]]

    def _windows(self, values: FloatArray, axis: int, highest: int) -> tuple[list[FloatArray], IntArray]:
        """Return the values (k, p + 1) of the basis functions that are not zero, for every order of derivative, and their numbers."""
        knots, degree = self.knots[axis], self.degrees[axis]
        low, high = self.domain[axis].tolist()
        beyond = (values < low) | (values > high)
        inside = np.where(beyond, low + np.mod(values - low, high - low), values) if self.closed[axis] else np.clip(values, low, high)
        last = len(knots) - degree - 2
        span = np.clip(np.searchsorted(knots, inside, side="right") - 1, degree, last)
        numbers = np.asarray(span[:, None] + np.arange(-degree, 1), dtype=np.int64)
        count = len(knots) - degree - 1
        basis = BSpline(knots, np.eye(count), degree)
        return [np.take_along_axis(basis(inside, nu=order), numbers, axis=1) for order in range(highest + 1)], numbers


def _binomial(n: int, k: int) -> int:
    return 2 if (n, k) == (2, 1) else 1
