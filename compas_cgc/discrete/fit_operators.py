"""Polynomials fitted around vertices, as linear operators: residuals, bending and K."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ._least_squares import CENTRED
from ._local_fits import MIN_OVERSAMPLING
from ._local_fits import TERMS
from ._local_fits import _frames
from ._local_fits import powers
from ._local_fits import rings_around
from ._memo import remembered
from .arrays import CSRIndices
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Mask
from .normals import vertex_normals

__all__ = ["FitOperators", "fit_operators", "second_derivatives"]

DEGREE = 3  # degree of the polynomials; the lowest for which the error of the curvature is of second order
RINGS = 2  # rings of a fit; 18 neighbours on regular meshes, for nine terms
MIN_DEGREE = 2  # lowest degree; the lowest with curvature
MIN_SURPLUS = 2  # points beyond the number of terms; so that there is a residual
MAX_CONDITION = 1e14  # condition number above which a pseudoinverse is used; no digit of the inverse is left at 4.5e15
CHUNK = 2000  # vertices whose rings are found at once; bounds the memory
RECENT = 2  # meshes whose rings and sparsity are kept; those of 3,000 vertices take some 20 MB


class FitOperators(NamedTuple):
    """Residuals, bending and K of polynomials fitted around some vertices (k,), as operators."""

    rows: IntArray  # (k,) the vertices
    waves: sparse.csr_matrix  # (n, n) sum of the squared distances of vertices from the fits, over radius^4, of a coordinate [1/L^2]
    bending: sparse.csr_matrix  # (n, n) sum of the squared second derivatives, of a coordinate [1/L^2]
    gaussian: FloatArray  # (k,) K of the fits [1/L^2]
    jacobian: sparse.csr_matrix  # (k, n) derivatives of K by moves along the normals [1/L^3]


class _Group(NamedTuple):
    at: IntArray  # (g,) positions among the vertices
    ring: IntArray  # (g, c) vertices, the centre first; shorter rings are filled up with it
    weight: FloatArray  # (g, c), zero for the filled entries
    degree: int


class _Pattern(NamedTuple):
    """Sparsity of a matrix that is summed up from the rings of the groups."""

    indptr: CSRIndices
    indices: CSRIndices
    slots: IntArray  # position in the matrix of each entry of the rings, group after group

    def matrix(self, parts: Sequence[FloatArray], shape: tuple[int, int]) -> sparse.csr_matrix:
        """Return the matrix with entries for every group."""
        values = np.concatenate([part.ravel() for part in parts]) if parts else np.zeros(0)
        return sparse.csr_matrix((np.bincount(self.slots, values, len(self.indices)), self.indices, self.indptr), shape=shape)


class _Rings(NamedTuple):
    groups: list[_Group]
    square: _Pattern  # (n, n) between the vertices of a ring
    across: _Pattern  # (k, n) from the vertex in the middle


def fit_operators(vertices: FloatArray, faces: IntArray, rows: IntArray, through: Mask, areas: FloatArray) -> FitOperators:
    """Return the operators of cubic polynomials fitted to two rings of a surface.

    Waves and bending are those of the coordinates as functions over the tangent planes. Unlike dihedral angles they are
    consistent on any mesh: on a smooth surface the waves are close to zero.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L], ``(m, 3)``.
    rows
        ``(k,)`` vertices with a closed ring.
    through
        ``(n,)`` vertices that farther rings are reached through.
    areas
        ``(k,)`` weights of the vertices in both sums [L^2].

    References
    ----------
    Cazals and Pouget, doi:10.1016/j.cagd.2004.09.004.
    """
    n = len(vertices)
    normals = vertex_normals(vertices, faces)
    gaussian = np.full(len(rows), np.nan)
    around = _rings(faces, n, rows, through)
    waves, bending, jacobian = [], [], []
    for group in around.groups:
        frames = _frames(normals[rows[group.at]])
        ring, weight = group.ring, group.weight
        local = np.einsum("gxy,gcy->gcx", frames, vertices[ring] - vertices[rows[group.at]][:, None])
        radius = np.sqrt((local**2).sum(axis=2).max(axis=1))
        local /= radius[:, None, None]
        u, v, w = np.moveaxis(local, 2, 0)
        weight = weight / (u * u + v * v + CENTRED)
        terms = np.concatenate([powers(u, v, group.degree), np.ones((*u.shape, 1))], axis=2)
        weighted = terms * weight[..., None]
        inverse = _inverted(weighted.transpose(0, 2, 1) @ terms) @ weighted.transpose(0, 2, 1)
        # With P the projection onto the polynomials, (1 - P)ᵀ W (1 - P) = W - W P.
        off = -(weighted @ inverse)
        diagonal = np.arange(ring.shape[1])
        off[:, diagonal, diagonal] += weight
        second = inverse[:, 2:5] * np.array([2.0, 1.0, 2.0])[:, None]
        measure = areas[group.at] / radius**4
        waves.append((measure / (weight > 0).sum(axis=1))[:, None, None] * off)
        bend = second * np.sqrt([1.0, 2.0, 1.0])[:, None]
        bending.append(measure[:, None, None] * (bend.transpose(0, 2, 1) @ bend))
        heights = np.einsum("gtc,gc->gt", inverse, w)
        K, slope = _gaussian(heights, inverse)
        gaussian[group.at] = K / radius**2
        # A move along a normal that leans lifts the polynomial by what it moves off its slope.
        leaning = np.einsum("gxy,gcy->gcx", frames, normals[ring])
        du, dv = _slopes(u, v, heights, group.degree)
        lifted = leaning[..., 2] - du * leaning[..., 0] - dv * leaning[..., 1]
        jacobian.append(slope * lifted / radius[:, None] ** 3)
    square, J = around.square, around.across.matrix(jacobian, (len(rows), n))
    return FitOperators(rows, square.matrix(waves, (n, n)), square.matrix(bending, (n, n)), gaussian, J)


def second_derivatives(plan: FloatArray, faces: IntArray, rows: IntArray, through: Mask) -> sparse.csr_matrix:
    """Return the second derivatives xx, xy, yy of heights over a plan (3k, n), by cubic polynomials fitted to two rings [1/L^2].

    Parameters
    ----------
    plan
        ``(n, 3)`` a flat mesh [L].
    faces, rows, through
        As for :func:`fit_operators`.
    """
    around, shape = _rings(faces, len(plan), rows, through), (3 * len(rows), len(plan))
    found = sparse.csr_matrix(shape)
    for group in around.groups:
        ring, own = group.ring, rows[group.at]
        away = plan[ring][..., :2] - plan[own][:, None, :2]
        radius = np.sqrt((away**2).sum(axis=2).max(axis=1))
        u, v = np.moveaxis(away / radius[:, None, None], 2, 0)
        weight = group.weight / (u * u + v * v + CENTRED)
        terms = np.concatenate([powers(u, v, group.degree), np.ones((*u.shape, 1))], axis=2)
        weighted = terms * weight[..., None]
        inverse = _inverted(weighted.transpose(0, 2, 1) @ terms) @ weighted.transpose(0, 2, 1)
        second = inverse[:, 2:5] * np.array([2.0, 1.0, 2.0])[:, None] / radius[:, None, None] ** 2
        row = np.broadcast_to((3 * group.at[:, None] + np.arange(3))[..., None], second.shape)
        column = np.broadcast_to(ring[:, None], second.shape)
        found = found + sparse.csr_matrix((second.ravel(), (row.ravel(), column.ravel())), shape=shape)
    return found


def _made(faces: IntArray, n: int, rows: IntArray, through: Mask) -> _Rings:
    """Return the rings and sparsity, which depend on the faces only."""
    groups = list(_groups(faces, n, rows, through))
    square = [np.broadcast_arrays(own.ring[:, :, None], own.ring[:, None, :]) for own in groups]
    across = [np.broadcast_arrays(own.at[:, None], own.ring) for own in groups]
    return _Rings(groups, _pattern(square, (n, n)), _pattern(across, (len(rows), n)))


_rings = remembered(_made, recent=RECENT)


def _pattern(places: Sequence[Sequence[IntArray]], shape: tuple[int, int]) -> _Pattern:
    """Return the sparsity of entries at repeated rows and columns."""
    if not places:
        return _Pattern(np.zeros(shape[0] + 1, np.int32), np.zeros(0, np.int32), np.zeros(0, np.int64))
    row, column = (np.concatenate([own[k].ravel() for own in places]).astype(np.int64) for k in range(2))
    keys, slots = np.unique(row * shape[1] + column, return_inverse=True)
    indptr = np.searchsorted(keys, np.arange(shape[0] + 1) * shape[1])
    return _Pattern(indptr.astype(np.int32), (keys % shape[1]).astype(np.int32), slots.ravel())


def _groups(faces: IntArray, n: int, rows: IntArray, through: Mask) -> Iterator[_Group]:
    """Return the vertices and their rings, grouped by the degree of the polynomials."""
    for first in range(0, len(rows), CHUNK):
        chunk = rows[first : first + CHUNK]
        near = rings_around(faces, n, chunk, through, RINGS).near
        count = np.diff(near.indptr)
        degree = np.where(count + 1 >= MIN_OVERSAMPLING * (TERMS[DEGREE] + 1), DEGREE, MIN_DEGREE)
        for own in range(MIN_DEGREE, DEGREE + 1):
            at = np.flatnonzero((degree == own) & (count >= TERMS[own] + MIN_SURPLUS))
            if not len(at):
                continue
            widest = int(count[at].max())
            there = np.arange(widest) < count[at][:, None]
            place = np.minimum(near.indptr[at][:, None] + np.arange(widest), len(near.indices) - 1)
            ring = np.where(there, near.indices[place], chunk[at][:, None])
            ring = np.column_stack([chunk[at], ring]).astype(np.int64)
            yield _Group(first + at, ring, np.column_stack([np.ones(len(at)), there]).astype(np.float64), own)


def _inverted(squares: FloatArray) -> FloatArray:
    """Return the inverses of symmetric matrices (g, t, t), or pseudoinverses if singular to rounding."""
    try:
        inverse: FloatArray = np.asarray(np.linalg.inv(squares), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(squares, hermitian=True), dtype=np.float64)
    sizes = np.abs(squares).max(axis=(1, 2)) * np.abs(inverse).max(axis=(1, 2))
    singular = ~(sizes < MAX_CONDITION)
    if singular.any():
        inverse[singular] = np.linalg.pinv(squares[singular], hermitian=True)
    return inverse


def _gaussian(heights: FloatArray, inverse: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K of polynomials (g, t) and its derivatives by the heights of their points (g, c)."""
    a, b, uu, uv, vv = heights[:, 0], heights[:, 1], 2.0 * heights[:, 2], heights[:, 3], 2.0 * heights[:, 4]
    g = 1.0 + a * a + b * b
    K = (uu * vv - uv * uv) / g**2
    by = np.column_stack([-4.0 * K * a / g, -4.0 * K * b / g, 2.0 * vv / g**2, -2.0 * uv / g**2, 2.0 * uu / g**2])
    return K, np.einsum("gt,gtc->gc", by, inverse[:, :5])


def _slopes(u: FloatArray, v: FloatArray, heights: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives (g, c) of polynomials (g, t) at points."""
    du, dv = np.zeros_like(u), np.zeros_like(u)
    term = 0
    for total in range(1, degree + 1):
        for q in range(total + 1):
            p, height = total - q, heights[:, term, None]
            if p:
                du += height * p * u ** (p - 1) * v**q
            if q:
                dv += height * q * u**p * v ** (q - 1)
            term += 1
    return du, dv
