"""Points and curves to the vertices that stay."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing.polyline import points_along
from .sketch import Drawn

__all__ = ["find_supports"]


def find_supports(drawn: list[Drawn], vertices: FloatArray, tolerance: float, unit: str) -> tuple[IntArray, list[str], list[str]]:
    """Find the vertices that points, point clouds and curves hold.

    Parameters
    ----------
    drawn
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
    for item in drawn:
        if item.kind == "curve":
            found = points_along(vertices, item.points, tolerance).tolist() if len(item.points) > 1 else []
            if not found:
                problems.append(
                    f"support {item.label} runs through no vertex of the mesh; draw it along vertices, or put points on the vertices"
                )
            chosen += found
            continue
        if not len(item.points) or not np.isfinite(item.points).all():
            problems.append(f"support {item.label} has no finite place; delete it")
            continue
        distance, nearest = tree.query(item.points)
        far = np.flatnonzero(distance > tolerance)
        if len(far):
            worst = float(distance[far].max())
            which = f"{len(far)} points of support {item.label} are" if len(item.points) > 1 else f"support {item.label} is"
            problems.append(
                f"{which} up to {worst:.4g}{unit} away from the nearest vertex of the mesh; "
                f"snap to a vertex (within the tolerance of {tolerance:.2g}{unit})"
            )
        chosen += nearest[distance <= tolerance].tolist()
    supports = np.unique(np.array(chosen, dtype=np.int64))
    notes = [f"{len(supports)} vertices are supports"] if len(supports) else []
    if not drawn:
        notes.append("there is no support: put points at vertices on the layer CGC::Supports, or fix the whole boundary")
    return supports, notes, problems
