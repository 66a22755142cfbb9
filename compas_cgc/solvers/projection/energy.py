"""The energy Φ of shapes of one mesh."""

from __future__ import annotations

from typing import Callable

from ...discrete import _kernels
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.problem import CGCProblem

__all__ = ["energy_meter"]


def energy_meter(problem: CGCProblem, edges: IntArray) -> Callable[[FloatArray], float]:
    """Return the Steiner energy Φ as a function of the vertices (n, 3).

    As :func:`compas_cgc.discrete.energy`, with the edges (e, 4) found beforehand.
    """
    faces, weight = problem.faces, problem.face_targets()

    def energy(vertices: FloatArray) -> float:
        crosses = _kernels.cross_vectors(vertices, faces)
        return float(_kernels.total_fold(vertices, crosses, edges) - _kernels.pyramids(vertices, faces, weight))

    return energy
