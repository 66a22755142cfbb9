"""A design divided into panels: a mesh on the design whose edges follow the seams."""

from __future__ import annotations

from typing import NamedTuple

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask

__all__ = ["Panelling"]


class Panelling(NamedTuple):
    """A mesh on a design, divided into panels."""

    vertices: FloatArray  # (n, 3) on the design [L]
    faces: IntArray  # (m, 3)
    panels: IntArray  # (m,) panel of every face
    parameters: FloatArray  # (n, 2) of the vertices on the surface
    held: Mask  # (n, 2) parameters that are constant along the rim a vertex is on

    @property
    def panel_count(self) -> int:
        """Number of panels."""
        return int(self.panels.max(initial=-1)) + 1

    @property
    def seams(self) -> Edges:
        """Edges (s, 2) between two panels."""
        edges = edge_faces(self.faces)
        inner = edges[edges[:, 3] >= 0]
        return inner[self.panels[inner[:, 2]] != self.panels[inner[:, 3]]][:, :2]
