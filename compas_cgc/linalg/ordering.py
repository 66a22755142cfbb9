"""Elimination orders that keep the factors of mesh matrices sparse: nested dissection, and minimum degree for small ones."""

from __future__ import annotations

from typing import Any
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from .._compiled import kernel
from ..discrete._memo import remembered
from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray

__all__ = ["MATRIX_BYTES", "elimination_order", "has_pattern", "minimum_degree", "nested_dissection"]

DISSECT_FROM = 3000  # unknowns; below, minimum degree is as good, and compiled in SciPy

MATRIX_BYTES = 8_000_000  # of the sparsity of a matrix and the places of its unknowns, for a mesh of some 8,000 vertices

LANDMARKS = 3
MIN_EXTENT = 0.3  # relative to the largest extent; shorter directions are not cut
LEFT, RIGHT = 1, 2


def has_pattern(matrix: sparse.csr_matrix, pattern: Optional[tuple[CSRIndices, CSRIndices]]) -> bool:
    """Return whether the entries of a matrix have the row pointers and column indices of a pattern."""
    own = (matrix.indptr, matrix.indices)
    return pattern is not None and all(old is new or np.array_equal(old, new) for old, new in zip(pattern, own))


def elimination_order(matrix: sparse.csr_matrix, points: Optional[FloatArray] = None) -> Indices:
    """Return an elimination order (n,) for a matrix of symmetric sparsity: by minimum degree if it is small, else by nested dissection."""
    return minimum_degree(matrix) if matrix.shape[0] < DISSECT_FROM else nested_dissection(matrix, points)


def minimum_degree(matrix: sparse.csr_matrix) -> Indices:
    """Return the minimum degree order (n,) of SuperLU: the unknown with the fewest neighbours is eliminated next.

    SciPy returns it together with factors only, so a diagonally dominant matrix of the same sparsity is factorised.

    References
    ----------
    Liu, doi:10.1145/214392.214398.
    """
    return _minimum_degree(matrix.indptr, matrix.indices) if matrix.shape[0] else np.arange(0)


@remembered
def _minimum_degree(indptr: CSRIndices, indices: CSRIndices) -> Indices:
    n = len(indptr) - 1
    standin = sparse.csc_matrix((np.full(len(indices), -1.0), indices, indptr), shape=(n, n))
    standin += sparse.diags(np.full(n, 2.0 + np.diff(indptr).max()), format="csc")
    return np.argsort(splu(standin, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).perm_c)


def nested_dissection(matrix: sparse.csr_matrix, points: Optional[FloatArray] = None, leaf: int = 8) -> Indices:
    """Return an elimination order that recursively halves the unknowns by position.

    A part is cut at the median of one coordinate, the one that leaves the fewest unknowns next to
    the cut; these are eliminated after both halves. On surface meshes the factors then have
    O(n log n) entries, whatever the layout of the mesh, and the order is found in a fraction of the
    time of the factorisation.

    Parameters
    ----------
    matrix
        ``(n, n)`` with a symmetric sparsity.
    points
        ``(n, d)`` positions of the unknowns; coupled unknowns have to be close. They are used besides the graph distances
        from a few unknowns far apart. On irregular meshes they halve the size of the factors.
    leaf
        Parts of at most this size are not cut.

    Returns
    -------
    (n,) int64
        ``order[k]`` is the k-th unknown to be eliminated.

    References
    ----------
    George, doi:10.1137/0710032.

    Examples
    --------
    >>> from scipy import sparse
    >>> path = sparse.diags([np.ones(8), np.ones(9), np.ones(8)], [-1, 0, 1]).tocsr()
    >>> sorted(nested_dissection(path).tolist())
    [0, 1, 2, 3, 4, 5, 6, 7, 8]
    """
    return _nested_dissection(matrix.indptr, matrix.indices, np.zeros((0, 0)) if points is None else points, leaf)


def _dissected(indptr: CSRIndices, indices: CSRIndices, points: FloatArray, leaf: int) -> Indices:
    places = _distances(indptr, indices)
    if len(points):
        own = np.transpose(points) * (np.ptp(places) / (np.ptp(points, axis=0).max() or 1.0))
        places = np.vstack([places, own])
    return _dissect(indptr, indices, places, leaf)


_nested_dissection = remembered(_dissected, largest=MATRIX_BYTES)


@kernel()
def _distances(indptr: CSRIndices, indices: CSRIndices) -> FloatArray:
    """Return the graph distances (3, n) from landmarks; disconnected parts are placed one behind the other."""
    n = len(indptr) - 1
    places = np.zeros((LANDMARKS, n))
    nearest = np.full(n, n)
    level = np.full(n, -1)
    queue = np.empty(n, np.int64)
    behind = 0
    for first in range(n):
        if level[first] >= 0:
            continue
        # The last in the queue is the farthest from the first.
        reached = _spread(indptr, indices, first, level, queue)
        landmark = queue[reached - 1]
        farthest = 0
        for k in range(LANDMARKS):
            for i in queue[:reached]:
                level[i] = -1
            _spread(indptr, indices, landmark, level, queue)
            for i in queue[:reached]:
                places[k, i] = behind + level[i]
                nearest[i] = min(nearest[i], level[i])
                farthest = max(farthest, level[i])
                if nearest[i] > nearest[landmark]:
                    landmark = i
        behind += farthest + 1
    return places


@kernel()
def _spread(indptr: CSRIndices, indices: CSRIndices, first: int, level: IntArray, queue: IntArray) -> int:
    """Write the graph distances from a first unknown by breadth-first search; return how many unknowns are reached."""
    level[first], queue[0] = 0, first
    done, reached = 0, 1
    while done < reached:
        i = queue[done]
        done += 1
        for at in range(indptr[i], indptr[i + 1]):
            j = indices[at]
            if level[j] < 0:
                level[j] = level[i] + 1
                queue[reached] = j
                reached += 1
    return reached


@kernel()
def _dissect(indptr: CSRIndices, indices: CSRIndices, places: FloatArray, leaf: int) -> Indices:
    n, d = len(indptr) - 1, len(places)
    order = np.arange(n)
    half = np.zeros(n, np.int8)
    extent = np.empty(d)
    todo = [(0, n)]
    while len(todo) > 0:
        low, high = todo.pop()
        if high - low <= leaf:
            continue
        part = np.empty(high - low, np.int64)
        for k in range(high - low):
            part[k] = order[low + k]
        for k in range(d):
            extent[k] = _extent(part, places[k])
        best, last, thin, fewest = 0, -1, RIGHT, n
        longest = 0.0
        for k in range(d):
            longest = max(longest, extent[k])
        for k in range(d):
            if extent[k] >= MIN_EXTENT * longest:
                _halve(part, places[k], half)
                lefts, rights = _beside(indptr, indices, part, half)
                last = k
                if min(lefts, rights) < fewest:
                    best, fewest = k, min(lefts, rights)
                    thin = LEFT if lefts < rights else RIGHT
        if best != last:
            _halve(part, places[best], half)
        a, c = low, high
        for i in part:
            if half[i] == thin and _touches(indptr, indices, i, half):
                c -= 1
                order[c] = i
            elif half[i] == LEFT:
                order[a] = i
                a += 1
        b = a
        for i in part:
            if half[i] == RIGHT and not (thin == RIGHT and _touches(indptr, indices, i, half)):
                order[b] = i
                b += 1
        for i in part:
            half[i] = 0
        todo.append((low, a))
        todo.append((a, b))
    return order


@kernel()
def _extent(part: Indices, place: FloatArray) -> Any:
    """Return the extent of a part along one coordinate."""
    low, high = np.inf, -np.inf
    for i in part:
        low, high = min(low, place[i]), max(high, place[i])
    return high - low


@kernel()
def _halve(part: Indices, place: FloatArray, half: NDArray[np.int8]) -> None:
    """Assign the unknowns of a part below the median coordinate to the left half, the others to the right."""
    middle = len(part) // 2
    median = _select(part, place, middle)
    lefts = 0
    for i in part:
        if place[i] < median:
            lefts += 1
    # Unknowns at the median fill up the left half.
    spare = middle - lefts if lefts < max(1, middle // 2) else 0
    for i in part:
        half[i] = LEFT if place[i] < median else RIGHT
        if place[i] == median and spare > 0:
            half[i] = LEFT
            spare -= 1


@kernel()
def _select(part: Indices, place: FloatArray, k: int) -> Any:
    """Return the k-th smallest coordinate of a part, by Hoare's quickselect."""
    keys = np.empty(len(part))
    for a in range(len(part)):
        keys[a] = place[part[a]]
    low, high = 0, len(part) - 1
    while low < high:
        # With the median of three as pivot, sorted coordinates do not take quadratic time.
        first, mid, last = keys[low], keys[(low + high) // 2], keys[high]
        pivot = max(min(first, mid), min(max(first, mid), last))
        a, b = low, high
        while a <= b:
            while keys[a] < pivot:
                a += 1
            while keys[b] > pivot:
                b -= 1
            if a <= b:
                keys[a], keys[b] = keys[b], keys[a]
                a += 1
                b -= 1
        if k <= b:
            high = b
        elif k >= a:
            low = a
        else:
            break
    return keys[k]


@kernel()
def _beside(indptr: CSRIndices, indices: CSRIndices, part: Indices, half: NDArray[np.int8]) -> tuple[int, int]:
    """Return how many unknowns of each half have a neighbour in the other."""
    lefts, rights = 0, 0
    for i in part:
        if _touches(indptr, indices, i, half):
            if half[i] == LEFT:
                lefts += 1
            else:
                rights += 1
    return lefts, rights


@kernel()
def _touches(indptr: CSRIndices, indices: CSRIndices, i: int, half: NDArray[np.int8]) -> bool:
    other = LEFT + RIGHT - half[i]
    for at in range(indptr[i], indptr[i + 1]):
        if half[indices[at]] == other:
            return True
    return False
