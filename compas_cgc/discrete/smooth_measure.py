"""The smooth measure of K: angle defect over area, minus the truncation error due to the layout of the mesh."""

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

DEGREE = 4  # degree of the polynomials; the lowest for which the layout error of second derivatives vanishes under refinement
RINGS = 3  # rings of a fit; 36 neighbours on regular meshes, for fourteen terms
REGULAR_PART = 0.9  # fraction of vertices with six neighbours from which a mesh is regular; meshes of `from_outline` have 0.91 to 0.94
RESIDUAL_RANGE = 0.2, 0.4  # residual over sagitta of a fit with full weight and with none; the limits of waviness of the verdict
CURVATURE_RANGE = 3.0, 6.0  # squared curvature relative to the median with full weight and with none; fits at outliers are not trusted
DEVELOPABLE_RATIO = 0.1  # ratio of the principal curvatures at which a surface counts as developable; TARGET_FLOOR of the verdict
# median layout error relative to the largest |K̄| above which wrinkles are visible; half of the error that the verdict admits
VISIBLE_MEDIAN = 0.03
VISIBLE_MEAN = 0.01  # the same for the mean, if K̄ > 0; on spheres the error is large at a few vertices only


def layout_errors(vertices: FloatArray, faces: IntArray, asked: Mask) -> FloatArray:
    """Return the truncation error (n,) of angle defect over area due to the layout of a mesh [1/L^2], zero where there is no fit.

    It does not vanish under refinement (Borrelli, Cazals, Morvan 2003). It is computed from polynomials fitted around vertices.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``.
    asked
        ``(n,)`` bool: vertices where K is prescribed; fits do not extend across other vertices.

    References
    ----------
    Borrelli, Cazals, Morvan, doi:10.1016/S0167-8396(03)00077-3. Stetter, doi:10.1007/BF01432879.
    """
    return _believed(_fits(vertices, faces, asked), faces, asked)


def layout_errors_and_slopes(vertices: FloatArray, faces: IntArray, asked: Mask) -> tuple[FloatArray, sparse.csr_matrix]:
    """Return the errors of :func:`layout_errors` (n,) and their derivatives by the coordinates (n, 3n) [1/L^3].

    The weights of the fits are held constant.
    """
    closed = asked & closed_vertices(vertices, faces)
    told, slopes = fitted_with_slopes(vertices, vertex_normals(vertices, faces), faces, asked, closed, DEGREE, RINGS)
    fits = as_local_fits(told)
    belief = _belief(fits, faces, asked)
    return _times(belief, fits), (sparse.diags(belief) @ slopes).tocsr()


def is_irregular(vertices: FloatArray, faces: IntArray, asked: Mask, targets: FloatArray) -> bool:
    """Check whether a surface whose angle defects match its targets (n,) would have visible wrinkles due to its mesh layout."""
    if not asked.any() or is_regular(faces, asked):
        return False
    fits = _fits(vertices, faces, asked)
    least = float(np.abs(targets[asked]).max())
    if least == 0.0:
        # For K̄ = 0 the scale is the K of a surface with a small ratio of principal curvatures.
        bent = fits.mean[np.isfinite(fits.mean)]
        least = DEVELOPABLE_RATIO * float(np.median(4.0 * bent**2)) if len(bent) else 0.0
    told = np.abs(_believed(fits, faces, asked)[asked])
    slight = bool((targets[asked] > 0.0).all()) and told.mean() > VISIBLE_MEAN * least
    return bool(slight or np.median(told) > VISIBLE_MEDIAN * least > 0.0)


def is_regular(faces: IntArray, asked: Mask) -> bool:
    """Check whether nearly all vertices where K is prescribed have six neighbours."""
    return bool(np.mean(np.bincount(faces.ravel(), minlength=len(asked))[asked] == 6) >= REGULAR_PART)


def _fits(vertices: FloatArray, faces: IntArray, asked: Mask) -> LocalFits:
    return local_fits(vertices, faces, asked, asked, DEGREE, RINGS, pinned=False)


def _believed(fits: LocalFits, faces: IntArray, asked: Mask) -> FloatArray:
    """Return the truncation errors of fits, times the weights of the fits."""
    return _times(_belief(fits, faces, asked), fits)


def _times(belief: FloatArray, fits: LocalFits) -> FloatArray:
    return belief * np.where(np.isfinite(fits.truncation), fits.truncation, 0.0)


def _belief(fits: LocalFits, faces: IntArray, asked: Mask) -> FloatArray:
    """Return the weights (n,) of fits, 0 to 1: high where the residual is small and the curvature bounded.

    K > 0 next to a straight edge has unbounded curvature, which no polynomial approximates.
    """
    bent = fits.mean**2 + np.abs(fits.gaussian)
    if not np.isfinite(bent).any():
        return np.zeros(len(bent))
    with np.errstate(invalid="ignore", divide="ignore"):
        close = _falling(fits.residual / fits.sagitta, *RESIDUAL_RANGE)
        bounded = _falling(bent / np.median(bent[np.isfinite(bent)]), *CURVATURE_RANGE)
    known = np.isfinite(close * bounded * fits.truncation)
    return np.where(known, _alike(np.where(known, close * bounded, 0.0), faces, asked), 0.0)


def _alike(belief: FloatArray, faces: IntArray, asked: Mask) -> FloatArray:
    """Return weights (n,) smoothed over the neighbours.

    The layout shifts curvature between neighbours and adds none in total (Gauss and Bonnet): correcting one vertex but not
    its neighbours would add some.
    """
    least = _least(np.where(asked, belief, 1.0)[faces].min(axis=1), faces, len(belief))
    shared = _around(np.where(asked, least, 0.0), faces) / np.maximum(_around(asked.astype(np.float64), faces), 1.0)
    return np.where(asked, shared, 0.0)


def _around(values: FloatArray, faces: IntArray) -> FloatArray:
    """Return the sums of values (n,) over inner vertices and their neighbours (n,)."""
    n, at = len(values), faces.ravel()
    # The faces at an inner vertex contain it once each, and each of its neighbours twice.
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
