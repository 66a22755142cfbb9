"""NURBS surfaces of Rhino."""

from __future__ import annotations

from ...discrete.nurbs import NurbsPatch
from ._types import Geometry
from .archive import rhino3dm_module

__all__ = ["nurbs_surface"]


def nurbs_surface(patch: NurbsPatch) -> Geometry:
    """Return a surface as a Rhino NURBS surface."""
    rhino3dm = rhino3dm_module()

    a, b, _ = patch.control.shape
    rational = bool((patch.control[..., 3] != 1.0).any())
    surface = rhino3dm.NurbsSurface.Create(3, rational, patch.degrees[0] + 1, patch.degrees[1] + 1, a, b)
    for i in range(a):
        for j in range(b):
            surface.Points[i, j] = rhino3dm.Point4d(*patch.control[i, j].tolist())
    # Rhino omits the first and the last knot, which do not affect the surface.
    for knots, values in ((surface.KnotsU, patch.knots[0][1:-1]), (surface.KnotsV, patch.knots[1][1:-1])):
        for k, value in enumerate(values.tolist()):
            knots[k] = value
    return surface
