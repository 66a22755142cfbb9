"""Smooth surfaces through meshes: planes that meshes lie over, and splines fitted within a tolerance."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..linalg import factorise
from .spline_surface import SplineSurface

__all__ = ["Chart", "Fitted", "chart_of", "fitted_surface"]

DEGREE = 3
FIRST_SPANS, MAX_SPANS = 8, 128  # of the spline along the longer side
LEAST_AROUND = 6  # spans around a closed direction, so that harmonics of second order are distinct
STIFFNESS = 1e-9  # of the bending of a spline, against deviations, where data leave it open
STEEPEST = 0.1  # least cosine between a face and the plane, about 84 degrees
STEEP, STEEP_PART = 0.33, 0.1  # cosine of faces that the plane shows a third as long, and the part of the surface that may be steeper


class Chart(NamedTuple):
    """A plane over which a mesh lies."""

    origin: FloatArray  # (3,) [L]
    axes: FloatArray  # (3, 3) orthonormal rows: two along the plane and its normal

    def to_local(self, points: FloatArray) -> FloatArray:
        """Return coordinates along the plane and the height (k, 3) [L]."""
        return (points - self.origin) @ self.axes.T


class Fitted(NamedTuple):
    """A spline surface fitted to a mesh."""

    surface: SplineSurface
    deviation: float  # largest distance of a point from that with its parameters [L]
    uv: FloatArray  # (k, 2) parameters of the points


def chart_of(vertices: FloatArray, faces: IntArray) -> Optional[Chart]:
    """Return the plane over which a mesh lies: its plan where it has one, else the plane that its faces look at; None if none."""
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
        if number and float(area[sound][unit @ normal < STEEP].sum()) > STEEP_PART * float(area.sum()):
            continue
        if number == 0:
            side = np.array([1.0, 0.0, 0.0])
        else:
            level = np.cross(up, normal)
            side = level if np.linalg.norm(level) > 1e-6 else np.array([1.0, 0.0, 0.0])
        side = side / np.linalg.norm(side)
        return Chart(np.zeros(3), np.array([side, np.cross(normal, side), normal]))
    return None


def fitted_surface(
    uv: FloatArray,
    points: FloatArray,
    tolerance: float,
    period: Optional[FloatArray] = None,
    poles: tuple[bool, bool] = (False, False),
    corrections: int = 0,
) -> Fitted:
    """Return a bicubic spline through points with given parameters, with the fewest spans that meet a tolerance.

    Parameters that are not smooth, such as those of a map around the corners of holes, need corrections: after a fit, each point
    takes the parameters of the closest point of the spline, and the spline is fitted again.

    Parameters
    ----------
    uv
        ``(k, 2)`` parameters of the points, about as far apart as these [L].
    points
        ``(k, 3)`` points of the design, such as the vertices of its mesh [L].
    tolerance
        Largest deviation aimed at [L]. The deviation that is reached may be larger where points are too few for more spans.
    period
        ``(2,)`` of parameters that close, infinite for others [L]. Default: none closes.
    poles
        Whether the first and the last value of the second parameter are one point each.
    corrections
        How often parameters are corrected for each number of spans. Points with the first or last value of a parameter that does
        not close keep it.

    References
    ----------
    Hoschek, *Intrinsic parametrization for approximation*, 1988, doi:10.1016/0167-8396(88)90017-9.
    """
    closed = np.zeros(2, bool) if period is None else np.isfinite(period)
    low, high = uv.min(axis=0), uv.max(axis=0)
    if period is not None:
        high = np.where(closed, low + period, high)
        uv = np.where(closed, low + np.mod(uv - low, np.where(closed, period, 1.0)), uv)
    extent = np.maximum(high - low, 1e-12)
    best: Optional[Fitted] = None
    spans = FIRST_SPANS
    while spans <= MAX_SPANS:
        counts = np.maximum(np.where(closed, LEAST_AROUND, 2), np.round(spans * extent / extent.max())).astype(int)
        if best is not None and int(np.prod(counts + DEGREE)) > len(points):
            break
        knots = [_knots(a, b, n, ring) for a, b, n, ring in zip(low, high, counts, closed.tolist())]
        for k in range(corrections + 1):
            control, deviation = _fit(uv, points, knots, closed, poles)
            homogeneous = np.concatenate([control, np.ones((*control.shape[:2], 1))], axis=2)
            best = Fitted(SplineSurface(homogeneous, (knots[0], knots[1]), (DEGREE, DEGREE)), deviation, uv)
            if deviation <= tolerance:
                return best
            if k < corrections:
                uv = best.surface.foot(points, uv, ((uv == low) | (uv == high)) & ~closed)
        spans *= 2
    assert best is not None
    return best


def _knots(low: float, high: float, spans: int, closed: bool) -> FloatArray:
    inner = np.linspace(low, high, spans + 1)
    if not closed:
        return np.concatenate([np.full(DEGREE, low), inner, np.full(DEGREE, high)])
    period = high - low
    return np.concatenate([inner[-DEGREE - 1 : -1] - period, inner, inner[1 : DEGREE + 1] + period])


def _fit(uv: FloatArray, points: FloatArray, knots: list[FloatArray], closed: Mask, poles: tuple[bool, bool]) -> tuple[FloatArray, float]:
    """Return the control points (a, b, 3), and the largest deviation."""
    rows = [BSpline.design_matrix(uv[:, k], knots[k], DEGREE) for k in range(2)]
    counts = [len(own) - DEGREE - 1 for own in knots]
    matrix = _row_products(rows[0].tocsr(), rows[1].tocsr(), counts)
    second = [_second_differences(own) for own in knots]
    eye = [sparse.identity(n, format="csr") for n in counts]
    bending = sparse.kron(second[0].T @ second[0], eye[1]) + sparse.kron(eye[0], second[1].T @ second[1])
    spread = _spread(knots, counts, closed, poles)
    # The plan of a design over a plane stays as it is: only what is not affine in the parameters is fitted.
    plain = ~closed & (not any(poles))
    affine = np.linalg.lstsq(_affine(uv, plain), points, rcond=None)[0]
    net = np.stack(np.meshgrid(*(_abscissae(own) for own in knots), indexing="ij"), axis=-1).reshape(-1, 2)
    normal = matrix.T @ matrix / len(uv) + STIFFNESS * bending + 1e-14 * sparse.identity(spread.shape[0])
    right = matrix.T @ (points - _affine(uv, plain) @ affine) / len(uv)
    found = spread @ factorise((spread.T @ normal @ spread).tocsr(), symmetric=True).solve(spread.T @ right) + _affine(net, plain) @ affine
    deviation = float(np.linalg.norm(matrix @ found - points, axis=1).max(initial=0.0))
    return found.reshape(counts[0], counts[1], 3), deviation


def _affine(uv: FloatArray, plain: Mask) -> FloatArray:
    """Return one and the parameters that are not closed, at places (k, 2)."""
    return np.column_stack([np.ones(len(uv)), uv[:, plain]])


def _spread(knots: list[FloatArray], counts: list[int], closed: Mask, poles: tuple[bool, bool]) -> sparse.csr_matrix:
    """Return the control points (a b, f) for those that are free.

    Where a surface closes, control points repeat. At a pole its Taylor polynomial of second order is that of a smooth surface: in
    polar coordinates, a point, a linear function of the direction times the distance, and a quadratic one times its square.
    """
    axes = [np.arange(n) % (n - DEGREE) if ring else np.arange(n) for n, ring in zip(counts, closed)]
    numbers = axes[0][:, None] * counts[1] + axes[1][None, :]
    total = int(np.prod(counts))
    one = sparse.csr_matrix((np.ones(total), (np.arange(total), numbers.ravel())), shape=(total, total))
    angles = 2.0 * np.pi * (_abscissae(knots[0]) - knots[0][DEGREE]) / np.ptp(knots[0][DEGREE:-DEGREE])
    blocks, at_pole = [], np.zeros(total, bool)
    for pole, own, last in zip(poles, (knots[1] - knots[1][0], (knots[1][-1] - knots[1])[::-1]), (False, True)):
        if not pole:
            continue
        block = np.zeros((counts[0], counts[1], 6))
        for row in range(DEGREE):
            a, b, c = own[row + 1 : row + DEGREE + 1]
            linear, quadratic = (a + b + c) / 3.0, (a * b + a * c + b * c) / 3.0
            terms = [np.ones(counts[0]), *(linear * f(angles) for f in (np.cos, np.sin))]
            terms += [quadratic * values for values in (np.ones(counts[0]), np.cos(2.0 * angles), np.sin(2.0 * angles))]
            block[:, -1 - row if last else row] = np.column_stack(terms)
        rows = block.reshape(total, 6)
        at_pole |= rows.any(axis=1)
        blocks.append(sparse.csr_matrix(rows))
    used = np.unique(numbers.ravel()[~at_pole])
    return sparse.hstack([sparse.diags((~at_pole).astype(float)) @ one[:, used], *blocks]).tocsr()


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
