"""Conversion of curves, points and text dots to coordinates."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray
from ._types import Curve
from ._types import Point3d
from .archive import Item
from .archive import rhino3dm_module
from .archive import size_of
from .sketch import Drawn
from .user_text import dot_law
from .user_text import user_law

__all__ = ["EDGE_ACCURACY", "LARGEST", "curve_points", "to_drawn"]

EDGE_ACCURACY = 1e-6  # distance of mesh edges from their curves that matters, relative to the size of the curve
LARGEST = 1e50  # coordinate that may occur, in any unit: of larger ones products of four overflow soon
_MAX_POINTS = 20_000


def to_drawn(item: Item, tolerance: float, accuracy: float = 0.0) -> Drawn:
    """Return the points of a point, point cloud, curve or text dot; curves are sampled as by :func:`curve_points`."""
    law = user_law(item.text)
    if item.kind == "curve":
        points = curve_points(item.geometry, tolerance, accuracy)
    elif item.kind == "point cloud":
        points = _places(item.geometry.GetPoints())
    elif item.kind == "text dot":
        points = _places([item.geometry.Point])
        law = dot_law(item.geometry.Text) if law is None else law
    else:
        points = _places([item.geometry.Location])
    return Drawn(item.label, item.kind, points, law, item.text)


def curve_points(curve: Curve, tolerance: float, accuracy: float = 0.0) -> FloatArray:
    """Return points along a curve whose polyline is within a tolerance of the curve.

    Corners of polylines are exact. The parts of a polycurve are sampled separately, so that
    its kinks are preserved.

    Parameters
    ----------
    curve
        Curve of any kind.
    tolerance
        Largest distance between curve and polyline [L].
    accuracy
        The same relative to the size of the curve; the larger one holds. Some drawings have a tolerance of 0, or far below what matters.

    Returns
    -------
    (k, 3) float64
        The points. First and last are equal if the curve is closed; empty if its coordinates are damaged.
    """
    rhino3dm = rhino3dm_module()

    if isinstance(curve, rhino3dm.PolyCurve) and curve.SegmentCount > 1:
        parts = [curve_points(curve.SegmentCurve(i), tolerance, accuracy) for i in range(curve.SegmentCount)]
        points = np.concatenate([part for part in parts if len(part)] or [np.empty((0, 3))])
    else:
        polyline = curve.TryGetPolyline()
        fine = max(tolerance, accuracy * size_of(curve))
        points = np.array([(p.X, p.Y, p.Z) for p in polyline]) if polyline is not None else _sample(curve, fine)
    points = points.reshape(-1, 3)
    if not (np.abs(points) < LARGEST).all():
        return np.empty((0, 3))
    fresh = np.ones(len(points), bool)
    fresh[1:] = (points[1:] != points[:-1]).any(axis=1)
    points = points[fresh]
    if curve.IsClosed and len(points) > 2 and np.linalg.norm(points[0] - points[-1]) <= tolerance:
        points[-1] = points[0]
    return points


def _sample(curve: Curve, tolerance: float) -> FloatArray:
    """Bisect the parameter intervals until their midpoints are within the tolerance of the chords."""
    low, high = curve.Domain.T0, curve.Domain.T1

    def at(parameters: FloatArray) -> FloatArray:
        return np.array([(p.X, p.Y, p.Z) for p in map(curve.PointAt, parameters.tolist())]).reshape(-1, 3)

    t = np.linspace(low, high, 8 * max(1, min(curve.SpanCount, 500)) + 1)
    points = at(t)
    coarse = np.ones(len(t) - 1, bool)
    while coarse.any() and len(t) < _MAX_POINTS:
        where = np.flatnonzero(coarse)
        middle = 0.5 * (t[where] + t[where + 1])
        inside = at(middle)
        # A third of the tolerance, as the largest distance is not exactly at the midpoint.
        bad = np.linalg.norm(inside - 0.5 * (points[where] + points[where + 1]), axis=1) > tolerance / 3
        bad &= (middle > t[where]) & (middle < t[where + 1])
        t = np.insert(t, where + 1, middle)
        points = np.insert(points, where + 1, inside, axis=0)
        split = np.repeat(bad, 2)
        done = np.zeros(len(t) - 1, bool)
        first = where + np.arange(len(where))
        done[np.column_stack([first, first + 1]).ravel()] = split
        coarse = done
    return points


def _places(points: list[Point3d]) -> FloatArray:
    return np.array([(p.X, p.Y, p.Z) for p in points], dtype=np.float64).reshape(-1, 3)
