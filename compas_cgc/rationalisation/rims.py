"""Measures of a surface within its rims: a fitted surface is arbitrary outside the mesh it was fitted to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..meshing.in_outline import inside_outline

__all__ = ["mean_steps", "within_rims"]


def within_rims(uv: FloatArray, rims: Sequence[FloatArray]) -> Mask:
    """Return which parameters (..., 2) lie within a rim and outside its holes; all where there are no rims."""
    inside = np.full(uv.shape[:-1], not len(rims))
    for rim in rims:
        inside ^= inside_outline(uv.reshape(-1, 2), rim).reshape(inside.shape)
    return inside


def mean_steps(points: FloatArray, inside: Mask, axis: int) -> FloatArray:
    """Return the mean distances (k,) between neighbours along one axis of a grid of points (a, b, 3), where both are inside.

    A step without points inside is as long as its neighbours.
    """
    first, rest = (np.take(inside, places, axis) for places in (range(inside.shape[axis] - 1), range(1, inside.shape[axis])))
    counted = first & rest
    lengths = np.linalg.norm(np.diff(points, axis=axis), axis=2)
    count = counted.sum(axis=1 - axis)
    if not count.any():
        return np.asarray(lengths.mean(axis=1 - axis))
    means = (lengths * counted).sum(axis=1 - axis) / np.maximum(count, 1)
    known = np.flatnonzero(count)
    return np.interp(np.arange(len(means)), known, means[known])
