"""Chains of curves whose ends meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["Chain", "chains"]


class Chain(NamedTuple):
    """Curves that follow each other end to end."""

    points: FloatArray  # (k, 3) [L]; the last equals the first if the chain is closed
    curves: list[int]  # numbers of its curves in order


def chains(curves: Sequence[FloatArray], tolerance: float) -> list[Chain]:
    """Join open curves (k, 3) through every place at which exactly two ends meet; across a gap both ends move to its middle.

    Parameters
    ----------
    curves
        Points (k, 3) of open curves [L].
    tolerance
        Distance within which ends meet [L].

    Returns
    -------
    list of Chain
        Every curve belongs to one chain; chains of one curve keep its points.
    """
    if not curves:
        return []
    ends = np.array([curve[k] for curve in curves for k in (0, -1)])
    partner = _partners(_nodes(ends, tolerance))
    used = np.zeros(len(curves), bool)
    result = []
    # Chains begin at loose ends and junctions; what is left are rings.
    starts = [end for end in range(len(ends)) if partner[end] < 0] + list(range(0, len(ends), 2))
    for start in starts:
        if used[start // 2]:
            continue
        chain = []
        end = start
        while end >= 0 and not used[end // 2]:
            used[end // 2] = True
            chain.append(end)
            end = int(partner[end ^ 1])
        result.append(_along(curves, chain, closes=end >= 0 and end == start))
    return result


def _nodes(ends: FloatArray, tolerance: float) -> IntArray:
    """Return the number of the place (2 m,) at which each end lies."""
    pairs = cKDTree(ends).query_pairs(tolerance, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    return connected_components(graph, directed=False)[1]


def _partners(node: IntArray) -> IntArray:
    """Return the other end (2 m,) at the place of each end, -1 where not exactly two ends meet."""
    order = np.argsort(node, kind="stable")
    counts = np.bincount(node)
    partner = np.full(len(node), -1)
    first = np.cumsum(counts) - counts
    for k in np.flatnonzero(counts == 2).tolist():
        a, b = order[first[k] : first[k] + 2].tolist()
        partner[a], partner[b] = b, a
    return partner


def _along(curves: Sequence[FloatArray], ends: Sequence[int], closes: bool) -> Chain:
    """Return the chain along curves, each from the end that is named."""
    numbers = [end // 2 for end in ends]
    if len(ends) == 1 and not closes:
        return Chain(curves[numbers[0]], numbers)
    parts = [curves[end // 2][:: -1 if end % 2 else 1].copy() for end in ends]
    for before, after in zip(parts, parts[1:]):
        middle = 0.5 * (before[-1] + after[0])
        before[-1], after[0] = middle, middle
    points = np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
    if closes:
        points[0] = points[-1] = 0.5 * (points[0] + points[-1])
    return Chain(points, numbers)
