"""Polynomial fits around vertices, many at a time, and what they say about angle defects.

In NumPy: for a first solve these would take as long to compile as everything else.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ._memo import remembered
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Indices
from .arrays import IntArray
from .arrays import Mask
from .arrays import Vectors
from .arrays import Vertices

TERMS = np.array([0, 2, 5, 9, 14])  # of a polynomial of each degree, without the constant
SPARE = 1.25  # points against terms below which the degree is lowered
CENTRED = 0.2  # what a point's squared distance, against the farthest, is added to in its weight
SOFT = 1e-14  # pivot, against the trace, below which a system determines too little
CHUNK = 4000  # vertices that are fitted at once


@remembered
def neighbourhoods(F: Faces, n: int, rows: Indices, through: Mask, rings: int) -> sparse.csr_matrix:
    """Return the vertices of the rings around some (k, n), themselves left out; farther rings are reached through `through` only."""
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


def fitted(V: Vertices, N: Vectors, F: Faces, through: Mask, wanted: Mask, degree: int, rings: int, pinned: bool) -> FloatArray:
    """Return what polynomials around the wanted vertices tell (n, 6), else NaN: the columns of `LocalFits`."""
    out = np.full((len(V), 6), np.nan)
    rows = np.flatnonzero(wanted & (N != 0).any(axis=1))
    fans = _fans(F, len(V))
    for chunk in (rows[k : k + CHUNK] for k in range(0, len(rows), CHUNK)):
        near = neighbourhoods(F, len(V), chunk, through, rings)
        count = np.diff(near.indptr)
        used = np.full(len(chunk), degree)
        for lower in range(degree, 2, -1):
            used[(used == lower) & (count < SPARE * TERMS[lower])] = lower - 1
        for own in np.unique(used):
            group = np.flatnonzero((used == own) & (count >= TERMS[own]))
            if len(group):
                out[chunk[group]] = _group(V, N, near[group], chunk[group], fans, int(own), pinned)
    return out


def _group(V: Vertices, N: Vectors, near: sparse.csr_matrix, rows: Indices, fans: Fans, degree: int, pinned: bool) -> FloatArray:
    """Return the columns (k, 6) of fits of one degree."""
    out = np.full((len(rows), 6), np.nan)
    count = np.diff(near.indptr)
    row = np.repeat(np.arange(len(rows)), count)
    column = np.arange(len(row)) - near.indptr[row]
    there = np.arange(count.max()) < count[:, None]
    flat = np.einsum("kxy,ky->kx", _frames(N[rows])[row], V[near.indices] - V[rows[row]])
    points = np.zeros((len(rows), count.max(), 3))
    points[row, column] = flat
    scale = np.sqrt((points**2).sum(axis=2).max(axis=1))
    good = scale > 0
    points /= np.where(good, scale, 1.0)[:, None, None]
    u, v, w = np.moveaxis(points, 2, 0)
    terms = int(TERMS[degree])
    monomials = powers(u, v, degree)
    if not pinned:
        # The last unknown is the height of the polynomial over the vertex, which is one of the points.
        monomials = np.concatenate([monomials, np.ones((*u.shape, 1))], axis=2)
    weight = np.where(there, 1.0 / (u * u + v * v + CENTRED), 0.0)
    weighted = monomials * weight[..., None]
    M = weighted.transpose(0, 2, 1) @ monomials
    if not pinned:
        M[:, terms, terms] += 1.0 / CENTRED
    r = cholesky_solved(M, np.einsum("kct,kc->kt", weighted, w))
    if not pinned:
        w = w - r[:, terms, None]
    r = r[:, :terms]
    a, b = r[:, 0], r[:, 1]
    uu, uv, vv = 2.0 * r[:, 2], r[:, 3], 2.0 * r[:, 4]
    g = 1.0 + a * a + b * b
    out[:, 0] = (uu * vv - uv * uv) / (g * g) / (scale * scale)
    out[:, 1] = -((1 + b * b) * uu - 2 * a * b * uv + (1 + a * a) * vv) / (2 * g * np.sqrt(g)) / scale
    height = np.einsum("kct,kt->kc", monomials[..., :terms], r)
    second = np.einsum("kct,kt->kc", monomials[..., 2:5], r[:, 2:5])
    enough = count >= terms + 2
    off = np.where(there, height - w, 0.0)
    out[enough, 3] = (scale * np.sqrt((off**2).sum(axis=1) / np.maximum(count - terms, 1)))[enough]
    out[enough, 4] = (scale * np.sqrt(np.where(there, second**2, 0.0).sum(axis=1) / count))[enough]
    out[:, 5] = scale
    on_surface = np.stack([u, v, height], axis=2)
    defect, area = _defects(near, on_surface, rows, fans)
    held = area > 0
    out[held, 2] = defect[held] / area[held] / scale[held] ** 2 - out[held, 0]
    out[~good] = np.nan
    return out


class Fans(NamedTuple):
    """The corners of faces at every vertex."""

    faces: Faces  # (m, 3)
    start: IntArray  # (n + 1,) where those of a vertex begin
    corners: IntArray  # (3 m,) numbers 3 f + c


@remembered
def _fans(F: Faces, n: int) -> Fans:
    start = np.concatenate([[0], np.cumsum(np.bincount(F.ravel(), minlength=n))])
    return Fans(F, start, np.argsort(F.ravel(), kind="stable"))


def _defects(near: sparse.csr_matrix, points: FloatArray, rows: Indices, fans: Fans) -> tuple[FloatArray, FloatArray]:
    """Return the angle defects (k,) and mixed areas (k,) of fans whose outer corners are points (k, c, 3) seen from their vertices."""
    count = fans.start[rows + 1] - fans.start[rows]
    row = np.repeat(np.arange(len(rows)), count)
    corner = fans.corners[np.arange(len(row)) + (fans.start[rows] - np.cumsum(count) + count)[row]]
    f, c = corner // 3, corner % 3
    keys = np.repeat(np.arange(len(rows)), np.diff(near.indptr)) * near.shape[1] + near.indices
    sides = []
    for turn in (1, 2):
        at = np.searchsorted(keys, row * near.shape[1] + fans.faces[f, (c + turn) % 3])
        sides.append(points[row, at - near.indptr[row]])
    angle, area = corners_of(*sides)
    defect = np.asarray(2.0 * math.pi - np.bincount(row, angle, len(rows)), dtype=np.float64)
    return defect, np.asarray(np.bincount(row, area, len(rows)), dtype=np.float64)


def corners_of(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles (k,) between two sides (k, 3) at a vertex, and their shares of the mixed area."""
    double = np.linalg.norm(np.cross(a, b), axis=1)
    dot, aa, bb = ((x * y).sum(axis=1) for x, y in ((a, b), (a, a), (b, b)))
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
    found = level = [u, v]
    for _ in range(degree - 1):
        # By products: a power of an array takes twenty times as long.
        level = [*(u * own for own in level), v * level[-1]]
        found = found + level
    return np.stack(found, axis=-1)


def cholesky_solved(M: FloatArray, r: FloatArray) -> FloatArray:
    """Return the solutions (k, t) of systems (k, t, t); pivots are kept from vanishing where these determine too little."""
    n = M.shape[1]
    L, x = np.zeros_like(M), r.copy()
    soft = SOFT * np.trace(M, axis1=1, axis2=2)
    for k in range(n):
        below = M[:, k:, k] - np.einsum("ijm,im->ij", L[:, k:, :k], L[:, k, :k])
        L[:, k, k] = np.sqrt(np.maximum(below[:, 0], soft))
        L[:, k + 1 :, k] = below[:, 1:] / L[:, k, k, None]
        x[:, k] = (x[:, k] - np.einsum("im,im->i", L[:, k, :k], x[:, :k])) / L[:, k, k]
    for k in range(n - 1, -1, -1):
        x[:, k] = (x[:, k] - np.einsum("im,im->i", L[:, k + 1 :, k], x[:, k + 1 :])) / L[:, k, k]
    return x
