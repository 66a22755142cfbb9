"""Curves, points and meshes of a drawing, and the role of every curve."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.problem import Drawing

__all__ = ["Layer", "Plan", "PlanCurve", "PlanMesh", "left_outside", "length", "plan_data", "roles", "size"]


class PlanCurve(NamedTuple):
    """A curve of a drawing."""

    points: FloatArray  # (k, 3) [L]; the last equals the first if the curve is closed
    layer: str
    circle: Optional[tuple[float, float, float]] = None  # centre x, y and radius of a circle in plan [L]

    @property
    def is_closed(self) -> bool:
        """Whether the last point equals the first."""
        return len(self.points) > 3 and bool((self.points[0] == self.points[-1]).all())


class PlanMesh(NamedTuple):
    """Faces of a drawing."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 4), a triangle repeats its last corner
    layer: str


class Layer(NamedTuple):
    """A layer of a drawing."""

    name: str
    objects: int  # number of curves, points and faces on it
    visible: bool
    read: bool


class Plan(NamedTuple):
    """Contents of a drawing."""

    curves: list[PlanCurve]
    points: FloatArray  # (k, 3), columns [L]
    meshes: list[PlanMesh]
    layers: list[Layer]
    unit: str  # unit of Rhino such as Millimeters, empty if not stated in the file
    tolerance: float  # distance within which ends of curves were joined [L]
    notes: list[str]  # changes made and objects ignored
    north: tuple[float, float] = Drawing().north  # direction in plan


def size(curves: Sequence[PlanCurve]) -> float:
    """Return the diagonal of the bounding box of curves [L], 0 without curves."""
    points = np.concatenate([curve.points for curve in curves]) if curves else np.zeros((1, 3))
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def length(curves: Sequence[PlanCurve]) -> float:
    """Return the total length of curves [L]."""
    return float(sum(np.linalg.norm(np.diff(curve.points, axis=0), axis=1).sum() for curve in curves))


def roles(plan: Plan, folded: Collection[str] = ()) -> list[str]:
    """Return the role of every curve: ``outline``, ``hole``, ``crease`` or ``outside``.

    The closed curve with the largest area in plan is the outline. Closed curves inside it are holes, open ones and those on the
    layers `folded` (in lower case) are creases.
    """
    bounds = [curve.is_closed and curve.layer.casefold() not in folded for curve in plan.curves]
    areas = [_area(curve.points) if bound else -1.0 for curve, bound in zip(plan.curves, bounds)]
    outline = int(np.argmax(areas)) if areas and max(areas) > 0 else -1
    result = ["hole" if bound else "crease" for bound in bounds]
    if outline < 0:
        return result
    low, high = _box(plan.curves[outline].points)
    for k, curve in enumerate(plan.curves):
        first, last = _box(curve.points)
        if (first > high).any() or (last < low).any():
            result[k] = "outside"
    result[outline] = "outline"
    return result


def left_outside(count: int) -> str:
    """Return the note on curves outside the outline."""
    return f"{count} curve{'s' * (count > 1)} outside the outline {'were' if count > 1 else 'was'} ignored"


def plan_data(plan: Plan) -> dict:
    """Return a plan as JSON data for the drawing board: lines, columns, layers and notes, without curves outside the outline."""
    part = roles(plan)
    outside = part.count("outside")
    notes = [*plan.notes, *([left_outside(outside)] if outside else [])]
    lines = [
        {
            "points": (curve.points[:-1] if curve.is_closed else curve.points).tolist(),
            "closed": curve.is_closed,
            "layer": curve.layer,
            "circle": None if curve.circle is None else dict(zip("xyr", curve.circle)),
        }
        for curve, role in zip(plan.curves, part)
        if role != "outside"
    ]
    columns = [{"x": x, "y": y, "height": z} for x, y, z in plan.points.tolist()]
    layers = [layer._asdict() for layer in plan.layers]
    return {"unit": plan.unit, "lines": lines, "columns": columns, "layers": layers, "tolerance": plan.tolerance, "notes": notes}


def _area(points: FloatArray) -> float:
    # Relative to the first point, to avoid cancellation far from the origin.
    x, y = (points[:-1, :2] - points[0, :2]).T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))


def _box(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    return points[:, :2].min(axis=0), points[:, :2].max(axis=0)
