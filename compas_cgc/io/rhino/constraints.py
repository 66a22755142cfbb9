"""Designers' constraints on the layer ``CGC::Constraints``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...meshing.polyline import points_along
from .sketch import Drawn

if TYPE_CHECKING:
    from ...datastructures import CGCMesh
    from ...model.constraints import Constraint

__all__ = ["constraints_of", "find_constraints"]


def find_constraints(drawn: list[Drawn], vertices: FloatArray, tolerance: float, unit: str) -> tuple[list[dict], list[str], list[str]]:
    """Find the vertices that constraints are about.

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

    Returns
    -------
    constraints, notes, problems
        Each constraint is plain data with ``kind`` (curve, held or height) and ``vertices``.
    """
    found: list[dict] = []
    problems = []
    for item in drawn:
        if item.kind == "curve":
            on = points_along(vertices, item.points, tolerance).tolist() if len(item.points) > 1 else []
            if not on:
                problems.append(f"constraint {item.label} runs through no vertex of the mesh; draw it along vertices")
            elif "keep" in item.text:
                found.append({"kind": "held", "vertices": sorted(set(on))})
            else:
                closed = bool(np.array_equal(item.points[0], item.points[-1]))
                points = item.points[:-1] if closed else item.points
                found.append({"kind": "curve", "vertices": sorted(set(on)), "points": points.tolist(), "closed": closed})
            continue
        distance, nearest = cKDTree(vertices[:, :2]).query(item.points[:, :2])
        if len(distance) and distance.max() > tolerance:
            problems.append(
                f"constraint {item.label} is {distance.max():.4g}{unit} in plan from the nearest vertex; put it right over or under one"
            )
            continue
        if "keep" in item.text:
            found.append({"kind": "held", "vertices": sorted(set(nearest.tolist()))})
        else:
            found += [{"kind": "height", "vertices": [int(v)], "height": float(p[2])} for v, p in zip(nearest, item.points)]
    notes = [f"{len(found)} constraints besides K, which the method 'projection' holds"] if found else []
    return found, notes, problems


def constraints_of(mesh: CGCMesh) -> list[Constraint]:
    """Return the constraints that came with a mesh, to be given to :func:`compas_cgc.solve`."""
    from ...model.constraint_data import constraint_of

    items = mesh.attributes.get("constraints") or []
    return [constraint_of(item) for item in (items if isinstance(items, list) else [items])]
