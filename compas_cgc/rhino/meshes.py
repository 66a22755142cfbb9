"""Rhino meshes to arrays and back, in double precision."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

if TYPE_CHECKING:
    import rhino3dm

__all__ = ["joined_arrays", "mesh_from_arrays", "mesh_to_arrays", "render_arrays"]


def mesh_to_arrays(mesh: rhino3dm.Mesh) -> tuple[FloatArray, IntArray]:
    """Return the vertices (n, 3) [L] and faces (m, 4) of a Rhino mesh; a triangle repeats its last corner."""
    vertices = np.array([(p.X, p.Y, p.Z) for p in mesh.Vertices.ToPoint3dArray()], dtype=np.float64)
    faces = np.array(list(mesh.Faces), dtype=np.int64)
    return vertices.reshape(-1, 3), faces.reshape(-1, 4)


def mesh_from_arrays(vertices: FloatArray, faces: IntArray, colours: Optional[IntArray] = None) -> rhino3dm.Mesh:
    """Return a Rhino mesh with every bit of the coordinates.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    colours
        ``(n, 3)`` red, green and blue of the vertices, 0..255.
    """
    import rhino3dm

    mesh = rhino3dm.Mesh()
    add = mesh.Vertices.AddPoint3d
    for x, y, z in np.asarray(vertices, dtype=np.float64).tolist():
        add(x, y, z)
    add = mesh.Faces.AddFace
    for a, b, c in np.asarray(faces, dtype=np.int64).tolist():
        add(a, b, c)
    if colours is not None:
        add = mesh.VertexColors.Add
        for red, green, blue in np.asarray(colours, dtype=np.int64).tolist():
            add(red, green, blue)
    mesh.Normals.ComputeNormals()
    return mesh


def render_arrays(geometry: rhino3dm.GeometryBase) -> Optional[tuple[FloatArray, IntArray]]:
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
