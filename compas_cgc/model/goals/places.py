"""Goals for the positions of vertices: in plan, level, on a surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import Optional
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.plan import flattened
from ...meshing.closest_points import feet_on_polyline
from ..constraints import ClosestPoints
from ..constraints import PositionConstraint
from ..constraints import point_array
from ..motion import Motion
from ..motion import Triple
from .numbers import FREE_EDGES
from .numbers import Vertices
from .numbers import in_plan

__all__ = ["EdgeInPlan", "Level", "OnSurface"]


@dataclass(frozen=True)
class EdgeInPlan(PositionConstraint):
    """Keep edges over a line in plan; they may rise and slide along it.

    Parameters
    ----------
    vertices
        Path of vertices along an edge, or ``"free"`` for all free edges.
    points
        ``(p, 2)`` or ``(p, 3)`` points of the line [L]. Default: the drawn edge.
    closed
        Whether the line closes.

    Examples
    --------
    >>> from compas_cgc import EdgeInPlan
    >>> EdgeInPlan().vertices
    'free'
    """

    vertices: Vertices = FREE_EDGES
    points: Optional[Union[Sequence[Sequence[float]], FloatArray]] = None
    closed: bool = False

    def __post_init__(self) -> None:
        if self.points is not None:
            in_plan(self.points, "points of an edge in plan", 2)

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must stay vertical."""
        return up != 0.0

    def transformed(self, motion: Motion) -> EdgeInPlan:
        """Return the line after a motion."""
        return self if self.points is None else replace(self, points=motion.plan(self.points))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points above or below the line."""
        line = np.asarray(self.points, dtype=np.float64)
        closest, tangents = feet_on_polyline(flattened(points), flattened(line), self.closed)
        closest[:, 2] = points[:, 2]
        return ClosestPoints(closest, np.diag([1.0, 1.0, 0.0]) - tangents[:, :, None] * tangents[:, None, :])


@dataclass(frozen=True)
class Level(PositionConstraint):
    """Keep an edge level and its plan unchanged, such as the ring of an oculus; its height is free unless it ends at supports.

    Parameters
    ----------
    vertices
        Vertices of the edge, or ``"free"`` for every free edge, each with its own height or that of the supports at its ends.
    points
        ``(k, 2)`` or ``(k, 3)`` position in plan of every vertex [L]. Default: that in the drawing.

    Examples
    --------
    >>> from compas_cgc import Level
    >>> Level([5, 6, 7]).vertices
    [5, 6, 7]
    """

    vertices: Vertices = FREE_EDGES
    points: Optional[Union[Sequence[Sequence[float]], FloatArray]] = None

    def __post_init__(self) -> None:
        if self.points is not None and not isinstance(self.vertices, str) and len(self.points) != len(self.vertices):
            raise ValueError(f"a level edge needs one point per vertex ({len(self.vertices)}), not {len(self.points)}")

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must stay vertical."""
        return up != 0.0

    def renumbered(self, index: IntArray) -> Level:
        """Return the goal with the vertex numbers `index` (n,), where -1 marks removed vertices, which lose their points."""
        if isinstance(self.vertices, str):
            return self
        first = {int(index[v]): at for at, v in reversed(list(enumerate(self.vertices))) if index[v] >= 0}
        kept = sorted(first.items(), key=lambda item: item[1])
        points = None if self.points is None else [self.points[at] for _, at in kept]
        return replace(self, vertices=[vertex for vertex, _ in kept], points=points)

    def transformed(self, motion: Motion) -> Level:
        """Return the plan after a motion."""
        return self if self.points is None else replace(self, points=motion.plan(self.points))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the positions in plan at the mean height."""
        plan = np.asarray(self.points, dtype=np.float64)[:, :2]
        places = np.column_stack([plan, np.full(len(points), points[:, 2].mean())])
        return ClosestPoints(places, _every_plan(len(points)))


@dataclass(frozen=True)
class OnSurface(PositionConstraint):
    """Keep vertices on a surface, given as a triangle mesh; they slide on it.

    Parameters
    ----------
    vertices
        Indices of the vertices.
    points
        ``(p, 3)`` vertices of the triangle mesh [L].
    faces
        ``(q, 3)`` triangles.

    Examples
    --------
    >>> from compas_cgc import OnSurface
    >>> OnSurface([4], [[0, 0, 0], [9, 0, 0], [0, 9, 0]], [[0, 1, 2]]).vertices
    [4]
    """

    vertices: Sequence[int]
    points: Union[Sequence[Triple], FloatArray]
    faces: Union[Sequence[Sequence[int]], IntArray]

    def __post_init__(self) -> None:
        points, faces = point_array(self.points, "points of a surface"), np.asarray(self.faces)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise ValueError(f"points of a surface must be finite and of shape (p, 3), not {points.shape}")
        if faces.ndim != 2 or faces.shape[1] != 3 or not len(faces):
            raise ValueError(f"faces of a surface must be triangles (q, 3), one or more, not of shape {faces.shape}")
        if not ((faces >= 0) & (faces < len(points))).all():
            raise ValueError(f"faces of a surface must name points 0 to {len(points) - 1}; correct the faces")

    def transformed(self, motion: Motion) -> OnSurface:
        """Return the surface after a motion."""
        return replace(self, points=motion.points(np.asarray(self.points, float)))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the surface."""
        from ...meshing.closest_on_mesh import nearest_on_mesh

        closest, normals = nearest_on_mesh(points, np.asarray(self.points, dtype=np.float64), np.asarray(self.faces, dtype=np.int64))
        return ClosestPoints(closest, normals[:, :, None] * normals[:, None, :])


def _every_plan(count: int) -> FloatArray:
    return np.broadcast_to(np.diag([1.0, 1.0, 0.0]), (count, 3, 3))
