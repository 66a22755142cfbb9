"""Curvatures of polynomials fitted around vertices: consistent on any mesh, which angle defects are not."""

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
    truncation: FloatArray  # (n,) K by angle defects of the ring put onto the polynomial, less that of the polynomial [1/L^2]
    residual: FloatArray  # (n,) distance of the rings from the polynomial, root mean square by degrees of freedom [L]
    sagitta: FloatArray  # (n,) of the quadratic part of the polynomial over the rings, root mean square [L]
    radius: FloatArray  # (n,) distance of the farthest vertex of the rings [L]
    bending: FloatArray  # (n, 6) second fundamental form in space: xx, yy, zz, and yz, zx, xy times the root of two [1/L]


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
    refinement (Borrelli, Cazals, Morvan 2003); the fits' curvatures converge, and tell that term.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, anticlockwise seen from outside.
    wanted
        ``(n,)`` bool: where to fit, vertices with a closed ring of faces only. Default: all of these.
    through
        ``(n,)`` bool: vertices that the farther rings may be reached through, so that no fit looks across a
        crease. Default: all.
    degree
        Of the polynomials, 2 to 4; lowered where the rings have too few vertices.
    rings
        How many.
    pinned
        Let the polynomials go through their vertices. Else a vertex is but one of the points, and moving it alone changes
        little.
    layout
        Tell the truncation, which is a quarter of the work; else it is NaN.

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
    where = closed if wanted is None else closed & np.asarray(wanted, dtype=bool)
    open_to = np.ones(n, bool) if through is None else np.ascontiguousarray(through, dtype=bool)
    return as_local_fits(_local_fits.fitted(V, vertex_normals(V, F), F, open_to, where, degree, rings, pinned, layout))


def as_local_fits(told: FloatArray) -> LocalFits:
    """Return the columns of what fits tell (n, 12) by their names."""
    gaussian, mean, truncation, residual, sagitta, radius = told[:, :6].T
    return LocalFits(gaussian, mean, truncation, residual, sagitta, radius, told[:, 6:])
