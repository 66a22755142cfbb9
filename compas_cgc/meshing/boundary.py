"""Boundary loops and named supports."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete._memo import remembered
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.normals import unit_vectors
from ..discrete.topology import boundary_mask
from ..errors import names_what_was_meant

__all__ = ["SUPPORT_NAMES", "boundary_loops", "corners_of", "named_supports"]

SUPPORT_NAMES = ("boundary", "outline", "corners")

SHARPER_COSINE = 0.05  # difference of cosines by which a lifted neighbour turns more sharply


@names_what_was_meant()
def boundary_loops(faces: IntArray) -> list[IntArray]:
    """Return the boundary loops as vertices, with the surface to their left.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.

    Returns
    -------
    list of (b,) int64
        Loops, the longest first; each starts at its smallest vertex.

    Examples
    --------
    >>> [loop.tolist() for loop in boundary_loops(np.array([[0, 1, 2], [0, 2, 3]]))]
    [[0, 1, 2, 3]]
    """
    return _boundary_loops(np.ascontiguousarray(faces, dtype=np.int64).reshape(-1, 3))


@remembered
def _boundary_loops(F: IntArray) -> list[IntArray]:
    n = int(F.max(initial=0)) + 1
    rim = boundary_mask(n, F)
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    near = rim[u] & rim[v]
    u, v = u[near], v[near]
    open_ = ~np.isin(u * n + v, v * n + u)
    # Where loops touch in a vertex, its first outgoing edge counts.
    after = dict(zip(u[open_][::-1].tolist(), v[open_][::-1].tolist()))
    loops = []
    for start in sorted(after):
        loop = []
        key = start
        while key in after:
            loop.append(key)
            key = after.pop(key)
        if loop:
            loops.append(loop)
    return [np.array(loop, dtype=np.int64) for loop in sorted(loops, key=lambda loop: (-len(loop), loop))]


@names_what_was_meant()
def named_supports(vertices: FloatArray, faces: IntArray, name: str) -> IntArray:
    """Return the boundary vertices that are selected by a name, such as ``corners``.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    name
        ``"boundary"`` for all boundary vertices, ``"outline"`` for those of the outer boundary of each piece without holes,
        ``"corners"`` for those where the boundary turns by more than 30 degrees. The turns beside a lifted corner do not count.

    Returns
    -------
    (k,) int64
        Indices of vertices.

    Raises
    ------
    ValueError
        If the name is unknown.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> sorted(named_supports(square, np.array([[0, 1, 2], [0, 2, 3]]), "corners").tolist())
    [0, 1, 2, 3]
    """
    if name not in SUPPORT_NAMES:
        raise ValueError(f"supports must be vertices, 'boundary', 'outline' or 'corners', not {name!r}")
    loops = boundary_loops(faces)
    if name == "outline":
        loops = _outlines(vertices, faces, loops)
    elif name == "corners":
        loops = [loop[corners_of(vertices[loop])] for loop in loops]
    return np.concatenate(loops) if loops else np.empty(0, np.int64)


def _outlines(vertices: FloatArray, faces: IntArray, loops: list[IntArray]) -> list[IntArray]:
    """Return the boundary loop of largest extent of each piece."""
    n = len(vertices)
    joined = sparse.coo_matrix((np.ones(faces.size), (faces.ravel(), np.roll(faces, -1, axis=1).ravel())), shape=(n, n))
    piece = connected_components(joined, directed=False)[1]
    reach = [float(np.linalg.norm(np.ptp(vertices[loop], axis=0))) for loop in loops]
    widest: dict[int, int] = {}
    for k in sorted(range(len(loops)), key=lambda k: reach[k]):
        widest[int(piece[loops[k][0]])] = k
    return [loops[k] for k in sorted(widest.values())]


def corners_of(points: FloatArray, angle: float = 30.0) -> Mask:
    """Return where a closed polyline (b, 3) turns by more than an angle in degrees (b,), without neighbours of lifted corners."""
    least = np.cos(np.radians(angle))
    cosine = _cosines(points)
    turns = cosine < least
    facing = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    square = float(facing @ facing)
    if not square > 0.0:
        return turns
    in_plan = _cosines(points - np.outer(points @ facing, facing) / square) < least
    sharper = np.minimum(np.roll(cosine, 1), np.roll(cosine, -1)) < cosine - SHARPER_COSINE
    return turns & (in_plan | ~sharper)


def _cosines(points: FloatArray) -> FloatArray:
    """Return the cosines of the turning angles of a closed polyline (b, 3): (b,)."""
    ahead = unit_vectors(np.roll(points, -1, axis=0) - points)
    return np.asarray(np.einsum("ij,ij->i", ahead, np.roll(ahead, 1, axis=0)))
