"""Points and curves to the vertices that stay."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing.polyline import points_along
from .curves import curve_points
from .objects import Item

__all__ = ["item_points", "read_supports"]


def item_points(item: Item) -> FloatArray:
    """Return the location of a point, or those of a point cloud (k, 3) [L]."""
    if item.kind == "point":
        points = [item.geometry.Location]
    else:
        points = item.geometry.GetPoints()
    return np.array([(p.X, p.Y, p.Z) for p in points], dtype=np.float64).reshape(-1, 3)


def read_supports(items: list[Item], vertices: FloatArray, tolerance: float, unit: str) -> tuple[IntArray, list[str], list[str]]:
    """Find the vertices that points, point clouds and curves hold.

    Parameters
    ----------
    items
        Points, point clouds and curves.
    vertices
        ``(n, 3)`` coordinates [L].
    tolerance
        Largest distance from a vertex [L].
    unit
        What lengths are followed by in sentences.

    Returns
    -------
    vertices (k,), notes, problems
    """
    tree = cKDTree(vertices)
    chosen: list[int] = []
    problems = []
    for item in items:
        if item.kind == "curve":
            points = curve_points(item.geometry, tolerance)
            found = points_along(vertices, points, tolerance).tolist() if len(points) > 1 else []
            if not found:
                problems.append(
                    f"support {item.label} runs through no vertex of the mesh; draw it along vertices, or put points on the vertices"
                )
            chosen += found
            continue
        points = item_points(item)
        if not len(points) or not np.isfinite(points).all():
            problems.append(f"support {item.label} has no finite place; delete it")
            continue
        distance, nearest = tree.query(points)
        far = np.flatnonzero(distance > tolerance)
        if len(far):
            worst = int(far[np.argmax(distance[far])])
            which = f"{len(far)} points of support {item.label} are" if len(points) > 1 else f"support {item.label} is"
            problems.append(
                f"{which} up to {distance[worst]:.4g}{unit} away from the nearest vertex of the mesh; "
                f"snap to a vertex (within the tolerance of {tolerance:.2g}{unit})"
            )
        chosen += nearest[distance <= tolerance].tolist()
    supports = np.unique(np.array(chosen, dtype=np.int64))
    notes = [f"{len(supports)} vertices are supports"] if len(supports) else []
    if not items:
        notes.append("the file has no support: put points at vertices on the layer CGC::Supports, or fix the whole boundary")
    return supports, notes, problems
