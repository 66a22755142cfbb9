"""The meshes of a file to one clean, consistently oriented triangle mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing import face_regions
from ...meshing.cleanup import tidy
from .meshes import joined_arrays
from .sketch import Part

__all__ = ["JoinedMesh", "join_meshes"]


class JoinedMesh(NamedTuple):
    """One triangle mesh of the meshes of a file."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    owner: IntArray  # (m,) number of the object that each face came from
    rounding: float  # error that single precision has left in the coordinates [L], 0 in double precision
    indices: list[IntArray]  # vertex of the joined mesh for every vertex of each object, -1 where it is gone
    notes: list[str]


def join_meshes(parts: list[Part], tolerance: float, unit: str) -> JoinedMesh:
    """Join, weld, triangulate and orient meshes.

    Parameters
    ----------
    parts
        The meshes.
    tolerance
        Distance within which vertices are one [L], see :func:`compas_cgc.meshing.cleanup.tidy`.
    unit
        What lengths are followed by in the notes.

    Raises
    ------
    FileError
        If no usable mesh comes of them.
    """
    V, F = joined_arrays([(part.vertices, part.faces) for part in parts])
    rounding = max(part.rounding for part in parts)
    notes = [_precision_note(parts, V, rounding, unit)] if rounding else []
    try:
        clean = tidy(V, F, max(tolerance, 4.0 * rounding), unit)
    except MeshError as error:
        raise FileError(f"{parts[0].label}: {error}") from None
    owner = np.repeat(np.arange(len(parts)), [len(part.faces) for part in parts])[clean.owner]
    notes += clean.notes + _shape_notes(clean.vertices, clean.faces, unit)
    indices = np.split(clean.index, np.cumsum([len(part.vertices) for part in parts])[:-1])
    return JoinedMesh(clean.vertices, clean.faces, owner, rounding, indices, notes)


def _precision_note(parts: list[Part], V: FloatArray, rounding: float, unit: str) -> str:
    single = [part for part in parts if part.rounding]
    size, away = float(np.linalg.norm(np.ptp(V, axis=0))), float(np.abs(V).max())
    text = f"{single[0].label} carries seven digits only (rounded by up to {rounding:.2g}{unit})"
    if len(single) > 1:
        text += f", so do {len(single) - 1} more"
    if away > 10.0 * size:
        text += f"; that is coarse so far from the origin ({away:.3g}{unit} for a size of {size:.3g}): mesh it near the origin"
    return text


def _shape_notes(V: FloatArray, F: IntArray, unit: str) -> list[str]:
    """Return sentences on the size of a mesh and on where its normals point."""
    low, high = V.min(axis=0), V.max(axis=0)
    size = " x ".join(f"{x:.4g}" for x in high - low)
    pieces = int(face_regions(F, np.empty((0, 2), np.int64)).max()) + 1
    notes = [f"the mesh has {len(V)} vertices and {len(F)} triangles in {pieces} piece{'s' if pieces > 1 else ''}, {size}{unit}"]
    area = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    if area[:, 2].sum() < -0.1 * np.linalg.norm(area, axis=1).sum():
        notes.append("the normals point down, so a surface of positive K bulges downwards; flip the mesh (Rhino: Flip) if it shall rise")
    return notes
