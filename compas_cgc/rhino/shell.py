"""The meshes of a file to one clean, consistently oriented triangle mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import FileError
from ..errors import MeshError
from ..meshing import face_regions
from ..meshing.tidy import tidy
from .meshes import joined_arrays
from .meshes import mesh_to_arrays
from .meshes import render_arrays
from .objects import Item

__all__ = ["Shell", "read_shell", "shape_notes"]


class Shell(NamedTuple):
    """One triangle mesh of the meshes of a file."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    owner: IntArray  # (m,) number of the object that each face came from
    rounding: float  # error that single precision has left in the coordinates [L], 0 in double precision
    notes: list[str]


def read_shell(items: list[Item], tolerance: float, unit: str) -> Shell:
    """Join, weld, triangulate and orient meshes.

    Parameters
    ----------
    items
        Meshes; Breps and extrusions with render meshes.
    tolerance
        Distance within which vertices are one [L], see :func:`compas_cgc.meshing.tidy.tidy`.
    unit
        What lengths are followed by in the notes.

    Raises
    ------
    FileError
        If there is no usable mesh; it names the object and the mend.
    """
    if not items:
        raise FileError("there is no mesh in the file; make one with Rhino's command Mesh or QuadRemesh, and save the file again")
    notes: list[str] = []
    parts = [_arrays(item, notes) for item in items]
    V, F = joined_arrays(parts)
    single = [item for item in items if item.kind != "mesh" or not item.geometry.Vertices.UseDoublePrecisionVertices]
    rounding = float(np.abs(V).max()) * 2.0**-24 if single else 0.0
    if single:
        notes.append(_precision_note(single, V, rounding, unit))
    try:
        clean = tidy(V, F, max(tolerance, 4.0 * rounding), unit)
    except MeshError as error:
        raise FileError(f"{items[0].label}: {error}") from None
    owner = np.repeat(np.arange(len(parts)), [len(faces) for _, faces in parts])[clean.owner]
    notes += clean.notes + shape_notes(clean.vertices, clean.faces, unit)
    return Shell(clean.vertices, clean.faces, owner, rounding, notes)


def _arrays(item: Item, notes: list[str]) -> tuple[FloatArray, IntArray]:
    arrays = mesh_to_arrays(item.geometry) if item.kind == "mesh" else render_arrays(item.geometry)
    if arrays is None:
        mend = "run Rhino's command Mesh on it" if item.kind != "SubD" else "run Rhino's command ToNURBS or Mesh on it"
        raise FileError(f"{item.label} is no mesh; {mend}, and put the mesh on the layer instead")
    V, F = arrays
    if item.kind != "mesh":
        notes.append(f"{item.label} is no mesh; the one that Rhino draws it by was taken, mesh it yourself for even triangles")
    if not len(F):
        raise FileError(f"{item.label} has no faces; delete it or mesh it again")
    if not np.isfinite(V).all():
        bad = int(np.flatnonzero(~np.isfinite(V).all(axis=1))[0])
        raise FileError(f"{item.label}: vertex {bad} has a coordinate that is no finite number; mesh it again (Rhino: Check, MeshRepair)")
    if F.min() < 0 or F.max() >= len(V):
        raise FileError(f"{item.label} has faces with vertices that do not exist; mesh it again (Rhino: Check, MeshRepair)")
    return V, F


def _precision_note(single: list[Item], V: FloatArray, rounding: float, unit: str) -> str:
    size, away = float(np.linalg.norm(np.ptp(V, axis=0))), float(np.abs(V).max())
    text = f"{single[0].label} carries seven digits only (rounded by up to {rounding:.2g}{unit})"
    if len(single) > 1:
        text += f", so do {len(single) - 1} more"
    if away > 10.0 * size:
        text += f"; that is coarse so far from the origin ({away:.3g}{unit} for a size of {size:.3g}): mesh it near the origin"
    return text


def shape_notes(V: FloatArray, F: IntArray, unit: str) -> list[str]:
    """Return sentences on the size of a mesh and on where its normals point."""
    low, high = V.min(axis=0), V.max(axis=0)
    size = " x ".join(f"{x:.4g}" for x in high - low)
    pieces = int(face_regions(F, np.empty((0, 2), np.int64)).max()) + 1
    notes = [f"the mesh has {len(V)} vertices and {len(F)} triangles in {pieces} piece{'s' if pieces > 1 else ''}, {size}{unit}"]
    area = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    if area[:, 2].sum() < -0.1 * np.linalg.norm(area, axis=1).sum():
        notes.append("the normals point down, so a surface of positive K bulges downwards; flip the mesh (Rhino: Flip) if it shall rise")
    return notes
