"""Where a shape is flat: K does not change with a small move there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...discrete import face_normals
from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["flat_share"]

FLAT = 0.01  # fold relative to that of the target, below which a place is flat; half and twice it give the same surfaces


def _flat_vertices(vertices: FloatArray, faces: IntArray, wanted: FloatArray) -> NDArray[np.bool_]:
    """Mark the vertices that are flat for the curvature ``K̄_i A_i`` (n,) wanted of them."""
    normals, mean = face_normals(vertices, faces), vertex_normals(vertices, faces)
    corner = faces.ravel()
    fold = np.zeros(len(vertices))
    np.maximum.at(fold, corner, np.linalg.norm(np.repeat(normals, 3, axis=0) - mean[corner], axis=1))
    return fold < FLAT * np.sqrt(np.abs(wanted))


def flat_share(vertices: FloatArray, faces: IntArray, wanted: FloatArray) -> float:
    """Return the part of the curvature ``K̄_i A_i`` (n,) wanted that is wanted of flat vertices."""
    total = float(np.abs(wanted).sum())
    return float(np.abs(wanted[_flat_vertices(vertices, faces, wanted)]).sum()) / total if total > 0.0 else 0.0
