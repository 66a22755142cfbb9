"""The energy Φ of shapes of one mesh."""

from __future__ import annotations

from typing import Callable

from ..discrete import _kernels
from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..problem import CGCProblem

__all__ = ["EnergyMeter"]


class EnergyMeter:
    """Measures the energy Φ = M - ΣK̄ V; the edges of the mesh are found once."""

    def __init__(self, problem: CGCProblem):
        self._edges = edge_faces(problem.faces)

    def of(self, problem: CGCProblem) -> Callable[[FloatArray], float]:
        """Return the energy as a function of the vertices (n, 3), for the targets of a problem."""
        faces, weight = problem.faces, problem.face_targets()

        def energy(vertices: FloatArray) -> float:
            crosses = _kernels.cross_vectors(vertices, faces)
            return _kernels.total_fold(vertices, crosses, self._edges) - _kernels.pyramids(vertices, faces, weight)

        return energy
