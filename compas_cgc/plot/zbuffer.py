"""Z-buffer: the visible triangle in each pixel (Catmull, 1974)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["Fragments", "rasterise"]

_SAMPLES = 4_000_000  # number of pixels per batch, to limit memory


class Fragments(NamedTuple):
    """Nearest face in every pixel."""

    nearness: FloatArray  # (h, w) -inf in empty pixels
    face: IntArray  # (h, w) -1 in empty pixels
    weights: FloatArray  # (h, w, 3) barycentric coordinates within the face

    def interpolated(self, corners: FloatArray) -> FloatArray:
        """Return values of corners of faces (m, 3, k), interpolated at the non-empty pixels (p, k)."""
        shown = self.face >= 0
        return np.einsum("pi,pik->pk", self.weights[shown], corners[self.face[shown]])


def rasterise(triangles: FloatArray, height: int, width: int) -> Fragments:
    """Return the nearest triangle in every pixel.

    Parameters
    ----------
    triangles
        ``(m, 3, 3)`` corners: column and row in pixels, and nearness to the viewer.
    height, width
        Size of the picture [pixel].

    Returns
    -------
    Fragments
        Faces, their barycentric coordinates and nearness by pixel.

    Examples
    --------
    >>> seen = rasterise(np.array([[[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]]), 4, 4)
    >>> (seen.face == 0).astype(int)
    array([[1, 1, 1, 1],
           [1, 1, 1, 0],
           [1, 1, 0, 0],
           [1, 0, 0, 0]])
    """
    nearness = np.full(height * width, -np.inf)
    face = np.full(height * width, -1, dtype=np.int64)
    weights = np.zeros((height * width, 3))
    low = np.maximum(np.floor(triangles[:, :, :2].min(axis=1) - 0.5), 0).astype(np.int64)
    high = np.minimum(np.ceil(triangles[:, :, :2].max(axis=1) + 0.5), (width, height)).astype(np.int64)
    size = np.maximum((high - low).max(axis=1), 0)
    # Triangles of similar size are drawn together, each in a square of `side` pixels.
    step = np.exp2(np.maximum(np.floor(np.log2(np.maximum(size, 1))) - 2, 0)).astype(np.int64)
    side = np.where(((high - low) > 0).all(axis=1), -(-size // step) * step, 0)
    for s in np.unique(side[side > 0]).tolist():
        members = np.flatnonzero(side == s)
        for part in np.array_split(members, max(1, len(members) * s * s // _SAMPLES + 1)):
            _draw(triangles[part], part, low[part], s, (height, width), (nearness, face, weights))
    return Fragments(nearness.reshape(height, width), face.reshape(height, width), weights.reshape(height, width, 3))


def _draw(
    triangles: FloatArray,
    numbers: IntArray,
    low: IntArray,
    side: int,
    shape: tuple[int, int],
    seen: tuple[FloatArray, IntArray, FloatArray],
) -> None:
    """Draw triangles whose bounding boxes start at `low` (k, 2) and are at most `side` pixels wide."""
    column = low[:, 0, None, None] + np.arange(side)[None, None, :] + np.zeros((1, side, 1), dtype=np.int64)
    row = low[:, 1, None, None] + np.arange(side)[None, :, None] + np.zeros((1, 1, side), dtype=np.int64)
    a, b, c = (triangles[:, k, :2] for k in range(3))
    area = _cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.stack([column + 0.5, row + 0.5], axis=-1)
        u = _cross(at - a[:, None, None], (c - a)[:, None, None]) / area[:, None, None]
        v = _cross((b - a)[:, None, None], at - a[:, None, None]) / area[:, None, None]
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (column < shape[1]) & (row < shape[0])
    k, i, j = np.nonzero(inside)
    own = np.stack([1 - u[k, i, j] - v[k, i, j], u[k, i, j], v[k, i, j]], axis=1)
    depth = np.einsum("pi,pi->p", own, triangles[k, :, 2])
    pixel = row[k, i, j] * shape[1] + column[k, i, j]
    order = np.lexsort((depth, pixel))
    last = order[np.append(pixel[order][1:] != pixel[order][:-1], True)[: len(order)]] if len(order) else order
    nearness, face, weights = seen
    won = last[depth[last] > nearness[pixel[last]]]
    nearness[pixel[won]] = depth[won]
    face[pixel[won]] = numbers[k[won]]
    weights[pixel[won]] = own[won]


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
