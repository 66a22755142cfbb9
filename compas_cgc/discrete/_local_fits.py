"""Polynomial fits around vertices, many at a time, and the truncation error of angle defects from them.

All in NumPy: compiled kernels would double the compile time of a first solve.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ._least_squares import CENTRED
from ._least_squares import least_squares
from ._memo import remembered
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Indices
from .arrays import IntArray
from .arrays import Mask
from .arrays import Vectors
from .arrays import Vertices

TERMS = np.array([0, 2, 5, 9, 14])  # number of terms of a polynomial of each degree, without the constant
MIN_OVERSAMPLING = 1.25  # points per term below which the degree is lowered; interpolation without surplus follows the noise
CHUNK_SIZE = 300  # vertices that are fitted at once; their data fits into the cache
PART_SIZE = 50_000  # vertices whose rings are in memory at once; bounds the memory
TENSOR_WEIGHTS = np.sqrt([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # xx, yy, zz, yz, zx, xy: the norm is that of the matrix
COLUMNS = 12  # columns of `fit_columns`; the last six are those of `LocalFits.bending`


class Rings(NamedTuple):
    """The rings around some vertices, in the order of these, and where in them the faces at each have their outer corners."""

    near: sparse.csr_matrix  # (k, n) vertices of the rings
    start: IntArray  # (k + 1,) where the faces at a vertex begin
    left: IntArray  # (c,) place of the corner of a face after the vertex, among those of its rings
    right: IntArray  # (c,) of the other one


@remembered
def rings_around(F: Faces, n: int, rows: Indices, through: Mask, rings: int) -> Rings:
    """Return the rings around some vertices (k,), without the vertices themselves; farther rings are reached through `through` only."""
    near = _neighbourhoods(F, n, rows, through, rings)
    fans = _fans(F, n)
    count = fans.start[rows + 1] - fans.start[rows]
    start = np.concatenate([[0], np.cumsum(count)])
    row = np.repeat(np.arange(len(rows)), count)
    corner = fans.corners[np.arange(len(row)) + (fans.start[rows] - start[:-1])[row]]
    f, c = corner // 3, corner % 3
    keys = np.repeat(np.arange(len(rows)), np.diff(near.indptr)) * n + near.indices
    left, right = (np.searchsorted(keys, row * n + F[f, (c + turn) % 3]) - near.indptr[row] for turn in (1, 2))
    return Rings(near, start, left, right)


def _neighbourhoods(F: Faces, n: int, rows: Indices, through: Mask, rings: int) -> sparse.csr_matrix:
    """Return the vertices of the rings around some (k, n)."""
    u, v = np.concatenate([F.ravel(), np.roll(F, -1, axis=1).ravel()]), np.concatenate([np.roll(F, -1, axis=1).ravel(), F.ravel()])
    near = sparse.csr_matrix((np.ones(len(u), np.float32), (u, v)), shape=(n, n))
    reached = near[rows]
    on = sparse.diags(through.astype(np.float32)) @ near
    for _ in range(rings - 1):
        reached = reached + reached @ on
        reached.data[:] = 1.0
    own = sparse.csr_matrix((np.ones(len(rows), np.float32), (np.arange(len(rows)), rows)), shape=reached.shape)
    reached = reached.tocsr()
    reached.data[:] = 1.0
    reached = (reached - reached.multiply(own)).tocsr()
    reached.eliminate_zeros()
    reached.sort_indices()
    return reached


class Fit(NamedTuple):
    """Polynomials around some vertices (k,), in coordinates of their own: over their frames, by their scale."""

    rows: Indices  # (k,) the vertices
    group: Indices  # (k,) their places among those that rings were found for
    around: Rings
    frames: FloatArray  # (k, 3, 3)
    others: IntArray  # (k, c) vertices of the rings; those that fill shorter ones up are the vertex itself
    there: Mask  # (k, c) those that do not
    scale: FloatArray  # (k,) distance of the farthest [L]
    places: FloatArray  # (3, k, c) u, v and height
    weighted: FloatArray  # (k, t, c) monomials times the roots of the weights, a constant last where a polynomial is not pinned
    factor: FloatArray  # (t, t, k) of the least squares, below the diagonal and on it
    heights: FloatArray  # (k, t) what the monomials are taken times
    lifted: FloatArray  # (k, c) heights of the polynomials over the points, the constant left out, zero at what fills rings up
    squares: FloatArray  # (k, 2) sums of the squares of the points' distances from the polynomials, and of their quadratic parts
    terms: int  # of monomials without the constant

    @property
    def unweighted(self) -> FloatArray:
        """What takes the roots of the weights away (k, c), zero at what fills rings up."""
        u, v, _ = self.places
        return np.where(self.there, np.sqrt(u * u + v * v + CENTRED), 0.0)


def fitted(
    V: Vertices, N: Vectors, F: Faces, through: Mask, wanted: Mask, degree: int, rings: int, pinned: bool, layout: bool = True
) -> FloatArray:
    """Return the columns of `LocalFits` (n, 12) at the wanted vertices, NaN elsewhere."""
    out = np.full((len(V), COLUMNS), np.nan)
    for fit in fits_around(V, N, F, through, wanted, degree, rings, pinned):
        out[fit.rows] = fit_columns(fit, layout)
    return out


def fits_around(V: Vertices, N: Vectors, F: Faces, through: Mask, wanted: Mask, degree: int, rings: int, pinned: bool) -> Iterator[Fit]:
    """Fit polynomials around the wanted vertices, many at a time; each chunk overwrites the memory of the last."""
    rows = np.flatnonzero(wanted & (N != 0).any(axis=1))
    for part in (rows[k : k + PART_SIZE] for k in range(0, len(rows), PART_SIZE)):
        around, frames = rings_around(F, len(V), part, through, rings), _frames(N[part])
        count = np.diff(around.near.indptr)
        used = np.full(len(part), degree)
        for lower in range(degree, 2, -1):
            used[(used == lower) & (count < MIN_OVERSAMPLING * TERMS[lower])] = lower - 1
        for own in np.unique(used):
            group = np.flatnonzero((used == own) & (count >= TERMS[own]))
            # Allocating memory for every chunk would take as long as the fits.
            room = np.empty((CHUNK_SIZE, TERMS[own] + (not pinned), count[group].max(initial=0)))
            for chunk in (group[k : k + CHUNK_SIZE] for k in range(0, len(group), CHUNK_SIZE)):
                yield _fit(V, frames[chunk], around, part[chunk], chunk, int(own), room)


def _fit(V: Vertices, frames: FloatArray, around: Rings, rows: Indices, group: Indices, degree: int, room: FloatArray) -> Fit:
    """Return fits of one degree, of vertices that are a group (k,) of those with rings.

    The monomials are written into `room`. If it has one more row than there are monomials, the polynomial is not pinned: the last
    unknown is its height over the vertex, which is one of the points.
    """
    near = around.near
    first = near.indptr[group]
    count = near.indptr[group + 1] - first
    column = np.arange(count.max())
    there = column < count[:, None]
    # Shorter rows are filled up with the vertex itself.
    others = np.where(there, near.indices[np.where(there, first[:, None] + column, 0)], rows[:, None])
    places, scale = _places(V[others] - V[rows][:, None], frames)
    weighted = room[: len(rows), :, : len(column)]
    found = least_squares(places, there, degree, weighted)
    return Fit(rows, group, around, frames, others, there, scale, places, weighted, *found, int(TERMS[degree]))


def _places(away: Vectors, frames: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return offsets (k, c, 3) in frames (k, 3, 3), divided by the largest distance, and that distance (k,)."""
    scale = np.sqrt(np.einsum("kcx,kcx->kc", away, away).max(axis=1))
    size = np.where(scale > 0.0, scale, 1.0)
    return np.ascontiguousarray((away @ (frames / size[:, None, None]).transpose(0, 2, 1)).transpose(2, 0, 1)), scale


def fit_columns(fit: Fit, layout: bool = True) -> FloatArray:
    """Return what fits tell (k, 12): the columns of `LocalFits`, with or without what they tell of the layout of the mesh."""
    out = np.full((len(fit.rows), COLUMNS), np.nan)
    scale, terms = fit.scale, fit.terms
    good = scale > 0
    r = fit.heights[:, :terms]
    count = np.count_nonzero(fit.there, axis=1)
    a, b = r[:, 0], r[:, 1]
    uu, uv, vv = 2.0 * r[:, 2], r[:, 3], 2.0 * r[:, 4]
    g = 1.0 + a * a + b * b
    out[:, 0] = (uu * vv - uv * uv) / (g * g) / (scale * scale)
    out[:, 1] = -((1 + b * b) * uu - 2 * a * b * uv + (1 + a * a) * vv) / (2 * g * np.sqrt(g)) / scale
    enough = count >= terms + 2
    out[enough, 3] = (scale * np.sqrt(fit.squares[:, 0] / np.maximum(count - terms, 1)))[enough]
    out[enough, 4] = (scale * np.sqrt(fit.squares[:, 1] / count))[enough]
    out[:, 5] = scale
    if layout:
        defect, area = _defects(fit.around, fit.group, np.stack([*fit.places[:2], fit.lifted], axis=2))
        held = area > 0
        out[held, 2] = defect[held] / area[held] / scale[held] ** 2 - out[held, 0]
    out[:, 6:] = _tensors(fit.frames, a, b, np.stack([uu, uv, vv], axis=1) / (np.sqrt(g) * scale)[:, None])
    out[~good] = np.nan
    return out


def _tensors(frames: FloatArray, a: FloatArray, b: FloatArray, second: FloatArray) -> FloatArray:
    """Return second fundamental forms (k, 3) of graphs with the slopes a and b (k,) as tensors in space (k, 6)."""
    g = 1.0 + a * a + b * b
    # The vectors along which a move in the tangent plane changes one parameter only.
    x = ((1.0 + b * b)[:, None] * frames[:, 0] - (a * b)[:, None] * frames[:, 1] + a[:, None] * frames[:, 2]) / g[:, None]
    y = ((1.0 + a * a)[:, None] * frames[:, 1] - (a * b)[:, None] * frames[:, 0] + b[:, None] * frames[:, 2]) / g[:, None]
    uu, uv, vv = second.T[..., None]
    p, q = uu * x + uv * y, uv * x + vv * y
    across = [(p[:, i] * x[:, j] + q[:, i] * y[:, j]) for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    return np.asarray(np.stack(across, axis=1) * TENSOR_WEIGHTS, dtype=np.float64)


class Fans(NamedTuple):
    """The corners of faces at every vertex."""

    faces: Faces  # (m, 3)
    start: IntArray  # (n + 1,) where those of a vertex begin
    corners: IntArray  # (3 m,) numbers 3 f + c


@remembered
def _fans(F: Faces, n: int) -> Fans:
    start = np.concatenate([[0], np.cumsum(np.bincount(F.ravel(), minlength=n))])
    return Fans(F, start, np.argsort(F.ravel(), kind="stable"))


def _defects(around: Rings, group: Indices, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angle defects (k,) and mixed areas (k,) of fans whose outer corners are points (k, c, 3) seen from their vertices."""
    row, left, right = fan_corners(around, group)
    angle, area = corners_of(points[row, left], points[row, right])
    defect = np.asarray(2.0 * math.pi - np.bincount(row, angle, len(group)), dtype=np.float64)
    return defect, np.asarray(np.bincount(row, area, len(group)), dtype=np.float64)


def fan_corners(around: Rings, group: Indices) -> tuple[IntArray, IntArray, IntArray]:
    """Return the faces at a group of vertices (k,): which of these each is at, and the places of its outer corners among their rings."""
    count = around.start[group + 1] - around.start[group]
    row = np.repeat(np.arange(len(group)), count)
    corner = np.arange(len(row)) + (around.start[group] - np.cumsum(count) + count)[row]
    return row, around.left[corner], around.right[corner]


def corners_of(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles (k,) between two sides (k, 3) at a vertex, and their shares of the mixed area."""
    (a0, a1, a2), (b0, b1, b2) = a.T, b.T
    double = np.sqrt((a1 * b2 - a2 * b1) ** 2 + (a2 * b0 - a0 * b2) ** 2 + (a0 * b1 - a1 * b0) ** 2)
    dot, aa, bb = (np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (a, a), (b, b)))
    sharp = 0.125 * (aa * (bb - dot) + bb * (aa - dot)) / np.where(double > 0, double, 1.0)
    obtuse = np.where(dot < 0, 0.25, 0.125) * double
    return np.arctan2(double, dot), np.where((dot < 0) | (aa < dot) | (bb < dot), obtuse, np.where(double > 0, sharp, 0.0))


def _frames(N: Vectors) -> FloatArray:
    """Return axes (k, 3, 3) of which the third is the normal, the first across it and the axis that it leans to least."""
    least = np.argmin(np.abs(N), axis=1)
    first = np.cross(N, np.eye(3)[least])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.asarray(np.stack([first, np.cross(N, first), N], axis=1), dtype=np.float64)


def powers(u: FloatArray, v: FloatArray, degree: int) -> FloatArray:
    """Return the monomials of degree 1 to `degree`, u before v, in a last axis."""
    return np.stack(_powers(u, v, degree), axis=-1)


def _powers(u: FloatArray, v: FloatArray, degree: int) -> list[FloatArray]:
    found = level = [u, v]
    for _ in range(degree - 1):
        # By products: a power of an array takes twenty times as long.
        level = [*(u * own for own in level), v * level[-1]]
        found = found + level
    return found
