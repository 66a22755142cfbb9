"""Curvature and energy of a shape, in one compiled call."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from . import _kernels
from . import edge_faces
from .arrays import Edges
from .arrays import Faces
from .arrays import Mask
from .arrays import PerFace
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices

__all__ = ["Measure", "Measurement"]

STEINER, COTANGENT = 0, 1


@njit(cache=True)
def measure(
    V: Vertices, F: Faces, E: Edges, weight: PerFace, clamp: Vectors, inside: Mask, kind: int
) -> tuple[PerVertex, PerVertex, Vectors, float]:
    """Return K of Eq. 10 (n,), A (n,), unit normals of Eq. 13 (n, 3) and the energy Φ of a shape, Eq. 2 with its sign turned."""
    n, m = V.shape[0], F.shape[0]
    angle, area = _kernels.angle_sums_and_areas(V, F, _kernels.MIXED)
    C = np.empty((m + clamp.shape[0], 3))
    C[:m] = _kernels.cross_vectors(V, F)
    C[m:] = clamp
    N = _kernels.sum_at_vertices(n, F, C)
    K = np.zeros(n)
    for i in range(n):
        if area[i] > 0.0:
            K[i] = (2.0 * math.pi - angle[i]) / area[i]
        length = math.sqrt(N[i, 0] ** 2 + N[i, 1] ** 2 + N[i, 2] ** 2)
        if length > 0.0:
            for x in range(3):
                N[i, x] /= length
    if kind == STEINER:
        total = _kernels.total_fold(V, C, E)
    else:
        L = _kernels.mean_curvature_vectors(V, F)
        total = 0.0
        for i in range(n):
            if inside[i]:
                square, inward = 0.0, 0.0
                for x in range(3):
                    square += L[i, x] ** 2
                    inward -= L[i, x] * N[i, x]
                total += 0.5 * math.copysign(math.sqrt(square), inward)
    return K, area, N, total - _kernels.pyramids(V, F, weight)


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
        self.clamp = np.ascontiguousarray(crosses[self.edges[rim, 2]])
        self.inside = np.ones(len(vertices), bool)
        self.inside[self.edges[rim, :2].ravel()] = False
        self.edges[rim, 3] = len(faces) + np.arange(len(rim))
        self.kind = STEINER if energy == "steiner" else COTANGENT

    def __call__(self, vertices: Vertices) -> Measurement:
        """Return the measurement of a shape with vertices (n, 3)."""
        return Measurement(*measure(vertices, self.faces, self.edges, self.weight, self.clamp, self.inside, self.kind))
