"""Volume, area and length of a shape, with their derivatives."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["area", "area_gradient", "length", "length_gradient", "volume", "volume_gradient"]


def volume(vertices: FloatArray, faces: IntArray, level: float) -> float:
    """Return the volume between a surface (n, 3), (m, 3) and a level z [L^3]; parts below the level count as negative.

    Every face is the top of a vertical prism. The orientation of the mesh does not matter: its total plan area counts as positive.
    """
    plan, mean = _prisms(vertices, faces, level)
    return float(plan @ mean) * _side(plan)


def volume_gradient(vertices: FloatArray, faces: IntArray, level: float) -> FloatArray:
    """Return the derivative of :func:`volume` with respect to the vertices (n, 3) [L^2]."""
    plan, mean = _prisms(vertices, faces, level)
    gradient = np.zeros_like(vertices)
    for k in range(3):
        a, b = vertices[faces[:, (k + 1) % 3]], vertices[faces[:, (k + 2) % 3]]
        across = 0.5 * np.column_stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]])
        np.add.at(gradient, faces[:, k], np.column_stack([mean[:, None] * across, plan / 3.0]))
    return gradient * _side(plan)


def area(vertices: FloatArray, faces: IntArray) -> float:
    """Return the area of a surface [L^2]."""
    return 0.5 * float(np.linalg.norm(_crosses(vertices, faces), axis=1).sum())


def area_gradient(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the derivative of :func:`area` with respect to the vertices (n, 3) [L]."""
    crosses = _crosses(vertices, faces)
    lengths = np.linalg.norm(crosses, axis=1, keepdims=True)
    normals = crosses / np.where(lengths > 0.0, lengths, 1.0)
    gradient = np.zeros_like(vertices)
    for k in range(3):
        opposite = vertices[faces[:, (k + 2) % 3]] - vertices[faces[:, (k + 1) % 3]]
        np.add.at(gradient, faces[:, k], 0.5 * np.cross(normals, opposite))
    return gradient


def length(vertices: FloatArray, path: IntArray) -> float:
    """Return the length of a path of vertices (p,) [L]."""
    return float(np.linalg.norm(np.diff(vertices[path], axis=0), axis=1).sum())


def length_gradient(vertices: FloatArray, path: IntArray) -> FloatArray:
    """Return the derivative of :func:`length` with respect to the vertices (n, 3)."""
    along = np.diff(vertices[path], axis=0)
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    along = along / np.where(lengths > 0.0, lengths, 1.0)
    gradient = np.zeros_like(vertices)
    np.add.at(gradient, path[1:], along)
    np.add.at(gradient, path[:-1], -along)
    return gradient


def _crosses(vertices: FloatArray, faces: IntArray) -> FloatArray:
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    return np.cross(b - a, c - a)


def _prisms(vertices: FloatArray, faces: IntArray, level: float) -> tuple[FloatArray, FloatArray]:
    """Return the signed plan area and the mean height over the level of every face (m,)."""
    return 0.5 * _crosses(vertices, faces)[:, 2], vertices[faces, 2].mean(axis=1) - level


def _side(plan: FloatArray) -> float:
    return -1.0 if plan.sum() < 0.0 else 1.0
