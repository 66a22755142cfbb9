"""Rhino meshes to arrays and back, in double precision."""

from __future__ import annotations

from collections import deque
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING
from typing import Callable
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from .archive import Item
from .precision import rounding_of
from .sketch import Part
from .user_text import user_target

if TYPE_CHECKING:
    import rhino3dm

__all__ = ["coloured", "joined_arrays", "mesh_from_arrays", "mesh_to_arrays", "to_part"]


def to_part(item: Item) -> tuple[Part, list[str]]:
    """Return the mesh of an object with notes: its own, or the one that Rhino draws a Brep or an extrusion by.

    Raises
    ------
    FileError
        If it has none; the sentence says how to make one.
    """
    arrays = mesh_to_arrays(item.geometry) if item.kind == "mesh" else _render_arrays(item.geometry)
    if arrays is None:
        mend = "run Rhino's command Mesh on it" if item.kind != "SubD" else "run Rhino's command ToNURBS or Mesh on it"
        raise FileError(f"{item.label} is no mesh; {mend}, and put the mesh on the layer instead")
    V, F = arrays
    notes = []
    if item.kind != "mesh":
        notes.append(f"{item.label} is no mesh; the one that Rhino draws it by was taken, mesh it yourself for even triangles")
    if not len(F):
        raise FileError(f"{item.label} has no faces; delete it or mesh it again")
    if not np.isfinite(V).all():
        bad = int(np.flatnonzero(~np.isfinite(V).all(axis=1))[0])
        raise FileError(f"{item.label}: vertex {bad} has a coordinate that is no finite number; mesh it again (Rhino: Check, MeshRepair)")
    if F.min() < 0 or F.max() >= len(V):
        raise FileError(f"{item.label} has faces with vertices that do not exist; mesh it again (Rhino: Check, MeshRepair)")
    rounding = rounding_of(V, item.kind == "mesh" and item.geometry.Vertices.UseDoublePrecisionVertices)
    return Part(item.label, V, F, rounding, user_target({**item.layer_text, **item.text}), item.text), notes


def mesh_to_arrays(mesh: rhino3dm.Mesh) -> tuple[FloatArray, IntArray]:
    """Return the vertices (n, 3) [L] and faces (m, 4) of a Rhino mesh; a triangle repeats its last corner."""
    points = mesh.Vertices.ToPoint3dArray()
    vertices = np.column_stack([np.fromiter(map(attrgetter(axis), points), np.float64, len(points)) for axis in "XYZ"])
    faces = np.fromiter(chain.from_iterable(mesh.Faces), np.int64, 4 * len(mesh.Faces)).reshape(-1, 4)
    return vertices, faces


def mesh_from_arrays(vertices: FloatArray, faces: IntArray) -> rhino3dm.Mesh:
    """Return a Rhino mesh with every bit of the coordinates.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    """
    import rhino3dm

    mesh = rhino3dm.Mesh()
    _feed(mesh.Vertices.AddPoint3d, np.asarray(vertices, dtype=np.float64))
    _feed(mesh.Faces.AddFace, np.asarray(faces, dtype=np.int64))
    mesh.Normals.ComputeNormals()
    return mesh


def coloured(mesh: rhino3dm.Mesh, colours: IntArray) -> rhino3dm.Mesh:
    """Return a copy of a Rhino mesh with colours of its vertices (n, 3), red, green and blue in 0..255."""
    copy = mesh.Duplicate()
    copy.VertexColors.Clear()
    _feed(copy.VertexColors.Add, np.asarray(colours, dtype=np.int64))
    return copy


def _feed(add: Callable[[float, float, float], object], rows: np.ndarray) -> None:
    # By columns: a list for every row would keep the garbage collector busy.
    deque(map(add, *rows.T.tolist()), maxlen=0)


def _render_arrays(geometry: rhino3dm.GeometryBase) -> Optional[tuple[FloatArray, IntArray]]:
    """Return the arrays of the mesh that Rhino saved with a Brep or an extrusion to draw it by, None if there is none."""
    import rhino3dm

    parts = []
    if isinstance(geometry, rhino3dm.Extrusion):
        parts = [geometry.GetMesh(rhino3dm.MeshType.Any)]
    elif isinstance(geometry, rhino3dm.Brep):
        parts = [geometry.Faces[i].GetMesh(rhino3dm.MeshType.Any) for i in range(len(geometry.Faces))]
    if not parts or any(part is None or not len(part.Faces) for part in parts):
        return None
    return joined_arrays([mesh_to_arrays(part) for part in parts])


def joined_arrays(meshes: list[tuple[FloatArray, IntArray]]) -> tuple[FloatArray, IntArray]:
    """Return one mesh of several, with the vertices (n, 3) and faces (m, c) of each in turn."""
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    return vertices, np.concatenate([faces + offset for (_, faces), offset in zip(meshes, offsets)])
