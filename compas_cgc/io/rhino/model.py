"""What a .3dm file asks for, as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import ProblemError

if TYPE_CHECKING:
    from ...datastructures import CGCMesh

__all__ = ["Model3dm"]


@dataclass(frozen=True)
class Model3dm:
    """A surface problem read from a .3dm file.

    Parameters
    ----------
    name
        Name of the file without suffix.
    vertices
        ``(n, 3)`` float64 coordinates [L].
    faces
        ``(m, 3)`` int64 vertex indices, consistently oriented where that can be.
    supports
        ``(k,)`` int64 fixed vertices.
    creases
        Vertex paths along edges.
    targets
        ``(n,)`` float64 target Gaussian curvature [1/L^2], NaN where the file has none.
    s, e
        ``(n,)`` float64 factor and delay of the strategies S1 and S2, NaN where the file has none.
    constraints
        Constraints besides K as plain data, see :func:`compas_cgc.io.rhino.constraints_of`.
    units
        Name of the file's unit system, such as ``Millimeters``.
    tolerance
        Absolute tolerance of the file [L].
    notes
        Sentences on what was found and done.
    problems
        Sentences on what cannot be used as it is, each with object, layer and mend.
    """

    name: str
    vertices: FloatArray
    faces: IntArray
    supports: IntArray
    creases: tuple[list[int], ...]
    targets: FloatArray
    s: FloatArray
    e: FloatArray
    constraints: tuple[dict, ...]
    units: str
    tolerance: float
    notes: tuple[str, ...]
    problems: tuple[str, ...]

    def to_cgcmesh(self) -> CGCMesh:
        """Return the mesh with its roles, targets, units and tolerance.

        Raises
        ------
        ProblemError
            With the sentences of ``problems``, if there are any.
        """
        from ...datastructures import CGCMesh

        if self.problems:
            raise ProblemError(list(self.problems))
        mesh = CGCMesh.from_vertices_and_faces(self.vertices, self.faces)
        mesh.name = self.name
        mesh.attributes.update(units=self.units, tolerance=self.tolerance)
        if self.constraints:
            mesh.attributes["constraints"] = [dict(item) for item in self.constraints]
        mesh.set_creases(self.creases)
        mesh.set_supports(self.supports.tolist())
        for name, kind in (("targets", float), ("s", float), ("e", int)):
            values = getattr(self, name)
            for v in np.flatnonzero(np.isfinite(values)).tolist():
                mesh.vertex[v]["target" if name == "targets" else name] = kind(values[v])
        return mesh
