"""The open edges of a mesh, as loops."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.normals import unit_vectors
from ..discrete.topology import boundary_mask

__all__ = ["boundary_loops", "loop_corners"]


def boundary_loops(faces: IntArray) -> list[IntArray]:
    """Return the loops of vertices around the open edges, with the surface to their left.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.

    Returns
    -------
    list of (b,) int64
        The longest first; each starts at its smallest vertex.
    """
    F = np.ascontiguousarray(faces, dtype=np.int64).reshape(-1, 3)
    n = int(F.max(initial=0)) + 1
    rim = boundary_mask(n, F)
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    near = rim[u] & rim[v]
    u, v = u[near], v[near]
    open_ = ~np.isin(u * n + v, v * n + u)
    # Where loops touch in a vertex the first edge out of it counts.
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


def loop_corners(points: FloatArray, angle: float = 30.0) -> np.ndarray:
    """Tell where a closed polyline (b, 3) turns by more than an angle in degrees (b,)."""
    ahead = unit_vectors(np.roll(points, -1, axis=0) - points)
    cosine = np.einsum("ij,ij->i", ahead, np.roll(ahead, 1, axis=0))
    return cosine < np.cos(np.radians(angle))
