"""Scene object for Rhino; importable only inside Rhino."""

from __future__ import annotations

from compas_rhino.scene import RhinoMeshObject

from ..datastructures import CGCMesh
from ..io.rhino.rhinocommon import mesh_from_arrays
from .appearance import appearance
from .appearance import real_mesh
from .figures import coloured

__all__ = ["CGCMeshObject"]


class CGCMeshObject(RhinoMeshObject):
    """Scene object: a CGC mesh in double precision, with points at its supports and lines along its creases.

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
        """Draw the mesh and return the GUIDs of the objects."""
        import scriptcontext

        self._guids = []
        vertices, faces = self.mesh.arrays()
        mesh = mesh_from_arrays(vertices, faces, coloured(self.mesh, self.show_figure).colours)
        self._guids.append(scriptcontext.doc.Objects.AddMesh(mesh, self.compile_attributes(name=self.name)))
        for draw in (self.draw_vertices, self.draw_edges):
            self._guids += [guid for guid in draw() or [] if guid not in self._guids]
        return self._guids
