"""The smooth measure of K: angle defect over area, less what the layout of the mesh puts into it."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ._fit_derivatives import fitted_with_slopes
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Mask
from .local_fits import LocalFits
from .local_fits import as_local_fits
from .local_fits import local_fits
from .normals import vertex_normals
from .topology import closed_vertices

__all__ = ["is_irregular", "is_regular", "layout_errors", "layout_errors_and_slopes"]

DEGREE, RINGS = 4, 3  # of the polynomials
REGULAR = 0.9  # part of the vertices with six neighbours from which a mesh is regular
WAVY = 0.2, 0.4  # distance of the rings from a fit, against its bending, up to which it is believed, and not at all
SINGULAR = 3.0, 6.0  # squares of the curvatures, against the median, likewise
FAINT = 0.1  # principal curvature, against the other, that is none
SEEN = 0.03  # error of the layout, against the largest K̄, whose wrinkles show, the median
SLIGHT = 0.01  # the mean, for K̄ > 0: on spheres most vertices have none, and some have much


def layout_errors(vertices: FloatArray, faces: IntArray, asked: Mask) -> FloatArray:
    """Return what the layout of a mesh puts into angle defect over area (n,) [1/L^2], zero where no fit tells it.

    It does not vanish under refinement (Borrelli, Cazals, Morvan 2003); polynomials fitted around vertices tell it.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``.
    asked
        ``(n,)`` where K is asked for; fits do not look across other vertices.

    References
    ----------
    Borrelli, Cazals, Morvan, doi:10.1016/S0167-8396(03)00077-3. Stetter, doi:10.1007/BF01432879.
    """
    return _believed(_fits(vertices, faces, asked), faces, asked)


def layout_errors_and_slopes(vertices: FloatArray, faces: IntArray, asked: Mask) -> tuple[FloatArray, sparse.csr_matrix]:
    """Return the errors of :func:`layout_errors` (n,) and their derivatives by the coordinates (n, 3n) [1/L^3].

    How far fits are believed is taken as it is.
    """
    closed = asked & closed_vertices(vertices, faces)
    told, slopes = fitted_with_slopes(vertices, vertex_normals(vertices, faces), faces, asked, closed, DEGREE, RINGS)
    fits = as_local_fits(told)
    belief = _belief(fits, faces, asked)
    return _times(belief, fits), (sparse.diags(belief) @ slopes).tocsr()


def is_irregular(vertices: FloatArray, faces: IntArray, asked: Mask, targets: FloatArray) -> bool:
    """Return whether a surface that meets its targets (n,) by angle defects would show the layout of its mesh as wrinkles."""
    if not asked.any() or is_regular(faces, asked):
        return False
    fits = _fits(vertices, faces, asked)
    least = float(np.abs(targets[asked]).max())
    if least == 0.0:
        # A developable is held against one with a principal curvature of a part of its other.
        bent = fits.mean[np.isfinite(fits.mean)]
        least = FAINT * float(np.median(4.0 * bent**2)) if len(bent) else 0.0
    told = np.abs(_believed(fits, faces, asked)[asked])
    slight = bool((targets[asked] > 0.0).all()) and told.mean() > SLIGHT * least
    return bool(slight or np.median(told) > SEEN * least > 0.0)


def is_regular(faces: IntArray, asked: Mask) -> bool:
    """Return whether nearly all vertices where K is asked for have six neighbours."""
    return bool(np.mean(np.bincount(faces.ravel(), minlength=len(asked))[asked] == 6) >= REGULAR)


def _fits(vertices: FloatArray, faces: IntArray, asked: Mask) -> LocalFits:
    return local_fits(vertices, faces, asked, asked, DEGREE, RINGS, pinned=False)


def _believed(fits: LocalFits, faces: IntArray, asked: Mask) -> FloatArray:
    """Return the errors that fits tell, as far as these are to be believed."""
    return _times(_belief(fits, faces, asked), fits)


def _times(belief: FloatArray, fits: LocalFits) -> FloatArray:
    return belief * np.where(np.isfinite(fits.truncation), fits.truncation, 0.0)


def _belief(fits: LocalFits, faces: IntArray, asked: Mask) -> FloatArray:
    """Return how far the errors that fits tell are to be believed (n,): where vertices lie on them.

    K > 0 over a straight edge has curvatures without bounds, which no polynomial follows.
    """
    bent = fits.mean**2 + np.abs(fits.gaussian)
    if not np.isfinite(bent).any():
        return np.zeros(len(bent))
    with np.errstate(invalid="ignore", divide="ignore"):
        close = _falling(fits.residual / fits.sagitta, *WAVY)
        bounded = _falling(bent / np.median(bent[np.isfinite(bent)]), *SINGULAR)
    known = np.isfinite(close * bounded * fits.truncation)
    return np.where(known, _alike(np.where(known, close * bounded, 0.0), faces, asked), 0.0)


def _alike(belief: FloatArray, faces: IntArray, asked: Mask) -> FloatArray:
    """Return beliefs (n,) that fall off gently from vertex to vertex, nowhere before what they were.

    The layout moves curvature from a vertex to its neighbours and adds none (Gauss and Bonnet): what is believed of one and
    not of the others would add some.
    """
    least = _least(np.where(asked, belief, 1.0)[faces].min(axis=1), faces, len(belief))
    shared = _around(np.where(asked, least, 0.0), faces) / np.maximum(_around(asked.astype(np.float64), faces), 1.0)
    return np.where(asked, shared, 0.0)


def _around(values: FloatArray, faces: IntArray) -> FloatArray:
    """Return the sums of values (n,) over inner vertices and their neighbours (n,)."""
    n, at = len(values), faces.ravel()
    # The faces at a vertex have it once each, and each of its neighbours twice.
    sums = np.bincount(at, np.repeat(values[faces].sum(axis=1), 3), n)
    own = 1.0 - 0.5 * np.bincount(at, minlength=n)
    return np.asarray(own * values + 0.5 * sums, dtype=np.float64)


def _least(values: FloatArray, faces: IntArray, n: int) -> FloatArray:
    """Return the least of the values (m,) of the faces at each vertex (n,)."""
    least = np.ones(n)
    np.minimum.at(least, faces.ravel(), np.repeat(values, 3))
    return least


def _falling(values: FloatArray, full: float, none: float) -> FloatArray:
    return np.clip((none - values) / (none - full), 0.0, 1.0)
