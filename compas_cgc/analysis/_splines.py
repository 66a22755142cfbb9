"""Cubic tensor-product splines: basis, points and curvature."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

from ..discrete.arrays import FloatArray

__all__ = ["DEGREE", "Knots", "Shape", "basis", "bending", "gaussian", "knots_for", "shape_of", "spline_points"]

DEGREE = 3

Knots = tuple[FloatArray, FloatArray]


class Shape(NamedTuple):
    """First and second derivatives of a surface at points, with its normal and K."""

    u: FloatArray  # (k, 3)
    v: FloatArray
    uu: FloatArray
    uv: FloatArray
    vv: FloatArray
    normal: FloatArray  # (k, 3) u x v, not normalised
    gaussian: FloatArray  # (k,) K [1/L^2]


def knots_for(count: int) -> FloatArray:
    """Return uniform knots from 0 to 1 for `count` control points, with fourfold ends."""
    inner = np.linspace(0.0, 1.0, count - DEGREE + 1)
    return np.concatenate([np.zeros(DEGREE), inner, np.ones(DEGREE)])


def basis(uv: FloatArray, knots: Knots, order: tuple[int, int] = (0, 0)) -> sparse.csr_matrix:
    """Return the values, or derivatives of the given orders, of all products of basis functions (k, a b)."""
    parts = []
    for axis in range(2):
        count = len(knots[axis]) - DEGREE - 1
        own = BSpline(knots[axis], np.eye(count), DEGREE)
        parts.append((own.derivative(order[axis]) if order[axis] else own)(np.clip(uv[:, axis], 0.0, 1.0)))
    return sparse.csr_matrix((parts[0][:, :, None] * parts[1][:, None, :]).reshape(len(uv), -1))


def bending(knots: Knots, shape: tuple[int, int]) -> sparse.csr_matrix:
    """Return the matrix (a b, a b) of the bending energy: the mean of the squared second derivatives."""
    t = (np.arange(2 * max(shape)) + 0.5) / (2 * max(shape))
    grid = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    orders = ((1.0, (2, 0)), (2.0, (1, 1)), (1.0, (0, 2)))
    return sum(factor * (D.T @ D) for factor, D in ((factor, basis(grid, knots, order)) for factor, order in orders)) / len(grid)


def spline_points(control: FloatArray, knots: Knots, uv: FloatArray, order: tuple[int, int] = (0, 0)) -> FloatArray:
    """Return the points or derivatives of a surface at parameters (k, 2): (k, 3)."""
    return basis(uv, knots, order) @ control.reshape(-1, 3)


def shape_of(u: FloatArray, v: FloatArray, uu: FloatArray, uv: FloatArray, vv: FloatArray) -> Shape:
    """Return derivatives (k, 3) with the normal and K computed from them."""
    normal = np.cross(u, v)
    square = np.maximum((normal**2).sum(axis=1), 1e-300)
    e, f, g = ((second * normal).sum(axis=1) for second in (uu, uv, vv))
    return Shape(u, v, uu, uv, vv, normal, (e * g - f * f) / square**2)


def gaussian(control: FloatArray, knots: Knots, uv: FloatArray) -> FloatArray:
    """Return the Gaussian curvature at parameters (k, 2): (k,) [1/L^2]."""
    return shape_of(*(spline_points(control, knots, uv, order) for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))).gaussian
