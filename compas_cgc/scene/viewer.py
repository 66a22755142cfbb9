"""Scene object for compas_viewer; importable only if it is installed."""

from __future__ import annotations

from compas_viewer.scene import MeshObject

from ..datastructures import CGCMesh
from .appearance import CREASE
from .appearance import SUPPORT
from .appearance import appearance
from .appearance import real_mesh

__all__ = ["CGCMeshObject"]


class CGCMeshObject(MeshObject):
    """Scene object: a CGC mesh with points at its supports and lines along its creases and open edges.

    Parameters
    ----------
    item
        The mesh; a dummy mesh is not drawn.
    show_figure
        Quantity shown by the colours: K, H, k_max, k_min or error.
    """

    def __init__(self, item: CGCMesh, show_figure: str = "K", **options: object):
        real = real_mesh(item)
        own = {
            "vertexcolor": appearance(real, show_figure)["vertexcolor"],
            "use_vertexcolors": True,
            "show_points": True,
            "pointsize": 10.0,
        }
        # The scene of the viewer passes None for all options that were not given.
        super().__init__(item=real, **{**own, **{name: value for name, value in options.items() if value is not None}})

    def _read_points_data(self) -> tuple[list, list, list]:
        points = [self.mesh.vertex_coordinates(key) for key in self.mesh.supports()]
        return points, [SUPPORT] * len(points), [[i] for i in range(len(points))]

    def _read_lines_data(self) -> tuple[list, list, list]:
        loops = [(u, v) for loop in self.mesh.boundary_loops() for u, v in zip(loop, loop[1:] + loop[:1])]
        edges = [*self.mesh.crease_edges(), *loops]
        points = [self.mesh.vertex_coordinates(key) for edge in edges for key in edge]
        return points, [CREASE] * len(points), [[i, i + 1] for i in range(0, len(points), 2)]
