"""Lines on a triangle mesh where a function of the vertices has a given value."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...meshing import crease_paths

__all__ = ["level_lines"]


def level_lines(vertices: Vertices, faces: Faces, values: FloatArray, level: float) -> list[FloatArray]:
    """Return the lines where a function that is linear on each triangle has a value.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    values
        ``(n,)`` values of the function at the vertices.
    level
        The value. Vertices with exactly this value count as above it.

    Returns
    -------
    list of (k, 3) float64
        Polylines; a closed one ends where it begins.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> [line.tolist() for line in level_lines(square, np.array([[0, 1, 2], [0, 2, 3]]), square[:, 0], 0.5)]
    [[[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 1.0, 0.0]]]
    """
    above = values >= level
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2)  # (m, 3, 2)
    crossed = above[sides[..., 0]] != above[sides[..., 1]]
    # A triangle is crossed on none or two of its sides.
    edges, number = np.unique(sides[crossed], axis=0, return_inverse=True)
    low, high = values[edges[:, 0]], values[edges[:, 1]]
    share = ((level - low) / (high - low))[:, None]
    points = (1.0 - share) * vertices[edges[:, 0]] + share * vertices[edges[:, 1]]
    return [points[path] for path in crease_paths((int(a), int(b)) for a, b in number.reshape(-1, 2))]
