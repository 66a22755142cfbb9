"""Scene object for Grasshopper; importable only inside Grasshopper."""

from __future__ import annotations

from collections.abc import Iterable

from compas_ghpython.scene import MeshObject

from ..datastructures import CGCMesh
from ..io.rhino.rhinocommon import mesh_from_arrays
from ..io.rhino.rhinocommon import points_to_rhino
from ..io.rhino.rhinocommon import polyline_to_rhino
from .appearance import appearance
from .appearance import real_mesh
from .figures import coloured

__all__ = ["CGCMeshObject"]


class CGCMeshObject(MeshObject):
    """Scene object: a CGC mesh in double precision, points at its supports and polylines along its creases.

    Parameters
    ----------
    item
        The mesh; a dummy mesh is not drawn.
    show_figure
        Quantity shown by the colours: K, H, k_max, k_min or error.
    """

    def __init__(self, item: CGCMesh, show_figure: str = "K", **options: object):
        real = real_mesh(item)
        super().__init__(item=real, **{**appearance(real, show_figure), **options})
        self.show_figure = show_figure

    def draw(self) -> list:
        """Return the Rhino geometry."""
        vertices, faces = self.mesh.arrays()
        mesh = mesh_from_arrays(vertices, faces, coloured(self.mesh, self.show_figure).colours)
        creases = [polyline_to_rhino(self._points(path)) for path in self.mesh.creases()]
        self._guids = [mesh, *points_to_rhino(self._points(self.mesh.supports())), *creases]
        return self._guids

    def _points(self, keys: Iterable[int]) -> list:
        return [self.mesh.vertex_coordinates(key) for key in keys]
