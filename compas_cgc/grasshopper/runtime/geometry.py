"""Geometry of the canvas: what :mod:`compas_cgc.io.rhino.rhinocommon` does not have."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...discrete.arrays import FloatArray
from ...io.rhino.rhinocommon import points_to_array

__all__ = ["document_units", "plane_arrays", "points_to_rhino", "polyline_to_rhino"]


def document_units() -> tuple[float, str]:
    """Return the absolute tolerance [L] and the unit system of the open Rhino document."""
    import Rhino

    document = Rhino.RhinoDoc.ActiveDoc
    return (1e-3, "Meters") if document is None else (float(document.ModelAbsoluteTolerance), str(document.ModelUnitSystem))


def plane_arrays(plane: Any) -> tuple[FloatArray, FloatArray]:
    """Return the origin (3,) [L] and the unit normal (3,) of a plane."""
    return points_to_array([plane.Origin])[0], points_to_array([plane.ZAxis])[0]


def points_to_rhino(points: FloatArray) -> list:
    """Return points (k, 3) [L] as a list of ``Rhino.Geometry.Point3d``."""
    import Rhino

    return [Rhino.Geometry.Point3d(x, y, z) for x, y, z in np.asarray(points, dtype=np.float64).tolist()]


def polyline_to_rhino(points: FloatArray) -> Any:
    """Return a polyline through points (k, 3) [L] as a ``Rhino.Geometry.PolylineCurve``."""
    import Rhino

    return Rhino.Geometry.PolylineCurve(points_to_rhino(points))
