"""What a file of any format holds: polygons, with what is asked of them where the format can say it."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field
from typing import TYPE_CHECKING
from typing import Optional

from ..discrete.arrays import FloatArray

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["MeshFile"]


@dataclass(frozen=True)
class MeshFile:
    """A mesh read from a file.

    Parameters
    ----------
    vertices
        ``(n, 3)`` float64 coordinates [L].
    faces
        Vertex indices of every polygon.
    supports
        Fixed vertices, where the file names some.
    creases
        Vertex paths along edges.
    targets
        Target of every vertex [1/L^2], None where there is none.
    notes
        Sentences on what was done.
    """

    vertices: FloatArray
    faces: list[list[int]]
    supports: list[int] = field(default_factory=list)
    creases: list[list[int]] = field(default_factory=list)
    targets: Optional[list[Optional[float]]] = None
    notes: tuple[str, ...] = ()

    def to_cgcmesh(self, name: str) -> CGCMesh:
        """Return the mesh with its roles and targets; quads and n-gons are triangulated."""
        from ..datastructures import CGCMesh

        mesh = CGCMesh.from_vertices_and_faces(self.vertices, self.faces)
        mesh.name = name
        mesh.set_creases(self.creases)
        if self.supports:
            mesh.set_supports(self.supports)
        for v, K in enumerate(self.targets or []):
            if K is not None:
                mesh.vertex[v]["target"] = K
        return mesh
