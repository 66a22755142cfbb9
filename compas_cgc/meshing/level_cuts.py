"""Cutting of meshes along level lines of functions, region by region."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from .split_sides import split_sides
from .split_sides import weighted

__all__ = ["SNAP", "CutMesh", "cut_along_levels", "uncut"]

SNAP = 0.01  # relative to the edge length: lines nearer to a vertex pass through it, which avoids slivers


class CutMesh(NamedTuple):
    """A mesh with divided faces; the surface is unchanged."""

    vertices: Vertices  # (n + k, 3) mesh vertices first, then new ones on edges and in faces [L]
    faces: Faces  # (m', 3) in the order of their mesh faces
    parent: IntArray  # (m',) mesh face that contains each face
    weights: FloatArray  # (m', 3, 3) barycentric weights of the corners in the mesh face


def uncut(vertices: Vertices, faces: Faces) -> CutMesh:
    """Return a mesh as a CutMesh without cuts."""
    return CutMesh(vertices, faces, np.arange(len(faces)), np.broadcast_to(np.eye(3), (len(faces), 3, 3)))


def cut_along_levels(
    vertices: Vertices, faces: Faces, region: IntArray, values: FloatArray, levels: Sequence[Sequence[FloatArray]]
) -> tuple[CutMesh, FloatArray]:
    """Cut faces along level lines of functions, one function after the other.

    Functions are linear in every face, so that the lines are straight there. Neighbouring faces share the new vertices, also
    across region boundaries.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L], ``(m, 3)``.
    region
        ``(m,)`` region of every face, from 0.
    values
        ``(m, 3, d)`` values of d functions at the corners; they are continuous within a region.
    levels
        Sorted levels for every function and region.

    Returns
    -------
    CutMesh
        Mesh in which no side crosses a level.
    (m', 3, d) float64
        Values at its corners, exact on the level lines.
    """
    mesh = uncut(vertices, faces)
    for axis, own in enumerate(levels):
        while True:
            part = region[mesh.parent]
            height = _snapped(mesh.faces, part, values[:, :, axis], own)
            values = np.concatenate([values[:, :, :axis], height[:, :, None], values[:, :, axis + 1 :]], axis=2)
            end = np.roll(height, -1, axis=1)
            level = _first_above(np.minimum(height, end), part, own)
            crossing = level < np.maximum(height, end)
            if not crossing.any():
                break
            split = split_sides(mesh.faces, crossing, height - level, end - level, len(mesh.vertices))
            ends, share = mesh.vertices[split.ends], split.share[:, None]
            fresh = (1.0 - share) * ends[:, 0] + share * ends[:, 1]
            weights = weighted(split.weights, mesh.weights[split.parent])
            values = weighted(split.weights, values[split.parent])
            mesh = CutMesh(np.vstack([mesh.vertices, fresh]), split.faces, mesh.parent[split.parent], weights)
    return mesh, values


def _snapped(faces: Faces, part: IntArray, height: FloatArray, levels: Sequence[FloatArray]) -> FloatArray:
    """Return heights (m, 3) snapped to levels at vertices very near to a level line."""
    above, below = _first_above(height, part, levels), -_first_above(-height, part, [-own[::-1] for own in levels])
    near = np.where(above - height <= height - below, above, below)
    key = (part[:, None] * (int(faces.max(initial=0)) + 1) + faces).ravel()
    vertices, corner = np.unique(key, return_inverse=True)
    corner = corner.reshape(height.shape)
    # The steepest crossing side at a vertex determines its snapping distance.
    reach = np.zeros(len(vertices))
    for turn in (1, -1):
        other = np.roll(height, turn, axis=1)
        crosses = (height - near) * (other - near) < 0.0
        np.maximum.at(reach, corner[crosses], SNAP * np.abs(other - height)[crosses])
    exact = _is_level(height, part, levels)
    return np.where(~exact & (np.abs(near - height) < reach[corner]), near, height)


def _first_above(height: FloatArray, part: IntArray, levels: Sequence[FloatArray]) -> FloatArray:
    """Return the lowest level above each height (m, 3), infinite if there is none."""
    found = np.full(height.shape, np.inf)
    for number, own in enumerate(levels):
        inside = part == number
        found[inside] = np.append(own, np.inf)[np.searchsorted(own, height[inside], side="right")]
    return found


def _is_level(height: FloatArray, part: IntArray, levels: Sequence[FloatArray]) -> Mask:
    """Return which heights (m, 3) are exactly at a level."""
    found = np.zeros(height.shape, bool)
    for number, own in enumerate(levels):
        inside = part == number
        found[inside] = np.isin(height[inside], own)
    return found
