"""Curvature and energy of a shape."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from . import _kernels
from .arrays import Faces
from .arrays import PerFace
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices
from .normals import unit_vectors
from .topology import edge_faces

__all__ = ["Measure", "Measurement"]


class Measurement(NamedTuple):
    """A shape as the flow sees it."""

    curvature: PerVertex  # (n,) K of Eq. 10, meaningless on an open boundary [1/L^2]
    area: PerVertex  # (n,) A_i [L^2]
    normal: Vectors  # (n, 3) n_i of Eq. 13
    energy: float  # Φ [L]


class Measure:
    """Measures shapes of one mesh; what does not change is built once.

    The outer boundary is clamped: its faces fold against the planes that they lay in at
    the start. Without that the Steiner energy would miss the folds along a rim, and
    its gradient would be wrong on the vertices next to it.

    Parameters
    ----------
    vertices
        ``(n, 3)`` shape at the start [L].
    faces
        ``(m, 3)`` vertex indices.
    face_targets
        ``(m,)`` K̄ of every face, the weight of its part of the volume [1/L^2].
    energy
        ``"steiner"`` or ``"cotangent"`` (Eq. 15).
    """

    def __init__(self, vertices: Vertices, faces: Faces, face_targets: PerFace, energy: str = "steiner"):
        self.faces = faces
        self.weight = face_targets
        self.edges = edge_faces(faces)
        rim = np.flatnonzero(self.edges[:, 3] < 0)
        crosses = _kernels.cross_vectors(vertices, faces)
        self.crosses = np.concatenate([crosses, crosses[self.edges[rim, 2]]])
        self.inside = np.ones(len(vertices), bool)
        self.inside[self.edges[rim, :2].ravel()] = False
        self.edges[rim, 3] = len(faces) + np.arange(len(rim))
        self.energy = energy

    def __call__(self, vertices: Vertices) -> Measurement:
        """Return the measurement of a shape with vertices (n, 3)."""
        angle, area = _kernels.angle_sums_and_areas(vertices, self.faces, _kernels.MIXED)
        _kernels.write_cross_vectors(vertices, self.faces, self.crosses)
        normal = unit_vectors(_kernels.sum_at_vertices(len(vertices), self.faces, self.crosses))
        curvature = np.divide(2.0 * math.pi - angle, area, out=np.zeros_like(area), where=area > 0.0)
        energy = self._total_mean_curvature(vertices, normal) - _kernels.pyramids(vertices, self.faces, self.weight)
        return Measurement(curvature, area, normal, energy)

    def _total_mean_curvature(self, vertices: Vertices, normal: Vectors) -> float:
        if self.energy == "steiner":
            return float(_kernels.total_fold(vertices, self.crosses, self.edges))
        vectors = _kernels.mean_curvature_vectors(vertices, self.faces)[self.inside]
        inward = -np.einsum("ij,ij->i", vectors, normal[self.inside])
        return float(0.5 * np.copysign(np.linalg.norm(vectors, axis=1), inward).sum())
