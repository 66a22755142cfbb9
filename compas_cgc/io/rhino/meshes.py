"""Rhino meshes: conversion to and from arrays in double precision, and joining to one clean triangle mesh."""

from __future__ import annotations

from collections import deque
from itertools import chain
from operator import attrgetter
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing import face_regions
from ...meshing.cleanup import tidy
from ...model.counts import counted
from ...model.lengths import length_text
from ._types import Geometry
from ._types import Mesh
from .archive import Item
from .archive import rhino3dm_module
from .precision import rounding_of
from .sketch import Part
from .user_text import user_law

__all__ = ["JoinedMesh", "coloured", "has_mesh", "join_meshes", "mesh_from_arrays", "mesh_to_arrays", "to_part"]


class JoinedMesh(NamedTuple):
    """Triangle mesh joined from the meshes of a file."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    owner: IntArray  # (m,) index of the object of each face
    rounding: float  # rounding error of single-precision coordinates [L], 0 in double precision
    indices: list[IntArray]  # vertex of the joined mesh for every vertex of each object, -1 if removed
    notes: list[str]


def has_mesh(item: Item) -> bool:
    """Check whether an object is a mesh or holds a render mesh."""
    return item.kind == "mesh" or _render_arrays(item.geometry) is not None


def to_part(item: Item) -> tuple[Part, list[str]]:
    """Return the mesh of an object, or the render mesh of a Brep or an extrusion, with notes.

    Raises
    ------
    FileError
        If the object has no mesh; the message names the Rhino command that creates one.
    """
    arrays = mesh_to_arrays(item.geometry) if item.kind == "mesh" else _render_arrays(item.geometry)
    if arrays is None:
        raise FileError(f"{item.label} is not a mesh; run Rhino's command Mesh on it, and put the mesh on the layer instead")
    V, F = arrays
    notes = []
    if item.kind != "mesh":
        notes.append(f"{item.label} is not a mesh; its render mesh was used; give an edge length (--edge-length) for an even mesh")
    if not len(F):
        raise FileError(f"{item.label} has no faces; delete it or mesh it again")
    if not np.isfinite(V).all():
        bad = int(np.flatnonzero(~np.isfinite(V).all(axis=1))[0])
        raise FileError(f"{item.label}: vertex {bad} has a coordinate that is not finite; repair it (Rhino: Check, MeshRepair)")
    if F.min() < 0 or F.max() >= len(V):
        raise FileError(f"{item.label} has faces with vertices that do not exist; repair it (Rhino: Check, MeshRepair)")
    rounding = rounding_of(V, item.kind == "mesh" and item.geometry.Vertices.UseDoublePrecisionVertices)
    return Part(item.label, V, F, rounding, user_law({**item.layer_text, **item.text}), item.text), notes


def mesh_to_arrays(mesh: Mesh) -> tuple[FloatArray, IntArray]:
    """Return the vertices (n, 3) [L] and faces (m, 4) of a Rhino mesh; a triangle repeats its last corner."""
    points = mesh.Vertices.ToPoint3dArray()
    vertices = np.column_stack([np.fromiter(map(attrgetter(axis), points), np.float64, len(points)) for axis in "XYZ"])
    faces = np.fromiter(chain.from_iterable(mesh.Faces), np.int64, 4 * len(mesh.Faces)).reshape(-1, 4)
    return vertices, faces


def mesh_from_arrays(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a Rhino mesh with the coordinates in double precision.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    """
    rhino3dm = rhino3dm_module()

    mesh = rhino3dm.Mesh()
    _feed(mesh.Vertices.AddPoint3d, np.asarray(vertices, dtype=np.float64))
    _feed(mesh.Faces.AddFace, np.asarray(faces, dtype=np.int64))
    mesh.Normals.ComputeNormals()
    return mesh


def coloured(mesh: Mesh, colours: IntArray) -> Mesh:
    """Return a copy of a Rhino mesh with vertex colours (n, 3), RGB in 0..255."""
    copy = mesh.Duplicate()
    copy.VertexColors.Clear()
    _feed(copy.VertexColors.Add, np.asarray(colours, dtype=np.int64))
    return copy


def _feed(add: Callable[[float, float, float], object], rows: np.ndarray) -> None:
    # By columns, as one list per row would slow down the garbage collector.
    deque(map(add, *rows.T.tolist()), maxlen=0)


def _render_arrays(geometry: Geometry) -> Optional[tuple[FloatArray, IntArray]]:
    """Return the arrays of the render mesh of a Brep or an extrusion, None if there is none."""
    rhino3dm = rhino3dm_module()

    parts = []
    if isinstance(geometry, rhino3dm.Extrusion):
        parts = [geometry.GetMesh(rhino3dm.MeshType.Any)]
    elif isinstance(geometry, rhino3dm.Brep):
        parts = [geometry.Faces[i].GetMesh(rhino3dm.MeshType.Any) for i in range(len(geometry.Faces))]
    if not parts or any(part is None or not len(part.Faces) for part in parts):
        return None
    return _joined_arrays([mesh_to_arrays(part) for part in parts])


def _joined_arrays(meshes: list[tuple[FloatArray, IntArray]]) -> tuple[FloatArray, IntArray]:
    """Return the concatenation of several meshes of vertices (n, 3) and faces (m, c)."""
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    return vertices, np.concatenate([faces + offset for (_, faces), offset in zip(meshes, offsets)])


def join_meshes(parts: list[Part], tolerance: float, unit: str) -> JoinedMesh:
    """Join, weld, triangulate and orient meshes.

    Parameters
    ----------
    parts
        The meshes.
    tolerance
        Distance below which vertices coincide [L], see :func:`compas_cgc.meshing.cleanup.tidy`.
    unit
        Unit appended to lengths in the notes.

    Raises
    ------
    FileError
        If they do not form a usable mesh.
    """
    V, F = _joined_arrays([(part.vertices, part.faces) for part in parts])
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
    text = f"{single[0].label} has only seven digits (rounding error up to {rounding:.2g}{unit})"
    if len(single) > 1:
        text += f", as have {len(single) - 1} more"
    if away > 10.0 * size:
        text += f"; this is coarse so far from the origin ({away:.3g}{unit} for a size of {size:.3g}{unit}): mesh it near the origin"
    return text


def _shape_notes(V: FloatArray, F: IntArray, unit: str) -> list[str]:
    """Return notes on the size of a mesh and the direction of its normals."""
    low, high = V.min(axis=0), V.max(axis=0)
    size = " x ".join(length_text(x, float(np.linalg.norm(high - low))) for x in (high - low).tolist())
    pieces = int(face_regions(F, np.empty((0, 2), np.int64)).max()) + 1
    notes = [f"the mesh has {len(V)} vertices and {len(F)} triangles in {counted(pieces, 'piece')}, {size}{unit}"]
    area = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    if area[:, 2].sum() < -0.1 * np.linalg.norm(area, axis=1).sum():
        notes.append(
            "the normals point down, so a surface of positive K sags below a flat drawing; flip the mesh (Rhino: Flip) to make it rise"
        )
    return notes
