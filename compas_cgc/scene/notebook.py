"""Scene object for compas_notebook; importable only if it is installed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pythreejs
from compas_notebook.scene import ThreeMeshObject

from ..datastructures import CGCMesh
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from .appearance import CREASE
from .appearance import SUPPORT
from .appearance import real_mesh
from .figures import coloured

__all__ = ["CGCMeshObject"]

OUTLINE = (0.25, 0.25, 0.25)
LIGHT = np.array([-0.48, -0.36, 0.8])


class CGCMeshObject(ThreeMeshObject):
    """Scene object: a coloured CGC mesh with points at its supports and lines along its creases and open edges.

    Parameters
    ----------
    item
        The mesh; a dummy mesh is not drawn.
    show_figure
        Quantity shown by the colours: K, H, k_max, k_min or error.
    """

    def __init__(self, item: CGCMesh, show_figure: str = "K", **options: object):
        super().__init__(item=real_mesh(item), **options)
        self.show_figure = show_figure

    def draw(self) -> list:
        """Return the three.js objects: surface, supports, creases and open edges."""
        mesh = self.mesh
        vertices, faces = mesh.arrays()
        colours = coloured(mesh, self.show_figure).colours / 255.0
        # The scenes of compas_notebook have no lights, so the shading is included in the colours.
        lit = colours[faces] * (0.62 + 0.38 * np.abs(face_normals(vertices, faces) @ LIGHT))[:, None, None]
        material = pythreejs.MeshBasicMaterial(side="DoubleSide", vertexColors="VertexColors")
        surface = pythreejs.Mesh(_geometry(vertices[faces].reshape(-1, 3), lit.reshape(-1, 3)), material)
        loops = [(u, v) for loop in mesh.boundary_loops() for u, v in zip(loop, loop[1:] + loop[:1])]
        drawn = [surface, self._lines(mesh.crease_edges(), CREASE.rgb), self._lines(loops, OUTLINE), self._points(mesh.supports())]
        self._guids = [own for own in drawn if own is not None]
        return self._guids

    def _lines(self, edges: Sequence[tuple[int, int]], colour: Sequence[float]) -> object:
        if not edges:
            return None
        ends = np.array([self.mesh.vertex_coordinates(key) for edge in edges for key in edge])
        return pythreejs.LineSegments(
            _geometry(ends, np.tile(colour, (len(ends), 1))), pythreejs.LineBasicMaterial(vertexColors="VertexColors")
        )

    def _points(self, keys: Sequence[int]) -> object:
        if not keys:
            return None
        places = np.array([self.mesh.vertex_coordinates(key) for key in keys])
        # Sized in pixels, independent of the size of the model.
        material = pythreejs.PointsMaterial(size=7.0, sizeAttenuation=False, vertexColors="VertexColors")
        return pythreejs.Points(_geometry(places, np.tile(SUPPORT.rgb, (len(places), 1))), material)


def _geometry(places: FloatArray, colours: FloatArray) -> object:
    attributes = {"position": places, "color": colours}
    return pythreejs.BufferGeometry(
        attributes={name: pythreejs.BufferAttribute(own.astype(np.float32), normalized=False) for name, own in attributes.items()}
    )
