"""Simulated annealing of plane triangulations towards valence 6 by flips, collapses and splits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .._compiled import kernel
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from .rings import MAX_VALENCE
from .rings import collapse
from .rings import flip
from .rings import split

__all__ = ["annealed"]

TRIALS_PER_VERTEX, MAX_TRIALS = 400, 250_000  # trials per irregular vertex, and in total
START_TEMPERATURE, END_TEMPERATURE = 1.5, 0.05  # temperatures in units of a valence error of one
SHAPE_WEIGHT, SIZE_WEIGHT = 3.0, 0.8  # weights of triangle shapes and sizes
MIN_ANGLE = np.radians(28.0)  # least angle after a change, unless a smaller one existed before
SWEEPS = 3  # smoothing sweeps around a change
PATCH_SIZE = 96  # largest number of vertices around a change


def annealed(
    plan: FloatArray, faces: IntArray, held: Mask, kept: IntArray, sizes: Callable[[FloatArray], FloatArray]
) -> tuple[FloatArray, IntArray]:
    """Return points (n', 2) and triangles (m', 3) with more valences of 6.

    A pair of valences 5 and 7 is a dislocation: flips make it glide, collapses and splits make it climb, until it meets another one
    or the boundary. Changes are accepted by the Metropolis rule after smoothing of the vertices around them.

    Parameters
    ----------
    plan
        ``(n, 2)`` [L].
    faces
        ``(m, 3)`` triangles, counterclockwise.
    held
        ``(n,)`` mask of fixed points, which keep their order in the result.
    kept
        ``(k, 2)`` fixed edges; boundary edges are always fixed.
    sizes
        Function from points (k, 2) to edge lengths (k,) [L].

    References
    ----------
    Surazhsky and Gotsman 2003, Explicit surface remeshing, for the changes; Kirkpatrick et al., doi:10.1126/science.220.4598.671.
    """
    n = len(plan)
    around = _rings(n, faces)
    if around is None:
        return plan, faces
    room = n + n // 3 + 64
    rings, degree, rim = np.zeros((room, MAX_VALENCE), np.int64), np.zeros(room, np.int64), np.zeros(room, bool)
    for v, (ring, open_) in enumerate(around):
        rings[v, : len(ring)], degree[v], rim[v] = ring, len(ring), open_
    odd = int(np.count_nonzero(degree[:n][~rim[:n]] != 6))
    points, free, size = np.zeros((room, 2)), np.ones(room, bool), np.ones(room)
    points[:n], free[:n], size[:n] = plan, ~held, sizes(plan)
    chains = np.full((room, 8), -1)
    for a, b in np.concatenate([kept, kept[:, ::-1]]).tolist():
        place = np.flatnonzero(chains[a] < 0)
        if not len(place):
            return plan, faces
        chains[a, place[0]] = b
    count = _anneal(points, rings, degree, rim, free, chains, size, n, min(TRIALS_PER_VERTEX * odd, MAX_TRIALS), np.array([1], np.uint64))
    return _triangles(points, rings, degree, rim, count)


def _rings(n: int, faces: IntArray) -> list[tuple[list[int], bool]] | None:
    """Return the counterclockwise neighbours of every vertex, and whether it is on the boundary; None if fans meet in a vertex."""
    onward: list[dict[int, int]] = [{} for _ in range(n)]
    for face in faces.tolist():
        for k in range(3):
            onward[face[k]][face[(k + 1) % 3]] = face[(k + 2) % 3]
    found = []
    for follows in onward:
        starts = follows.keys() - follows.values()
        if len(starts) > 1 or not follows:
            return None
        at = next(iter(starts)) if starts else next(iter(follows))
        ring = [at]
        while at in follows and follows[at] != ring[0]:
            at = follows[at]
            ring.append(at)
        if len(ring) != len(follows) + len(starts) or len(ring) >= MAX_VALENCE - 2:
            return None
        found.append((ring, bool(starts)))
    return found


def _triangles(points: FloatArray, rings: IntArray, degree: IntArray, rim: Mask, count: int) -> tuple[FloatArray, IntArray]:
    alive = degree[:count] > 0
    number = np.cumsum(alive) - 1
    faces = []
    for v in np.flatnonzero(alive).tolist():
        ring = rings[v, : degree[v]].tolist()
        faces += [(v, a, b) for a, b in zip(ring, ring[1:] if rim[v] else ring[1:] + ring[:1]) if v < a and v < b]
    return points[:count][alive], number[np.array(faces, dtype=np.int64)]


@kernel(inner=True)
def _drawn(state, most):  # type: ignore[no-untyped-def]
    """Return the next pseudo-random number from 0 to most - 1 (xorshift)."""
    x = state[0]
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    state[0] = x
    return np.int64((x >> np.uint64(11)) % np.uint64(most))


@kernel(inner=True)
def _shape(p, q, r):  # type: ignore[no-untyped-def]
    """Return the ratio of squared sides to area, 1 for equilateral triangles, and twice the area."""
    area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    sides = (q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2 + (r[0] - q[0]) ** 2 + (r[1] - q[1]) ** 2 + (p[0] - r[0]) ** 2 + (p[1] - r[1]) ** 2
    return sides / (2.0 * np.sqrt(3.0) * area) if area > 0.0 else np.inf, area


@kernel(inner=True)
def _least_angle(p, q, r):  # type: ignore[no-untyped-def]
    """Return the smallest angle of a triangle."""
    a = (q[0] - r[0]) ** 2 + (q[1] - r[1]) ** 2
    b = (p[0] - r[0]) ** 2 + (p[1] - r[1]) ** 2
    c = (q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2
    least = min(a, b, c)
    area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    return np.arctan2(area, 0.5 * (a + b + c) - least)


@kernel(inner=True)
def _around(points, rings, degree, rim, v):  # type: ignore[no-untyped-def]
    """Return the sum of the squared shape ratios of the triangles at a vertex."""
    total = 0.0
    k = degree[v]
    for j in range(k - 1 if rim[v] else k):
        found, _ = _shape(points[v], points[rings[v, j]], points[rings[v, (j + 1) % k]])
        total += found * found
    return total


@kernel(inner=True)
def _centred(points, rings, degree, rim, v):  # type: ignore[no-untyped-def]
    """Move a vertex towards the position of best triangles, weighted by their shape ratio, if this improves them."""
    x, y = points[v, 0], points[v, 1]
    k = degree[v]
    sx, sy, weight = 0.0, 0.0, 0.0
    for j in range(k):
        # Apex of the equilateral triangle over each side of the ring.
        q, r = points[rings[v, j]], points[rings[v, (j + 1) % k]]
        found, _ = _shape(points[v], q, r)
        part = found if found < 20.0 else 20.0
        sx += part * (0.5 * (q[0] + r[0]) - 0.5 * np.sqrt(3.0) * (r[1] - q[1]))
        sy += part * (0.5 * (q[1] + r[1]) + 0.5 * np.sqrt(3.0) * (r[0] - q[0]))
        weight += part
    before = _around(points, rings, degree, rim, v)
    share = 1.0
    for _ in range(5):
        points[v, 0], points[v, 1] = x + share * (sx / weight - x), y + share * (sy / weight - y)
        if _around(points, rings, degree, rim, v) < before:
            return
        share *= 0.4
    points[v, 0], points[v, 1] = x, y


@kernel(inner=True)
def _cost(points, rings, degree, rim, size, patch, held, length):  # type: ignore[no-untyped-def]
    """Return the cost of the vertices and triangles of a patch, and the smallest angle."""
    total, angle = 0.0, 4.0
    for at in range(length):
        v = patch[at]
        k = degree[v]
        if k == 0:
            continue
        if not rim[v]:
            total += (k - 6.0) ** 2
        for j in range(k - 1 if rim[v] else k):
            a, b = rings[v, j], rings[v, (j + 1) % k]
            # Count each triangle once, at its first corner in the patch.
            if (held[a] and a < v) or (held[b] and b < v):
                continue
            shape, area = _shape(points[v], points[a], points[b])
            if area <= 0.0:
                return np.inf, -1.0
            asked = (size[v] + size[a] + size[b]) / 3.0
            off = np.log(area / (0.5 * np.sqrt(3.0) * asked * asked))
            total += SHAPE_WEIGHT * (shape - 1.0) + SIZE_WEIGHT * off * off
            angle = min(angle, _least_angle(points[v], points[a], points[b]))
    return total, angle


@kernel(inner=True)
def _joined(rings, degree, patch, held, length, v):  # type: ignore[no-untyped-def]
    """Add a vertex and its neighbours to a patch and return its new length."""
    for j in range(-1, degree[v]):
        u = v if j < 0 else rings[v, j]
        if not held[u] and length < PATCH_SIZE:
            held[u] = True
            patch[length] = u
            length += 1
    return length


@kernel(inner=True)
def _is_kept(chains, a, b):  # type: ignore[no-untyped-def]
    for k in range(chains.shape[1]):
        if chains[a, k] == b:
            return True
    return False


@kernel(inner=True)
def _odd_one(degree, rim, count, state):  # type: ignore[no-untyped-def]
    """Return a random irregular vertex, or -1 if none was found."""
    for _ in range(8 * count):
        v = _drawn(state, count)
        if degree[v] > 0 and not rim[v] and degree[v] != 6:
            return v
    return -1


@kernel(inner=True)
def _copied(points, rings, degree, patch, length, old_points, old_rings, old_degree):  # type: ignore[no-untyped-def]
    """Save a patch before a change."""
    for at in range(length):
        u = patch[at]
        old_degree[at] = degree[u]
        old_points[at, 0], old_points[at, 1] = points[u, 0], points[u, 1]
        for j in range(degree[u]):
            old_rings[at, j] = rings[u, j]


@kernel(inner=True)
def _undone(points, rings, degree, patch, length, old_points, old_rings, old_degree):  # type: ignore[no-untyped-def]
    """Restore a patch."""
    for at in range(length):
        u = patch[at]
        degree[u] = old_degree[at]
        points[u, 0], points[u, 1] = old_points[at, 0], old_points[at, 1]
        for j in range(degree[u]):
            rings[u, j] = old_rings[at, j]


@kernel(inner=True)
def _collapsed(points, rings, degree, rim, free, v, i):  # type: ignore[no-untyped-def]
    """Collapse a vertex into its neighbour, which moves half way if free; return whether this was possible."""
    b = rings[v, i]
    if not collapse(rings, degree, rim, v, i):
        return False
    if free[b]:
        points[b, 0], points[b, 1] = 0.5 * (points[b, 0] + points[v, 0]), 0.5 * (points[b, 1] + points[v, 1])
    return True


@kernel(inner=True)
def _parted(points, rings, degree, rim, free, chains, size, v, i, steps, new):  # type: ignore[no-untyped-def]
    """Split a vertex at a range of its neighbours; return whether this was possible."""
    k = degree[v]
    if steps > k - 2:
        return False
    if not free[v]:
        for step in range(1, steps):
            if _is_kept(chains, v, rings[v, (i + step) % k]):
                return False
    x, y = 0.0, 0.0
    for step in range(steps + 1):
        q = points[rings[v, (i + step) % k]]
        x, y = x + q[0] / (steps + 1), y + q[1] / (steps + 1)
    if not split(rings, degree, rim, v, i, steps, new):
        return False
    points[new, 0], points[new, 1] = 0.5 * (x + points[v, 0]), 0.5 * (y + points[v, 1])
    size[new], free[new], rim[new] = size[v], True, False
    for k in range(chains.shape[1]):
        chains[new, k] = -1
    return True


@kernel(inner=True)
def _evened(points, rings, degree, rim, free, patch, length):  # type: ignore[no-untyped-def]
    """Smooth the free vertices of a patch."""
    for _ in range(SWEEPS):
        for at in range(length):
            u = patch[at]
            if degree[u] > 0 and free[u] and not rim[u]:
                _centred(points, rings, degree, rim, u)


@kernel()
def _anneal(points, rings, degree, rim, free, chains, size, count, trials, state):  # type: ignore[no-untyped-def]
    """Anneal the arrays in place and return the number of used rows."""
    room = len(degree)
    patch, held = np.zeros(PATCH_SIZE, np.int64), np.zeros(room, np.bool_)
    old_rings, old_degree, old_points = (
        np.zeros((PATCH_SIZE, MAX_VALENCE), np.int64),
        np.zeros(PATCH_SIZE, np.int64),
        np.zeros((PATCH_SIZE, 2)),
    )
    for trial in range(trials):
        heat = START_TEMPERATURE * (END_TEMPERATURE / START_TEMPERATURE) ** (trial / trials)
        v = _odd_one(degree, rim, count, state)
        if v < 0:
            break
        # Change the vertex or a neighbour.
        if _drawn(state, 2) == 0:
            v = rings[v, _drawn(state, degree[v])]
        i = _drawn(state, degree[v])
        b = rings[v, i]
        way = _drawn(state, 4)
        length = _joined(rings, degree, patch, held, 0, v)
        length = _joined(rings, degree, patch, held, length, b)
        if way == 0:
            for at in range(length):
                length = _joined(rings, degree, patch, held, length, patch[at])
        before, angle_before = _cost(points, rings, degree, rim, size, patch, held, length)
        _copied(points, rings, degree, patch, length, old_points, old_rings, old_degree)
        done, added = False, 0
        if way <= 1:
            done = not _is_kept(chains, v, b) and flip(rings, degree, rim, v, i)
        elif way == 2:
            done = free[v] and length < PATCH_SIZE - 1 and _collapsed(points, rings, degree, rim, free, v, i)
        elif count < room and length < PATCH_SIZE - 1 and degree[v] < MAX_VALENCE - 4:
            done = _parted(points, rings, degree, rim, free, chains, size, v, i, 2 + _drawn(state, 3), count)
            if done:
                patch[length], held[count] = count, True
                length, count, added = length + 1, count + 1, 1
        after, angle = np.inf, 0.0
        if done:
            after, angle = _cost(points, rings, degree, rim, size, patch, held, length)
            if after < np.inf:
                _evened(points, rings, degree, rim, free, patch, length)
                after, angle = _cost(points, rings, degree, rim, size, patch, held, length)
        taken = done and after < np.inf and angle >= min(MIN_ANGLE, angle_before)
        if taken and after > before:
            taken = np.exp((before - after) / heat) * 1048576.0 > _drawn(state, 1048576)
        for at in range(length):
            held[patch[at]] = False
        if done and not taken:
            length, count = length - added, count - added
            degree[count : count + added] = 0
            _undone(points, rings, degree, patch, length, old_points, old_rings, old_degree)
    return count
