"""Initial assignments of panels to moulds: clusters of their K."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask

__all__ = ["clusterings", "clusterings_by_signs", "nearest_values", "signed_root"]

MAX_ROUNDS = 50  # of k-means


def clusterings(samples: list[FloatArray], weights: FloatArray, moulds: int, flat: Optional[bool]) -> Iterator[tuple[FloatArray, Mask]]:
    """Yield values (moulds,) by k-means in one dimension, with masks of those that are to stay.

    Each sample is clustered from its quantiles and from even values over its range, with 0 among the values or not.

    Parameters
    ----------
    samples
        ``(p,)`` of the panels, such as K of the design and K of the nearest surface, or their roots.
    weights
        ``(p,)`` of the panels, such as their areas.
    moulds
        Number of values.
    flat
        Whether one value is 0 and stays so. None: with and without.
    """
    for sample in samples:
        for centred in (True, False) if flat is None else (flat,):
            quantiles = _weighted_quantiles(sample, weights, (np.arange(moulds) + 0.5) / moulds)
            even = np.linspace(sample.min(), sample.max(), 2 * moulds + 1)[1::2]
            for first in (quantiles, even):
                yield _clustered(sample, weights, first.copy(), centred)


def clusterings_by_signs(
    samples: list[FloatArray], weights: FloatArray, moulds: int, flat: Optional[bool]
) -> Iterator[tuple[FloatArray, Mask]]:
    """Yield values as :func:`clusterings` does, from every number of quantiles of the negative part and the rest of the positive part."""
    for sample in samples:
        below, above = sample < 0.0, sample > 0.0
        for centred in (True, False) if flat is None else (flat,):
            curved = moulds - centred
            for negative in range(curved + 1):
                parts = [(below, negative), (above, curved - negative)]
                if all(side.any() or not count for side, count in parts):
                    firsts = [
                        _weighted_quantiles(sample[side], weights[side], (np.arange(count) + 0.5) / count) for side, count in parts if count
                    ]
                    yield _clustered(sample, weights, np.concatenate([*firsts, np.zeros(int(centred))]), centred)


def signed_root(K: FloatArray) -> FloatArray:
    """Return the roots of K with its sign [1/L].

    A surface of another K is away from a nearly flat design by the difference of their curvatures, so that nearly flat parts need as
    many values of K as strongly curved ones.
    """
    return np.sign(K) * np.sqrt(np.abs(K))


def nearest_values(sample: FloatArray, values: FloatArray) -> IntArray:
    """Return the number of the value nearest to each sample (p,)."""
    return np.argmin(np.abs(sample[:, None] - values), axis=1)


def _clustered(sample: FloatArray, weights: FloatArray, values: FloatArray, flat: bool) -> tuple[FloatArray, Mask]:
    kept = np.zeros(len(values), bool)
    if flat:
        zero = int(np.argmin(np.abs(values)))
        values[zero], kept[zero] = 0.0, True
    for _ in range(MAX_ROUNDS):
        own = nearest_values(sample, values)
        area = np.bincount(own, weights, len(values))
        means = np.bincount(own, weights * sample, len(values)) / np.where(area > 0.0, area, 1.0)
        new = np.where(kept | (area == 0.0), values, means)
        if np.array_equal(new, values):
            break
        values = new
    return values, kept


def _weighted_quantiles(sample: FloatArray, weights: FloatArray, shares: FloatArray) -> FloatArray:
    order = np.argsort(sample, kind="stable")
    at = np.cumsum(weights[order]) - 0.5 * weights[order]
    return np.interp(shares * weights.sum(), at, sample[order])
