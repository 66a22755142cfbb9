"""Meshes cut through their faces along the level lines of functions, region by region."""

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

SNAP = 0.01  # of an edge: a line that passes a vertex so near goes through it, lest slivers arise


class CutMesh(NamedTuple):
    """A mesh whose faces are divided; the surface is the same."""

    vertices: Vertices  # (n + k, 3) those of the mesh first, then new ones on its edges and inside of its faces [L]
    faces: Faces  # (m', 3) in the order of the faces that they are parts of
    parent: IntArray  # (m',) face of the mesh that each is, or is a part of
    weights: FloatArray  # (m', 3, 3) barycentric weights of the corners in that face


def uncut(vertices: Vertices, faces: Faces) -> CutMesh:
    """Return a mesh as one of which nothing is divided."""
    return CutMesh(vertices, faces, np.arange(len(faces)), np.broadcast_to(np.eye(3), (len(faces), 3, 3)))


def cut_along_levels(
    vertices: Vertices, faces: Faces, region: IntArray, values: FloatArray, levels: Sequence[Sequence[FloatArray]]
) -> tuple[CutMesh, FloatArray]:
    """Cut faces along the lines on which functions have given values, one function after the other.

    Functions are linear in every face, so the lines are straight there. Neighbours of faces that are cut share the new vertices,
    across the borders of regions too.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L], ``(m, 3)``.
    region
        ``(m,)`` region of every face, from 0.
    values
        ``(m, 3, d)`` values of d functions at the corners; those of one region agree where faces meet.
    levels
        For every function and region, the values to cut along, sorted.

    Returns
    -------
    CutMesh
        No side of its faces crosses a level.
    (m', 3, d) float64
        Values at its corners; on the lines exactly those of the levels.
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
    """Return heights (m, 3) of which those are a level's that a line passes very near to."""
    above, below = _first_above(height, part, levels), -_first_above(-height, part, [-own[::-1] for own in levels])
    near = np.where(above - height <= height - below, above, below)
    key = (part[:, None] * (int(faces.max(initial=0)) + 1) + faces).ravel()
    vertices, corner = np.unique(key, return_inverse=True)
    corner = corner.reshape(height.shape)
    # The reach of a vertex is that of the steepest side there which crosses its level.
    reach = np.zeros(len(vertices))
    for turn in (1, -1):
        other = np.roll(height, turn, axis=1)
        crosses = (height - near) * (other - near) < 0.0
        np.maximum.at(reach, corner[crosses], SNAP * np.abs(other - height)[crosses])
    exact = _is_level(height, part, levels)
    return np.where(~exact & (np.abs(near - height) < reach[corner]), near, height)


def _first_above(height: FloatArray, part: IntArray, levels: Sequence[FloatArray]) -> FloatArray:
    """Return the lowest level above each height (m, 3), infinite where there is none."""
    found = np.full(height.shape, np.inf)
    for number, own in enumerate(levels):
        inside = part == number
        found[inside] = np.append(own, np.inf)[np.searchsorted(own, height[inside], side="right")]
    return found


def _is_level(height: FloatArray, part: IntArray, levels: Sequence[FloatArray]) -> Mask:
    """Tell which heights (m, 3) are exactly those of levels."""
    found = np.zeros(height.shape, bool)
    for number, own in enumerate(levels):
        inside = part == number
        found[inside] = np.isin(height[inside], own)
    return found
