"""Snapping: drawn points and curves to the vertices that stay, or that constraints are about."""

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
    """Return the distance within which a drawn point is at a vertex [L].

    Points drawn by snapping are off by rounding: that of single precision, or of transforms.
    """
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    return min(max(tolerance, 4.0 * rounding, 1e-9 * size), 0.1 * mean_edge(vertices, faces))


def find_supports(drawn: list[Drawn], vertices: FloatArray, tolerance: float, unit: str) -> tuple[IntArray, list[str], list[Diagnostic]]:
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
                    f"support {item.label} runs through no vertex of the mesh; draw it along vertices, or put points on the vertices"
                )
            chosen += found
            continue
        if not _has_place(item):
            diagnostics.append(f"support {item.label} has no finite place; delete it")
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
        notes.append("there is no support: put points at vertices on the layer CGC::Supports, or fix the whole boundary")
    return supports, notes, [Diagnostic(text) for text in diagnostics]


def find_constraints(drawn: list[Drawn], vertices: FloatArray, tolerance: float, unit: str) -> tuple[list[Constraint], list[Diagnostic]]:
    """Find what is asked of vertices besides K.

    The vertices along a curve shall stay on it, and the vertex under or over a point (along
    z) shall come to its height. With user text ``keep`` the vertices along the curve or
    under the point shall stay where they are.

    Parameters
    ----------
    drawn
        Curves, points and point clouds.
    vertices
        ``(n, 3)`` coordinates [L].
    tolerance
        Largest distance of vertices from a curve, and in plan from a point [L].
    unit
        What lengths are followed by in sentences.
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
    """Return what is to be drawn so that a constraint is found again, None for kinds that are not drawn."""
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
        raise ValueError("runs through no vertex of the mesh; draw it along vertices")
    if "keep" in item.text:
        return [Fixed(on)]
    closed = bool(np.array_equal(item.points[0], item.points[-1]))
    points = item.points[:-1] if closed else item.points
    return [OnCurve(on, points.tolist(), closed)]


def _at_points(item: Drawn, vertices: FloatArray, tolerance: float, unit: str) -> list[Constraint]:
    """Return one constraint for all points of an object that are at the same height."""
    if not _has_place(item):
        raise ValueError("has no finite place; delete it")
    distance, nearest = cKDTree(vertices[:, :2]).query(item.points[:, :2])
    if distance.max() > tolerance:
        raise ValueError(f"is {distance.max():.4g}{unit} in plan from the nearest vertex; put it right over or under one")
    if "keep" in item.text:
        return [Fixed(sorted(set(nearest.tolist())))]
    heights = dict.fromkeys(item.points[:, 2].tolist())
    return [Height(nearest[item.points[:, 2] == z].tolist(), z) for z in heights]


def _along(item: Drawn, vertices: FloatArray, tolerance: float) -> list[int]:
    return points_along(vertices, item.points, tolerance).tolist() if len(item.points) > 1 else []


def _has_place(item: Drawn) -> bool:
    return bool(len(item.points)) and bool(np.isfinite(item.points).all())
