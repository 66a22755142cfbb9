"""Snapping of drawn points and curves to the vertices of supports and constraints."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing import Diagnostic
from ...meshing.cleanup import mean_edge
from ...meshing.polyline import points_along
from ...model.constraints import Constraint
from ...model.constraints import Fixed
from ...model.constraints import Height
from ...model.constraints import OnCurve
from .sketch import Drawn

__all__ = ["as_drawn", "find_constraints", "find_supports", "snap_distance"]


def snap_distance(vertices: FloatArray, faces: IntArray, tolerance: float, rounding: float = 0.0) -> float:
    """Return the distance within which a drawn point snaps to a vertex [L].

    It covers rounding by single precision and by transformations.
    """
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    return min(max(tolerance, 4.0 * rounding, 1e-9 * size), 0.1 * mean_edge(vertices, faces))


def find_supports(drawn: list[Drawn], vertices: FloatArray, tolerance: float, unit: str) -> tuple[IntArray, list[str], list[Diagnostic]]:
    """Return the vertices supported by points, point clouds and curves.

    Parameters
    ----------
    drawn
        Points, point clouds and curves.
    vertices
        ``(n, 3)`` coordinates [L].
    tolerance
        Largest distance from a vertex [L].
    unit
        Unit appended to lengths in messages.

    Returns
    -------
    vertices (k,), notes, diagnostics
    """
    tree = cKDTree(vertices)
    chosen: list[int] = []
    diagnostics: list[str] = []
    for item in drawn:
        if item.kind == "curve":
            found = _along(item, vertices, tolerance)
            if not found:
                diagnostics.append(
                    f"support {item.label} does not pass through a vertex of the mesh; draw it along vertices, or put points on them"
                )
            chosen += found
            continue
        if not _has_place(item):
            diagnostics.append(f"support {item.label} has no finite coordinates; delete it")
            continue
        distance, nearest = tree.query(item.points)
        far = np.flatnonzero(distance > tolerance)
        if len(far):
            worst = float(distance[far].max())
            which = f"{len(far)} points of support {item.label} are" if len(item.points) > 1 else f"support {item.label} is"
            diagnostics.append(
                f"{which} up to {worst:.4g}{unit} away from the nearest vertex of the mesh; "
                f"snap to a vertex (within the tolerance of {tolerance:.2g}{unit})"
            )
        chosen += nearest[distance <= tolerance].tolist()
    supports = np.unique(np.array(chosen, dtype=np.int64))
    notes = [f"{len(supports)} vertices are supports"] if len(supports) else []
    if not drawn:
        notes.append("there are no supports: draw points (in a .3dm on the layer CGC::Supports), or fix the whole boundary")
    return supports, notes, [Diagnostic(text) for text in diagnostics]


def find_constraints(drawn: list[Drawn], vertices: FloatArray, tolerance: float, unit: str) -> tuple[list[Constraint], list[Diagnostic]]:
    """Return the constraints of vertices in drawn curves and points.

    Vertices along a curve are constrained to it. The vertex below or above a point (along z) is
    constrained to its height. With user text ``keep``, the vertices along the curve or below the
    point remain fixed.

    Parameters
    ----------
    drawn
        Curves, points and point clouds.
    vertices
        ``(n, 3)`` coordinates [L].
    tolerance
        Largest distance of vertices from a curve, and in plan from a point [L].
    unit
        Unit appended to lengths in messages.
    """
    found: list[Constraint] = []
    diagnostics = []
    for item in drawn:
        try:
            found += _on_curve(item, vertices, tolerance) if item.kind == "curve" else _at_points(item, vertices, tolerance, unit)
        except ValueError as error:
            diagnostics.append(Diagnostic(f"constraint {item.label} {error}"))
    return found, diagnostics


def as_drawn(constraint: Constraint, vertices: FloatArray) -> Optional[Drawn]:
    """Return the drawn object from which a constraint can be read back, None for kinds that are not drawn."""
    if isinstance(constraint, OnCurve):
        points = np.asarray(constraint.points, dtype=np.float64)
        return Drawn("", "curve", np.concatenate([points, points[:1]]) if constraint.closed else points, None, {})
    if not isinstance(constraint, (Height, Fixed)) or isinstance(constraint.vertices, str) or not len(constraint.vertices):
        return None
    places = vertices[list(constraint.vertices)]
    if isinstance(constraint, Fixed):
        return Drawn("", "point cloud", places, None, {"keep": "yes"})
    return Drawn("", "point cloud", np.column_stack([places[:, :2], np.full(len(places), constraint.height)]), None, {})


def _on_curve(item: Drawn, vertices: FloatArray, tolerance: float) -> list[Constraint]:
    on = sorted(set(_along(item, vertices, tolerance)))
    if not on:
        raise ValueError("does not pass through a vertex of the mesh; draw it along vertices")
    if "keep" in item.text:
        return [Fixed(on)]
    closed = bool(np.array_equal(item.points[0], item.points[-1]))
    points = item.points[:-1] if closed else item.points
    return [OnCurve(on, points.tolist(), closed)]


def _at_points(item: Drawn, vertices: FloatArray, tolerance: float, unit: str) -> list[Constraint]:
    """Return one constraint per height of the points of an object."""
    if not _has_place(item):
        raise ValueError("has no finite coordinates; delete it")
    distance, nearest = cKDTree(vertices[:, :2]).query(item.points[:, :2])
    if distance.max() > tolerance:
        raise ValueError(f"is {distance.max():.3g}{unit} in plan from the nearest vertex; put it exactly above or below a vertex")
    if "keep" in item.text:
        return [Fixed(sorted(set(nearest.tolist())))]
    heights = dict.fromkeys(item.points[:, 2].tolist())
    return [Height(nearest[item.points[:, 2] == z].tolist(), z) for z in heights]


def _along(item: Drawn, vertices: FloatArray, tolerance: float) -> list[int]:
    return points_along(vertices, item.points, tolerance).tolist() if len(item.points) > 1 else []


def _has_place(item: Drawn) -> bool:
    return bool(len(item.points)) and bool(np.isfinite(item.points).all())
