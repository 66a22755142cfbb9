"""Closest points on a polyline."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray

__all__ = ["feet_on_polyline"]

MAX_PAIRS = 500_000  # point-segment pairs per block


def feet_on_polyline(points: FloatArray, polyline: FloatArray, closed: bool = False) -> tuple[FloatArray, FloatArray]:
    """Return the nearest points of a polyline and its tangents there.

    Parameters
    ----------
    points
        ``(k, 3)`` points [L].
    polyline
        ``(p, 3)`` corners [L].
    closed
        Whether the last corner is joined to the first.

    Returns
    -------
    (k, 3) float64
        Nearest points [L].
    (k, 3) float64
        Unit tangents: of the segment, at a corner the mean of both segments, zero at the end of
        an open polyline.
    """
    corners = np.asarray(polyline, dtype=np.float64)
    if closed:
        corners = np.vstack([corners, corners[:1]])
    along = np.diff(corners, axis=0)
    kept = np.einsum("ij,ij->i", along, along) > 0
    first, along = corners[:-1][kept], along[kept]
    square = np.einsum("ij,ij->i", along, along)
    tangent = along / np.sqrt(square)[:, None]
    last = len(along) - 1
    closest, slide = np.empty_like(points), np.empty_like(points)
    step = max(1, MAX_PAIRS // max(1, len(along)))
    for begin in range(0, len(points), step):
        here = points[begin : begin + step]
        share = np.clip(((here[:, None] - first) * along).sum(axis=2) / square, 0.0, 1.0)
        foot = first + share[:, :, None] * along
        best = np.argmin(((here[:, None] - foot) ** 2).sum(axis=2), axis=1)
        row = np.arange(len(here))
        share = share[row, best]
        other = np.where(share == 0.0, best - 1, np.where(share == 1.0, best + 1, best))
        ended = np.zeros(len(here), bool) if closed else (other < 0) | (other > last)
        direction = tangent[best] + tangent[other % (last + 1)]
        length = np.linalg.norm(direction, axis=1, keepdims=True)
        direction = np.where(length > 0, direction / np.where(length > 0, length, 1.0), tangent[best])
        closest[begin : begin + step] = foot[row, best]
        slide[begin : begin + step] = np.where(ended[:, None], 0.0, direction)
    return closest, slide
