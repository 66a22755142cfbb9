"""Objects of an archive to arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import FileError
from .curves import curve_points
from .meshes import mesh_to_arrays
from .meshes import render_arrays
from .objects import Item
from .sketch import Drawn
from .sketch import Part
from .texts import dot_target
from .texts import user_target

if TYPE_CHECKING:
    import rhino3dm

__all__ = ["looks_single", "to_drawn", "to_part"]


def to_part(item: Item) -> tuple[Part, list[str]]:
    """Return the mesh of an object with notes: its own, or the one that Rhino draws a Brep or an extrusion by.

    Raises
    ------
    FileError
        If it has none; the sentence says how to make one.
    """
    arrays = mesh_to_arrays(item.geometry) if item.kind == "mesh" else render_arrays(item.geometry)
    if arrays is None:
        mend = "run Rhino's command Mesh on it" if item.kind != "SubD" else "run Rhino's command ToNURBS or Mesh on it"
        raise FileError(f"{item.label} is no mesh; {mend}, and put the mesh on the layer instead")
    V, F = arrays
    notes = []
    if item.kind != "mesh":
        notes.append(f"{item.label} is no mesh; the one that Rhino draws it by was taken, mesh it yourself for even triangles")
    if not len(F):
        raise FileError(f"{item.label} has no faces; delete it or mesh it again")
    if not np.isfinite(V).all():
        bad = int(np.flatnonzero(~np.isfinite(V).all(axis=1))[0])
        raise FileError(f"{item.label}: vertex {bad} has a coordinate that is no finite number; mesh it again (Rhino: Check, MeshRepair)")
    if F.min() < 0 or F.max() >= len(V):
        raise FileError(f"{item.label} has faces with vertices that do not exist; mesh it again (Rhino: Check, MeshRepair)")
    double = item.kind == "mesh" and item.geometry.Vertices.UseDoublePrecisionVertices and not looks_single(V)
    rounding = 0.0 if double else float(np.abs(V).max()) * 2.0**-24
    return Part(item.label, V, F, rounding, user_target({**item.layer_text, **item.text}), item.text), notes


def looks_single(vertices: FloatArray) -> bool:
    """Tell whether doubles (n, 3) are rounded singles: none has more digits, and some are no short decimals by design."""
    with np.errstate(over="ignore"):
        single = vertices.astype(np.float32)
    return bool((vertices == single).all() and (vertices != np.round(vertices, 6)).any())


def to_drawn(item: Item, tolerance: float) -> Drawn:
    """Return the points of a point, point cloud, curve or text dot; a curve is kept to within the tolerance [L]."""
    target = user_target(item.text)
    if item.kind == "curve":
        points = curve_points(item.geometry, tolerance)
    elif item.kind == "point cloud":
        points = _array(item.geometry.GetPoints())
    elif item.kind == "text dot":
        points = _array([item.geometry.Point])
        target = dot_target(item.geometry.Text) if target is None else target
    else:
        points = _array([item.geometry.Location])
    return Drawn(item.label, item.kind, points, target, item.text)


def _array(points: list[rhino3dm.Point3d]) -> FloatArray:
    return np.array([(p.X, p.Y, p.Z) for p in points], dtype=np.float64).reshape(-1, 3)
