"""Least squares of polynomials over the tangent planes of many vertices at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ._cholesky import MIN_PIVOT
from .arrays import FloatArray
from .arrays import Mask

__all__ = ["CENTRED", "Polynomials", "least_squares", "substituted"]

# squared distance added in the weights of points relative to the farthest; nearby points count 6 times as much as the farthest
CENTRED = 0.2


class Polynomials(NamedTuple):
    """What the least squares around some vertices (k,) found, the monomials without the constant."""

    factor: FloatArray  # (t, t, k) of the least squares, below the diagonal and on it
    heights: FloatArray  # (k, t) what the monomials are taken times
    lifted: FloatArray  # (k, c) heights of the polynomials over the points, the constant left out, zero at what fills rings up
    squares: FloatArray  # (k, 2) sums of the squares of the points' distances from the polynomials, and of their quadratic parts


def least_squares(places: FloatArray, there: Mask, degree: int, weighted: FloatArray) -> Polynomials:
    """Fit a polynomial of some degree to the `places` (3, k, c) around each of some vertices, of which those count that are `there` (k, c).

    Into `weighted` (k, t, c) go the monomials times the roots of the weights; where it has one row more than there are monomials,
    the last unknown is the height of the polynomial over the vertex.
    """
    u, v, w = places
    terms = degree * (degree + 3) // 2
    length = np.sqrt(u * u + v * v + CENTRED)
    # By the roots of their weights, so that their products are those of the least squares.
    root = np.where(there, 1.0 / length, 0.0)
    weighted[:, -1] = root
    np.multiply(u, root, out=weighted[:, 0])
    np.multiply(v, root, out=weighted[:, 1])
    first = 0
    for d in range(2, degree + 1):
        np.multiply(u[:, None], weighted[:, first : first + d], out=weighted[:, first + d : first + 2 * d])
        np.multiply(v, weighted[:, first + d - 1], out=weighted[:, first + 2 * d])
        first += d
    M = (weighted @ weighted.transpose(0, 2, 1)).transpose(1, 2, 0)
    if weighted.shape[1] > terms:
        M[terms, terms] += 1.0 / CENTRED
    factor = _factored(M)
    heights = substituted(factor, (weighted @ (root * w)[..., None])[..., 0])
    lifted = _summed(heights[:, :terms], weighted[:, :terms]) * length
    over = heights[:, terms:].sum(axis=1, keepdims=True)
    off = np.where(there, lifted + over - w, 0.0)
    bent = _summed(heights[:, 2:5], weighted[:, 2:5]) * length
    squares = np.stack([np.einsum("kc,kc->k", sums, sums) for sums in (off, bent)], axis=1)
    return Polynomials(factor, heights, lifted, squares)


def substituted(factor: FloatArray, right: FloatArray) -> FloatArray:
    """Return the solutions (k, t) of systems with lower triangles (t, t, k) for factors."""
    x = np.ascontiguousarray(right.T)
    for k in range(len(x)):
        x[k] = (x[k] - np.einsum("mk,mk->k", factor[k, :k], x[:k])) / factor[k, k]
    for k in range(len(x) - 1, -1, -1):
        x[k] = (x[k] - np.einsum("mk,mk->k", factor[k + 1 :, k], x[k + 1 :])) / factor[k, k]
    return np.ascontiguousarray(x.T)


def _factored(M: FloatArray) -> FloatArray:
    """Return the Cholesky factors, below the diagonal and on it, of matrices (t, t, k); soft pivots are lifted."""
    L = np.array(M, order="C")
    least = MIN_PIVOT * np.einsum("iik->k", L)
    for j in range(len(L)):
        L[j:, j] -= np.einsum("imk,mk->ik", L[j:, :j], L[j, :j])
        L[j, j] = np.sqrt(np.maximum(L[j, j], least))
        L[j + 1 :, j] /= L[j, j]
    return L


def _summed(heights: FloatArray, monomials: FloatArray) -> FloatArray:
    """Return the sums (k, c) of monomials (k, t, c) times heights (k, t)."""
    return (heights[:, None] @ monomials)[:, 0]
