"""The smooth measure of K: angle defect over area, less what the layout of the mesh puts into it."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Mask
from .local_fits import LocalFits
from .local_fits import local_fits

__all__ = ["is_irregular", "layout_errors"]

DEGREE, RINGS = 4, 3  # of the polynomials
REGULAR = 0.9  # part of the vertices with six neighbours from which a mesh is regular
WAVY = 0.2, 0.4  # distance of the rings from a fit, against its bending, up to which it is believed, and not at all
SINGULAR = 3.0, 6.0  # squares of the curvatures, against the median, likewise
SEEN = 0.03  # error of the layout, against the largest K̄, whose wrinkles show


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
    return _believed(local_fits(vertices, faces, asked, asked, DEGREE, RINGS, pinned=False))


def is_irregular(vertices: FloatArray, faces: IntArray, asked: Mask, targets: FloatArray) -> bool:
    """Return whether a surface that meets its targets (n,) by angle defects would show the layout of its mesh as wrinkles."""
    if not asked.any() or np.mean(np.bincount(faces.ravel(), minlength=len(vertices))[asked] == 6) >= REGULAR:
        return False
    largest = float(np.abs(targets[asked]).max())
    return bool(np.median(np.abs(layout_errors(vertices, faces, asked)[asked])) > SEEN * largest > 0.0)


def _believed(fits: LocalFits) -> FloatArray:
    """Return the errors that fits tell, as far as these are to be believed: where vertices lie on them.

    K > 0 over a straight edge has curvatures without bounds, which no polynomial follows.
    """
    bent = fits.mean**2 + np.abs(fits.gaussian)
    if not np.isfinite(bent).any():
        return np.zeros(len(bent))
    with np.errstate(invalid="ignore", divide="ignore"):
        close = _falling(fits.residual / fits.sagitta, *WAVY)
        bounded = _falling(bent / np.median(bent[np.isfinite(bent)]), *SINGULAR)
    told = close * bounded * fits.truncation
    return np.where(np.isfinite(told), told, 0.0)


def _falling(values: FloatArray, full: float, none: float) -> FloatArray:
    return np.clip((none - values) / (none - full), 0.0, 1.0)
