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
from ..discrete.plan import rectangles
from ..linalg import factorise
from .creased_surface import CreasedSurface
from .cut_functions import CreasedMesh
from .cut_functions import CutFunctions
from .cut_functions import cut_functions
from .cut_functions import span_widths
from .spline_surface import SplineSurface

__all__ = ["Chart", "Fitted", "chart_of", "fitted_surface"]

DEGREE = 3
FIRST_SPANS, MAX_SPANS = 8, 128  # of the spline along the longer side
LEAST_AROUND = 6  # spans around a closed direction, so that harmonics of second order are distinct
STIFFNESS = 1e-9  # of the bending of a spline, against deviations, where data leave it open
STEEPEST = 0.1  # least cosine between a face and the plane, about 84 degrees
SMALLER = 0.99  # area of a rectangle around the plan over that along x, below which it is used; those of round plans differ by less
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
            side = _along_rectangle(vertices[np.unique(faces), :2])
        else:
            level = np.cross(up, normal)
            side = level if np.linalg.norm(level) > 1e-6 else np.array([1.0, 0.0, 0.0])
        side = side / np.linalg.norm(side)
        return Chart(np.zeros(3), np.array([side, np.cross(normal, side), normal]))
    return None


def _along_rectangle(plan: FloatArray) -> FloatArray:
    """Return the horizontal direction (3,) nearest to x of a side of the smallest rectangle around points (k, 2), x if none is smaller.

    Designs that are rotated in plan then have the same surface, and the same seams along their sides.
    """
    along, areas = rectangles(plan)
    if not areas.min() < SMALLER * np.prod(np.ptp(plan, axis=0)):
        return np.array([1.0, 0.0, 0.0])
    x, y = along[np.argmin(areas)]
    angle = np.arctan2(y, x)
    angle -= 0.5 * np.pi * np.round(angle / (0.5 * np.pi))
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def fitted_surface(
    uv: FloatArray,
    points: FloatArray,
    tolerance: float,
    period: Optional[FloatArray] = None,
    poles: tuple[bool, bool] = (False, False),
    corrections: int = 0,
    mesh: Optional[CreasedMesh] = None,
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
    mesh
        The mesh with these points as vertices and edges along which the surface folds, for parameters that need no correction.

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
    spans, samples = FIRST_SPANS, _Samples(uv, points) if mesh is None else _Samples.of_sides(uv, points, mesh)
    while spans <= MAX_SPANS:
        counts = np.maximum(np.where(closed, LEAST_AROUND, 2), np.round(spans * extent / extent.max())).astype(int)
        if best is not None and int(np.prod(counts + DEGREE)) > len(points):
            break
        knots = [_knots(a, b, n, ring) for a, b, n, ring in zip(low, high, counts, closed.tolist())]
        cut = None if mesh is None else cut_functions(mesh, knots, closed)
        for k in range(corrections + 1):
            control, deviation = _fit(samples, knots, closed, poles, cut)
            best = Fitted(_surface(control, knots, cut), deviation, uv)
            if deviation <= tolerance:
                return best
            if k < corrections:
                uv = best.surface.foot(points, uv, ((uv == low) | (uv == high)) & ~closed)
                samples = _Samples(uv, points)
        spans *= 2
    assert best is not None
    return best


def _knots(low: float, high: float, spans: int, closed: bool) -> FloatArray:
    inner = np.linspace(low, high, spans + 1)
    if not closed:
        return np.concatenate([np.full(DEGREE, low), inner, np.full(DEGREE, high)])
    period = high - low
    return np.concatenate([inner[-DEGREE - 1 : -1] - period, inner, inner[1 : DEGREE + 1] + period])


class _Samples(NamedTuple):
    """Points that a surface is fitted to."""

    uv: FloatArray  # (k, 2) their parameters
    points: FloatArray  # (k, 3) [L]
    mesh: Optional[CreasedMesh] = None
    faces: Optional[IntArray] = None  # (k,) of the mesh, on the side of a crease that a point counts for

    @classmethod
    def of_sides(cls, uv: FloatArray, points: FloatArray, mesh: CreasedMesh) -> _Samples:
        """Return the vertices of a mesh, those on creases once for each side."""
        vertices, faces = mesh.sides()
        return cls(uv[vertices], points[vertices], mesh, faces)


def _surface(control: FloatArray, knots: list[FloatArray], cut: Optional[CutFunctions]) -> SplineSurface:
    """Return the surface of control points (c, 3)."""
    counts = [len(own) - DEGREE - 1 for own in knots]
    homogeneous = np.column_stack([control, np.ones(len(control))])
    plain = homogeneous[: counts[0] * counts[1]].reshape(*counts, 4)
    if cut is None:
        return SplineSurface(plain, (knots[0], knots[1]), (DEGREE, DEGREE))
    return CreasedSurface(plain, (knots[0], knots[1]), (DEGREE, DEGREE), homogeneous[counts[0] * counts[1] :], cut)


def _fit(
    samples: _Samples, knots: list[FloatArray], closed: Mask, poles: tuple[bool, bool], cut: Optional[CutFunctions]
) -> tuple[FloatArray, float]:
    """Return the control points (c, 3), and the largest deviation."""
    points, uv = samples.points, samples.uv
    counts = [len(own) - DEGREE - 1 for own in knots]
    matrix, windows = _values(uv, knots, cut, samples.faces)
    normal = matrix.T @ matrix / len(uv)
    net = np.stack(np.meshgrid(*(_abscissae(own) for own in knots), indexing="ij"), axis=-1).reshape(-1, 2)
    spread = _spread(knots, counts, closed, poles)
    if cut is None:
        bending = _bending(knots, _windows_of(np.ones([n - DEGREE for n in counts], bool), counts), net)
    else:
        assert samples.mesh is not None
        (first, other), pairs = _beside_creases(samples.mesh, knots, closed)
        (left, on_left), (right, on_right) = (_values(own, knots, cut, pairs[:, k]) for k, own in enumerate((first, other)))
        gaps = left - right
        normal = normal + gaps.T @ gaps / len(pairs)
        net = np.concatenate([net, net[cut.base]])
        spread = sparse.block_diag([spread, sparse.identity(len(cut.base))]).tocsr()
        every = [windows, on_left, on_right, cut.in_cells(knots), _windows_of(~cut.cells[:-DEGREE, :-DEGREE], counts)]
        bending = _bending(knots, np.unique(np.concatenate(every), axis=0), net)
    # The plan of a design over a plane stays as it is: only what is not affine in the parameters is fitted.
    plain = ~closed & (not any(poles))
    affine = np.linalg.lstsq(_affine(uv, plain), points, rcond=None)[0]
    normal = normal + STIFFNESS * bending + 1e-14 * sparse.identity(spread.shape[0])
    right_side = matrix.T @ (points - _affine(uv, plain) @ affine) / len(uv)
    found = spread @ factorise((spread.T @ normal @ spread).tocsr(), symmetric=True).solve(spread.T @ right_side)
    found = found + _affine(net, plain) @ affine
    return found, float(np.linalg.norm(matrix @ found - points, axis=1).max(initial=0.0))


def _values(
    uv: FloatArray, knots: list[FloatArray], cut: Optional[CutFunctions], faces: Optional[IntArray]
) -> tuple[sparse.csr_matrix, IntArray]:
    """Return the basis functions (k, c) at parameters (k, 2), on given faces, and the control points of each (k, 16)."""
    rows = [BSpline.design_matrix(uv[:, k], knots[k], DEGREE).tocsr() for k in range(2)]
    counts = [len(own) - DEGREE - 1 for own in knots]
    i, j = (own.indices.reshape(len(uv), DEGREE + 1).astype(np.int64) for own in rows)
    if cut is None or faces is None:
        points, count = i[:, :, None] * counts[1] + j[:, None, :], counts[0] * counts[1]
    else:
        points, count = cut.control_points(i, j, faces), cut.control_count
    values = rows[0].data.reshape(len(uv), -1, 1) * rows[1].data.reshape(len(uv), 1, -1)
    windows = points.reshape(len(uv), (DEGREE + 1) ** 2)
    starts = np.arange(len(uv) + 1) * (DEGREE + 1) ** 2
    return sparse.csr_matrix((values.ravel(), windows.ravel(), starts), shape=(len(uv), count)), windows


def _beside_creases(mesh: CreasedMesh, knots: list[FloatArray], closed: Mask) -> tuple[list[FloatArray], IntArray]:
    """Return parameters of points along creases, within those of the surface, for both sides (k, 2), and the faces there (k, 2)."""
    left, right, pairs = mesh.along_creases(span_widths(knots))
    low, high = np.array([(own[DEGREE], own[-DEGREE - 1]) for own in knots]).T
    return [np.where(closed, low + np.mod(own - low, high - low), np.clip(own, low, high)) for own in (left, right)], pairs


def _windows_of(cells: Mask, counts: list[int]) -> IntArray:
    """Return the control points (k, 16) of spans, given by their first functions (a, b)."""
    i, j = (own[:, None] + np.arange(DEGREE + 1) for own in np.nonzero(cells))
    return (i[:, :, None] * counts[1] + j[:, None, :]).reshape(len(i), (DEGREE + 1) ** 2)


def _bending(knots: list[FloatArray], windows: IntArray, net: FloatArray) -> sparse.csr_matrix:
    """Return the squares of second differences of control points (c, c) in windows (k, 16) along both parameters.

    Parameters
    ----------
    knots
        In both directions.
    windows
        The control points of functions that are not zero at one place.
    net
        ``(c, 2)`` parameters of the control points.
    """
    square = windows.reshape(-1, DEGREE + 1, DEGREE + 1)
    total = sparse.csr_matrix((len(net), len(net)))
    for axis in range(2):
        own = square if axis == 0 else square.swapaxes(1, 2)
        triples = np.concatenate([own[:, k : k + 3].swapaxes(1, 2).reshape(-1, 3) for k in range(DEGREE - 1)])
        triples = np.unique(triples, axis=0)
        second = _second_differences(knots[axis])
        place = np.searchsorted(_abscissae(knots[axis]), net[triples[:, 0], axis])
        values = second.data.reshape(-1, 3)[np.minimum(place, second.shape[0] - 1)]
        rows = sparse.csr_matrix((values.ravel(), triples.ravel(), np.arange(len(triples) + 1) * 3), shape=(len(triples), len(net)))
        total = total + rows.T @ rows
    return total


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
