"""Energy of the Gaussian curvature flow, and its gradient."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from . import _kernels
from .arrays import PerFace
from .arrays import Vectors
from .arrays import mesh_arrays
from .mean import total_mean_curvature
from .topology import edge_faces

__all__ = ["energy", "energy_gradient"]


def face_targets(targets: ArrayLike, m: int) -> PerFace:
    """Return the targets as one number per face (m,)."""
    K = np.asarray(targets, dtype=np.float64)
    if K.ndim and K.shape != (m,):
        raise ValueError(f"targets must be one number or one per face ({m}), not of shape {K.shape}")
    return np.ascontiguousarray(np.broadcast_to(K, (m,)))


@names_what_was_meant()
def energy(vertices: ArrayLike, faces: ArrayLike, targets: ArrayLike, kind: str = "steiner") -> float:
    r"""Return :math:`\Phi = M - \sum_f \bar K_f V_f`, which the flow of Eq. 22 decreases.

    ``M`` is the total mean curvature, positive on convex surfaces, and ``V_f`` the
    pyramid from the origin to the face f, weighted by the target of the face's region.
    This is the paper's energy of Eq. 2 with its sign turned: by the paper's own Eq. 8
    the flow *increases* that one.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    targets
        Target Gaussian curvature [1/L^2], one number or ``(m,)`` per face. With
        different targets the value depends on the origin.
    kind
        How ``M`` is measured, see :func:`total_mean_curvature`.

    Returns
    -------
    float
        Energy [L].

    References
    ----------
    Paper, Eq. 2 and Eq. 8.

    Examples
    --------
    >>> tetrahedron = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> round(energy(tetrahedron, faces, np.ones(4)), 6)
    6.82732
    """
    V, F = mesh_arrays(vertices, faces)
    weight = face_targets(targets, len(F))
    return total_mean_curvature(V, F, kind) - float(_kernels.pyramids(V, F, weight))


@names_what_was_meant()
def energy_gradient(vertices: ArrayLike, faces: ArrayLike, targets: ArrayLike) -> Vectors:
    r"""Return the exact gradient of the Steiner :func:`energy`.

    Inside the mesh :math:`\tfrac12 \sum_j \theta_{ij} (p_i - p_j) / l_{ij}` by Schlaefli's
    formula, less the targets times the gradients of the pyramids. Near an open boundary
    the terms that Schlaefli's formula needs a closed surface for are made up for, so it
    is exact at every vertex.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    targets
        Target Gaussian curvature [1/L^2], one number or ``(m,)`` per face.

    Returns
    -------
    (n, 3) float64
        Dimensionless; close to ``(K - K̄) A n`` on a smooth mesh (Eq. 8).

    Examples
    --------
    >>> tetrahedron = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> energy_gradient(tetrahedron, faces, np.ones(4)).shape
    (4, 3)
    """
    V, F = mesh_arrays(vertices, faces)
    weight = face_targets(targets, len(F))
    gradient = _kernels.fold_gradient(V, F, _kernels.cross_vectors(V, F), edge_faces(F))
    _kernels.add_pyramid_gradient(V, F, weight, gradient)
    return gradient
