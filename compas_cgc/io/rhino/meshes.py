"""Rhino meshes: to arrays and back in double precision, and those of a file joined to one clean triangle mesh."""

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
from ._types import Geometry
from ._types import Mesh
from .archive import Item
from .archive import rhino3dm_module
from .precision import rounding_of
from .sketch import Part
from .user_text import user_target

__all__ = ["JoinedMesh", "coloured", "has_mesh", "join_meshes", "mesh_from_arrays", "mesh_to_arrays", "to_part"]


class JoinedMesh(NamedTuple):
    """One triangle mesh of the meshes of a file."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    owner: IntArray  # (m,) number of the object that each face came from
    rounding: float  # error that single precision has left in the coordinates [L], 0 in double precision
    indices: list[IntArray]  # vertex of the joined mesh for every vertex of each object, -1 where it is gone
    notes: list[str]


def has_mesh(item: Item) -> bool:
    """Check whether an object is a mesh, or holds the one that Rhino draws it by."""
    return item.kind == "mesh" or _render_arrays(item.geometry) is not None


def to_part(item: Item) -> tuple[Part, list[str]]:
    """Return the mesh of an object with notes: its own, or the one that Rhino draws a Brep or an extrusion by.

    Raises
    ------
    FileError
        If it has none; the sentence says how to make one.
    """
    arrays = mesh_to_arrays(item.geometry) if item.kind == "mesh" else _render_arrays(item.geometry)
    if arrays is None:
        raise FileError(f"{item.label} is no mesh; run Rhino's command Mesh on it, and put the mesh on the layer instead")
    V, F = arrays
    notes = []
    if item.kind != "mesh":
        notes.append(f"{item.label} is no mesh; the one that Rhino draws it by was taken; an edge length (--edge-length) makes an even one")
    if not len(F):
        raise FileError(f"{item.label} has no faces; delete it or mesh it again")
    if not np.isfinite(V).all():
        bad = int(np.flatnonzero(~np.isfinite(V).all(axis=1))[0])
        raise FileError(f"{item.label}: vertex {bad} has a coordinate that is no finite number; mesh it again (Rhino: Check, MeshRepair)")
    if F.min() < 0 or F.max() >= len(V):
        raise FileError(f"{item.label} has faces with vertices that do not exist; mesh it again (Rhino: Check, MeshRepair)")
    rounding = rounding_of(V, item.kind == "mesh" and item.geometry.Vertices.UseDoublePrecisionVertices)
    return Part(item.label, V, F, rounding, user_target({**item.layer_text, **item.text}), item.text), notes


def mesh_to_arrays(mesh: Mesh) -> tuple[FloatArray, IntArray]:
    """Return the vertices (n, 3) [L] and faces (m, 4) of a Rhino mesh; a triangle repeats its last corner."""
    points = mesh.Vertices.ToPoint3dArray()
    vertices = np.column_stack([np.fromiter(map(attrgetter(axis), points), np.float64, len(points)) for axis in "XYZ"])
    faces = np.fromiter(chain.from_iterable(mesh.Faces), np.int64, 4 * len(mesh.Faces)).reshape(-1, 4)
    return vertices, faces


def mesh_from_arrays(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a Rhino mesh with every bit of the coordinates.

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
    """Return a copy of a Rhino mesh with colours of its vertices (n, 3), red, green and blue in 0..255."""
    copy = mesh.Duplicate()
    copy.VertexColors.Clear()
    _feed(copy.VertexColors.Add, np.asarray(colours, dtype=np.int64))
    return copy


def _feed(add: Callable[[float, float, float], object], rows: np.ndarray) -> None:
    # By columns: a list for every row would keep the garbage collector busy.
    deque(map(add, *rows.T.tolist()), maxlen=0)


def _render_arrays(geometry: Geometry) -> Optional[tuple[FloatArray, IntArray]]:
    """Return the arrays of the mesh that Rhino saved with a Brep or an extrusion to draw it by, None if there is none."""
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
    """Return one mesh of several, with the vertices (n, 3) and faces (m, c) of each in turn."""
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
        Distance within which vertices are one [L], see :func:`compas_cgc.meshing.cleanup.tidy`.
    unit
        What lengths are followed by in the notes.

    Raises
    ------
    FileError
        If no usable mesh comes of them.
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
        notes.append(
            "the normals point down, so a surface of positive K bulges down from a flat drawing; flip the mesh (Rhino: Flip) to let it rise"
        )
    return notes
