"""Document units and planes of Rhino."""

from __future__ import annotations

from typing import Any

from ...discrete.arrays import FloatArray
from ...io.rhino.rhinocommon import points_to_array

__all__ = ["document_units", "plane_arrays"]


def document_units() -> tuple[float, str]:
    """Return the absolute tolerance [L] and the unit system of the open Rhino document."""
    import Rhino

    document = Rhino.RhinoDoc.ActiveDoc
    return (1e-3, "Meters") if document is None else (float(document.ModelAbsoluteTolerance), str(document.ModelUnitSystem))


def plane_arrays(plane: Any) -> tuple[FloatArray, FloatArray]:
    """Return the origin (3,) [L] and the unit normal (3,) of a plane."""
    return points_to_array([plane.Origin])[0], points_to_array([plane.ZAxis])[0]
