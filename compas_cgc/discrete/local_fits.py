"""Curvatures of polynomials fitted around vertices: unlike angle defects, they are consistent on any mesh."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from . import _local_fits
from .arrays import FloatArray
from .arrays import mesh_arrays
from .normals import vertex_normals
from .topology import closed_vertices

__all__ = ["LocalFits", "as_local_fits", "local_fits"]


class LocalFits(NamedTuple):
    """Curvatures of fitted polynomials, NaN where no fit was made."""

    gaussian: FloatArray  # (n,) [1/L^2]
    mean: FloatArray  # (n,) positive where convex towards the normal [1/L]
    truncation: FloatArray  # (n,) angle defect over area of the ring projected onto the polynomial, minus K of the polynomial [1/L^2]
    residual: FloatArray  # (n,) RMS distance of the rings from the polynomial, per degree of freedom [L]
    sagitta: FloatArray  # (n,) RMS of the quadratic part of the polynomial over the rings [L]
    radius: FloatArray  # (n,) distance of the farthest vertex of the rings [L]
    bending: FloatArray  # (n, 6) second fundamental form in space: xx, yy, zz, and sqrt(2) times yz, zx, xy [1/L]


def local_fits(
    vertices: ArrayLike,
    faces: ArrayLike,
    wanted: Optional[ArrayLike] = None,
    through: Optional[ArrayLike] = None,
    degree: int = 3,
    rings: int = 2,
    pinned: bool = True,
    layout: bool = True,
) -> LocalFits:
    """Fit polynomials to the rings around vertices, as heights over their tangent planes.

    Angle defect over area differs from K by a term that depends on the layout of the ring and does not vanish under
    refinement (Borrelli, Cazals, Morvan 2003); the curvatures of the fits converge, and so that term can be computed from them.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    wanted
        ``(n,)`` bool: vertices to fit at; with `layout`, those without a closed ring of faces are skipped. Default: all with one.
    through
        ``(n,)`` bool: vertices through which the farther rings are reached; exclude those of a crease, so that no
        fit extends across it. Default: all.
    degree
        Degree of the polynomials, 2 to 4; lowered where the rings have too few vertices.
    rings
        Number of rings.
    pinned
        Whether each polynomial passes through its vertex. Otherwise the vertex is one of the fitted points, and moving it
        alone changes little.
    layout
        Whether to compute the truncation, a quarter of the work; otherwise it is NaN.

    Returns
    -------
    LocalFits

    References
    ----------
    Cazals and Pouget, doi:10.1016/j.cagd.2004.09.004. Borrelli, Cazals, Morvan, doi:10.1016/S0167-8396(03)00077-3.
    """
    V, F = mesh_arrays(vertices, faces)
    n = len(V)
    closed = closed_vertices(V, F)
    where = closed if wanted is None else np.asarray(wanted, dtype=bool) & (closed | (not layout))
    open_to = np.ones(n, bool) if through is None else np.ascontiguousarray(through, dtype=bool)
    return as_local_fits(_local_fits.fitted(V, vertex_normals(V, F), F, open_to, where, degree, rings, pinned, layout))


def as_local_fits(columns: FloatArray) -> LocalFits:
    """Return columns (n, 12) as named fields."""
    gaussian, mean, truncation, residual, sagitta, radius = columns[:, :6].T
    return LocalFits(gaussian, mean, truncation, residual, sagitta, radius, columns[:, 6:])
