"""Rhino meshes and polylines as JSON for Hops and the Rhino.Compute clients."""

from __future__ import annotations

import json
from typing import Optional

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...io.rhino.colours import signed_colours
from ...io.rhino.meshes import coloured
from ...io.rhino.meshes import mesh_from_arrays

__all__ = ["mesh_text", "polyline_text"]


def mesh_text(vertices: FloatArray, faces: IntArray, values: Optional[FloatArray] = None, limit: float = 1.0) -> str:
    """Return a mesh as JSON text.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    values
        ``(n,)`` numbers that colour the vertices, from -limit (blue) to limit (red), grey for NaN.
    limit
        Largest value of the colour scale.
    """
    mesh = mesh_from_arrays(vertices, faces)
    if values is not None:
        mesh = coloured(mesh, signed_colours(values, limit))
    return json.dumps(mesh.Encode())


def polyline_text(points: FloatArray) -> str:
    """Return a polyline (k, 3) [L] as JSON text."""
    import rhino3dm

    return json.dumps(rhino3dm.PolylineCurve([rhino3dm.Point3d(*point) for point in points.tolist()]).Encode())
