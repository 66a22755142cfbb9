"""Plane triangulations as rings of neighbours, with edge flips, collapses and vertex splits."""

from __future__ import annotations

from .._compiled import kernel

__all__ = ["collapse", "flip", "split"]

MAX_VALENCE = 24  # capacity of a ring


@kernel(inner=True)
def position(rings, degree, v, u):  # type: ignore[no-untyped-def]
    """Return the index of u in the ring of v, -1 if it is not a neighbour."""
    for k in range(degree[v]):
        if rings[v, k] == u:
            return k
    return -1


@kernel(inner=True)
def insert(rings, degree, v, k, u):  # type: ignore[no-untyped-def]
    """Insert u into the ring of v before index k."""
    for i in range(degree[v], k, -1):
        rings[v, i] = rings[v, i - 1]
    rings[v, k] = u
    degree[v] += 1


@kernel(inner=True)
def remove(rings, degree, v, k):  # type: ignore[no-untyped-def]
    """Remove the neighbour at index k from the ring of v."""
    for i in range(k, degree[v] - 1):
        rings[v, i] = rings[v, i + 1]
    degree[v] -= 1


@kernel(inner=True)
def flip(rings, degree, rim, a, i):  # type: ignore[no-untyped-def]
    """Flip the edge from a to its neighbour at index i; return whether this was possible."""
    b = rings[a, i]
    k = degree[a]
    if rim[a] and (i == 0 or i == k - 1):
        return False
    c, d = rings[a, (i + 1) % k], rings[a, (i - 1) % k]
    if position(rings, degree, c, d) >= 0 or degree[c] >= MAX_VALENCE - 1 or degree[d] >= MAX_VALENCE - 1:
        return False
    if degree[a] < (3 if rim[a] else 5) or degree[b] < (3 if rim[b] else 5):
        return False
    remove(rings, degree, a, i)
    remove(rings, degree, b, position(rings, degree, b, a))
    insert(rings, degree, c, position(rings, degree, c, a) + 1, d)
    insert(rings, degree, d, position(rings, degree, d, b) + 1, c)
    return True


@kernel(inner=True)
def collapse(rings, degree, rim, a, i):  # type: ignore[no-untyped-def]
    """Collapse the inner vertex a into its neighbour at index i; return whether this was possible."""
    b, k = rings[a, i], degree[a]
    if rim[a] or degree[b] + k - 4 >= MAX_VALENCE - 1:
        return False
    common = 0
    for j in range(k):
        if position(rings, degree, b, rings[a, j]) >= 0:
            common += 1
    c, d = rings[a, (i + 1) % k], rings[a, (i - 1) % k]
    if common != 2 or degree[c] < (3 if rim[c] else 5) or degree[d] < (3 if rim[d] else 5):
        return False
    place = position(rings, degree, b, a)
    remove(rings, degree, b, place)
    for step in range(k - 2, 1, -1):
        insert(rings, degree, b, place, rings[a, (i + step) % k])
    remove(rings, degree, c, position(rings, degree, c, a))
    remove(rings, degree, d, position(rings, degree, d, a))
    for step in range(2, k - 1):
        x = rings[a, (i + step) % k]
        rings[x, position(rings, degree, x, a)] = b
    degree[a] = 0
    return True


@kernel(inner=True)
def split(rings, degree, rim, v, i, count, w):  # type: ignore[no-untyped-def]
    """Split v: the new vertex w gets the neighbours from index i to i + count; return whether this was possible."""
    k = degree[v]
    if count < 2 or count > k - 2 or (rim[v] and i + count > k - 1):
        return False
    first, last = rings[v, i], rings[v, (i + count) % k]
    if degree[first] >= MAX_VALENCE - 1 or degree[last] >= MAX_VALENCE - 1:
        return False
    rings[w, 0] = v
    for step in range(count + 1):
        rings[w, step + 1] = rings[v, (i + step) % k]
    degree[w] = count + 2
    for step in range(1, count):
        x = rings[v, (i + step) % k]
        rings[x, position(rings, degree, x, v)] = w
    insert(rings, degree, first, position(rings, degree, first, v), w)
    insert(rings, degree, last, position(rings, degree, last, v) + 1, w)
    for step in range(1, count):
        x = rings[w, step + 1]
        remove(rings, degree, v, position(rings, degree, v, x))
    insert(rings, degree, v, position(rings, degree, v, first) + 1, w)
    return True
