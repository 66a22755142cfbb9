"""Surfaces of least area over supports, as drawings of minimal surfaces."""

from __future__ import annotations

import numpy as np

from ...discrete import face_areas
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Mask
from ...discrete.arrays import Vertices
from ...discrete.laplacian import cotangent_laplacian
from ...linalg import factorise

__all__ = ["least_area"]

MAX_STEPS = 100  # steps to less area [steps]; bounds the time, as the film is an initial guess
DECREASE = 1e-4  # relative decrease of the area below which the steps end; the film is an initial guess only


def least_area(vertices: Vertices, faces: Faces, free: Mask) -> FloatArray:
    """Return the vertices (n, 3) of a surface of nearly least area; each step minimises the Dirichlet energy over the surface before.

    Parameters
    ----------
    vertices
        ``(n, 3)`` drawing [L].
    faces
        ``(m, 3)`` vertex indices.
    free
        ``(n,)`` vertices that move.

    References
    ----------
    Pinkall and Polthier, doi:10.1080/10586458.1993.10504266.
    """
    here, area = vertices, float(face_areas(vertices, faces).sum())
    for _ in range(MAX_STEPS):
        stiffness = -cotangent_laplacian(here, faces)[free]
        there = here.copy()
        there[free] = factorise(stiffness[:, free].tocsr(), symmetric=True).solve(-(stiffness[:, ~free] @ here[~free]))
        before, area = area, float(face_areas(there, faces).sum())
        if not area < before:
            break
        here = there
        if area > (1.0 - DECREASE) * before:
            break
    return np.asarray(here)
