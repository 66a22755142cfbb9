"""Smooth surfaces through meshes that lie over a plane: splines fitted within a tolerance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..linalg import factorise
from .spline_surface import SplineSurface

__all__ = ["Chart", "Fitted", "chart_of", "fitted_surface"]

DEGREE = 3
FIRST_SPANS, MAX_SPANS = 8, 128  # of the spline along the longer side
STIFFNESS = 1e-9  # of the bending of a spline, against deviations, where data leave it open
STEEPEST = 0.1  # least cosine between a face and the plane, about 84 degrees
MARGIN = 1e-9  # of the size, by which the domain is wider than the points


class Chart(NamedTuple):
    """A plane over which a mesh lies."""

    origin: FloatArray  # (3,) [L]
    axes: FloatArray  # (3, 3) orthonormal rows: two along the plane and its normal

    def to_local(self, points: FloatArray) -> FloatArray:
        """Return coordinates along the plane and the height (k, 3) [L]."""
        return (points - self.origin) @ self.axes.T

    def to_space(self, local: FloatArray) -> FloatArray:
        """Return points in space (k, 3) [L]."""
        return local @ self.axes + self.origin


class Fitted(NamedTuple):
    """A spline surface fitted to a mesh."""

    surface: SplineSurface  # its parameters are the coordinates in the chart [L]
    deviation: float  # largest distance of a vertex from it, along the normal of the plane [L]


def chart_of(vertices: FloatArray, faces: IntArray) -> Chart:
    """Return the plane over which a mesh lies: its plan where it has one, else the plane that its faces look at.

    Raises
    ------
    MeshError
        If it lies over no plane, as closed surfaces do.
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    sound = area > 1e-9 * area.max(initial=0.0)
    unit = cross[sound] / area[sound, None]
    mean = cross.sum(axis=0)
    up = np.array([0.0, 0.0, 1.0])
    tries = [np.sign(mean[2] or 1.0) * up, mean / max(float(np.linalg.norm(mean)), 1e-300)]
    for number, normal in enumerate(tries):
        if float((unit @ normal).min(initial=1.0)) < (3.0 * STEEPEST if number == 0 else STEEPEST):
            continue
        if number == 0:
            side = np.array([1.0, 0.0, 0.0])
        else:
            level = np.cross(up, normal)
            side = level if np.linalg.norm(level) > 1e-6 else np.array([1.0, 0.0, 0.0])
        side = side / np.linalg.norm(side)
        return Chart(np.zeros(3), np.array([side, np.cross(normal, side), normal]))
    raise MeshError(
        "the design has overhanging or nearly vertical faces, both in plan and seen along its mean normal; "
        "give a NURBS surface, or divide the design into parts that each lie over a plane"
    )


def fitted_surface(chart: Chart, points: FloatArray, tolerance: float) -> Fitted:
    """Return a bicubic spline over a plane through points, with the fewest spans that meet a tolerance.

    Parameters
    ----------
    chart
        The plane.
    points
        ``(k, 3)`` points of the design, such as the vertices of its mesh [L].
    tolerance
        Largest deviation aimed at [L]. The deviation that is reached may be larger where points are too few for more spans.
    """
    local = chart.to_local(points)
    low, high = local[:, :2].min(axis=0), local[:, :2].max(axis=0)
    extent = np.maximum(high - low, 1e-12)
    best, spans = None, FIRST_SPANS
    while spans <= MAX_SPANS:
        counts = np.maximum(2, np.round(spans * extent / extent.max())).astype(int)
        if best is not None and int(np.prod(counts + DEGREE)) > len(points):
            break
        knots = [_knots(a, b, n) for a, b, n in zip(low - MARGIN * extent, high + MARGIN * extent, counts)]
        heights, deviation = _fit(local, knots)
        best = (knots, heights, deviation)
        if deviation <= tolerance:
            break
        spans *= 2
    assert best is not None
    knots, heights, deviation = best
    u, v = (_abscissae(own) for own in knots)
    net = np.concatenate([np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1), heights[..., None]], axis=-1)
    control = np.concatenate([chart.to_space(net.reshape(-1, 3)), np.ones((net[..., 0].size, 1))], axis=1)
    return Fitted(SplineSurface(control.reshape(*net.shape[:2], 4), (knots[0], knots[1]), (DEGREE, DEGREE)), deviation)


def _knots(low: float, high: float, spans: int) -> FloatArray:
    return np.concatenate([np.full(DEGREE, low), np.linspace(low, high, spans + 1), np.full(DEGREE, high)])


def _fit(local: FloatArray, knots: list[FloatArray]) -> tuple[FloatArray, float]:
    """Return the heights of the control points (a, b), and the largest deviation."""
    rows = [BSpline.design_matrix(local[:, k], knots[k], DEGREE) for k in range(2)]
    counts = [len(own) - DEGREE - 1 for own in knots]
    matrix = _row_products(rows[0].tocsr(), rows[1].tocsr(), counts)
    second = [_second_differences(own) for own in knots]
    eye = [sparse.identity(n, format="csr") for n in counts]
    bending = sparse.kron(second[0].T @ second[0], eye[1]) + sparse.kron(eye[0], second[1].T @ second[1])
    normal = (matrix.T @ matrix / len(local)).tocsr()
    normal = (normal + STIFFNESS * bending + 1e-14 * sparse.identity(normal.shape[0])).tocsr()
    found = factorise(normal, symmetric=True).solve(matrix.T @ local[:, 2] / len(local))
    deviation = float(np.abs(matrix @ found - local[:, 2]).max(initial=0.0))
    return found.reshape(counts[0], counts[1]), deviation


def _abscissae(knots: FloatArray) -> FloatArray:
    """Return the parameters (n,) of control points (Greville), at which the heights of a plane are those of its control points."""
    return np.array([knots[k + 1 : k + DEGREE + 1].mean() for k in range(len(knots) - DEGREE - 1)])


def _second_differences(knots: FloatArray) -> sparse.csr_matrix:
    """Return the second differences (n - 2, n) of control heights, those of a plane zero, for a unit step inside."""
    at = _abscissae(knots)
    step = (at[-1] - at[0]) / (len(at) - DEGREE)
    slopes = np.diff(np.eye(len(at)), axis=0) / np.diff(at)[:, None]
    return sparse.csr_matrix(2.0 * step**2 * np.diff(slopes, axis=0) / (at[2:] - at[:-2])[:, None])


def _row_products(one: sparse.csr_matrix, other: sparse.csr_matrix, counts: list[int]) -> sparse.csr_matrix:
    """Return the products of all entries of two matrices, row by row; each row has DEGREE + 1 of them."""
    k, width = one.shape[0], DEGREE + 1
    values = (one.data.reshape(k, width)[:, :, None] * other.data.reshape(k, width)[:, None, :]).reshape(k, -1)
    columns = (one.indices.reshape(k, width)[:, :, None] * counts[1] + other.indices.reshape(k, width)[:, None, :]).reshape(k, -1)
    return sparse.csr_matrix((values.ravel(), columns.ravel(), np.arange(k + 1) * width**2), shape=(k, counts[0] * counts[1]))
