"""Inequality goals: heights, clearance, plan outline, distance from a plane."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.plan import flattened
from ...meshing.closest_points import feet_on_polyline
from ..constraints import Constraint
from ..constraints import unit
from ..motion import Motion
from ..motion import Triple
from ..tolerances import NEGLIGIBLE
from .numbers import ALL
from .numbers import Vertices
from .numbers import check_finite
from .numbers import check_positive
from .numbers import in_plan

__all__ = ["Above", "Below", "Bound", "Clearance", "NearPlane", "Within"]

Where = Union[int, Sequence[float], Sequence[Sequence[float]], FloatArray]


@dataclass(frozen=True)
class Bound(Constraint):
    """Base class of inequality goals."""

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slack of points (k, 3), positive where the goal is met (k,) [L], and its unit gradients (k, 3)."""
        raise NotImplementedError


@dataclass(frozen=True)
class Above(Bound):
    """Keep vertices at or above a height z.

    Parameters
    ----------
    height
        Lowest z coordinate [L].
    vertices
        Indices of vertices. Default: all movable ones.

    Examples
    --------
    >>> from compas_cgc import Above
    >>> Above(2.5).height
    2.5
    """

    height: float
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        check_finite(self.height, "height")

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must stay vertical."""
        return up != 0.0

    def transformed(self, motion: Motion) -> Bound:
        """Return the goal after a motion: an upper limit if the motion reverses the z axis."""
        height = motion.height(self.height)
        return replace(self, height=height) if motion.up > 0.0 else Below(height, self.vertices)

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slack of points: their height above the limit."""
        return points[:, 2] - self.height, _each((0.0, 0.0, 1.0), points)


@dataclass(frozen=True)
class Below(Bound):
    """Keep vertices at or below a height z.

    Parameters
    ----------
    height
        Highest z coordinate [L].
    vertices
        Indices of vertices. Default: all movable ones.

    Examples
    --------
    >>> from compas_cgc import Below
    >>> Below(6.0, vertices=[3, 4]).vertices
    [3, 4]
    """

    height: float
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        check_finite(self.height, "height")

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must stay vertical."""
        return up != 0.0

    def transformed(self, motion: Motion) -> Bound:
        """Return the goal after a motion: a lower limit if the motion reverses the z axis."""
        height = motion.height(self.height)
        return replace(self, height=height) if motion.up > 0.0 else Above(height, self.vertices)

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slack of points: their height below the limit."""
        return self.height - points[:, 2], _each((0.0, 0.0, -1.0), points)


@dataclass(frozen=True)
class Clearance(Bound):
    """Keep the surface at or above a height z over a part of the plan.

    The goal applies to all corners of faces that reach over that part, so that the faces themselves are above it.

    Parameters
    ----------
    where
        Number of a region, a box ``(x0, y0, x1, y1)`` in plan, or ``(p, 2)`` or ``(p, 3)`` points of a closed polyline [L].
    height
        Lowest z coordinate there [L].

    Examples
    --------
    >>> from compas_cgc import Clearance
    >>> Clearance((5.5, 0.0, 9.5, 3.0), 2.5).outline().shape
    (4, 3)
    """

    where: Where
    height: float

    def __post_init__(self) -> None:
        check_finite(self.height, "height")
        if not isinstance(self.where, (int, np.integer)):
            self.outline()

    def outline(self) -> FloatArray:
        """Return the outline in plan (p, 3).

        Raises
        ------
        ValueError
            If `where` is neither a box nor a polyline.
        """
        given = np.asarray(self.where, dtype=np.float64)
        if given.ndim == 2:
            return in_plan(given, "the outline of a clearance", 3)
        if given.shape != (4,) or not np.isfinite(given).all() or not (given[0] < given[2] and given[1] < given[3]):
            raise ValueError(f"where of a clearance must be a region, a box x0, y0, x1, y1 or a closed polyline, not {given.tolist()}")
        x0, y0, x1, y1 = given
        return np.array([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)])

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must keep its direction."""
        return up > 0.0

    def transformed(self, motion: Motion) -> Clearance:
        """Return the goal after a motion."""
        height = motion.height(self.height)
        if isinstance(self.where, (int, np.integer)):
            return replace(self, height=height)
        return replace(self, where=motion.plan(self.outline()), height=height)

    def with_regions(self, number: Callable[[int], int]) -> Clearance:
        """Return the goal with another number of its region."""
        return replace(self, where=number(int(self.where))) if isinstance(self.where, (int, np.integer)) else self

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slack of points: their height above the limit."""
        return points[:, 2] - self.height, _each((0.0, 0.0, 1.0), points)


@dataclass(frozen=True)
class Within(Bound):
    """Keep vertices within a closed polyline in plan.

    Parameters
    ----------
    points
        ``(p, 2)`` or ``(p, 3)`` points of the polyline [L].
    vertices
        Indices of vertices. Default: all movable ones.

    Examples
    --------
    >>> from compas_cgc import Within
    >>> len(Within([[0, 0], [9, 0], [9, 9], [0, 9]]).points)
    4
    """

    points: Union[Sequence[Sequence[float]], FloatArray]
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        in_plan(self.points, "the outline to stay within", 3)

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must stay vertical."""
        return up != 0.0

    def transformed(self, motion: Motion) -> Within:
        """Return the line after a motion."""
        return replace(self, points=motion.plan(self.points))

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slack of points: their distance inside the polyline."""
        from ...meshing.in_outline import inside_outline

        line, flat = in_plan(self.points, "points", 3), flattened(points)
        closest, tangents = feet_on_polyline(flat, line, closed=True)
        inside = inside_outline(flat, line)
        away = flat - closest
        distance = np.linalg.norm(away, axis=1)
        turn = 1.0 if _turns_left(line) else -1.0
        across = turn * np.column_stack([-tangents[:, 1], tangents[:, 0], np.zeros(len(points))])
        signed = np.where(inside, distance, -distance)
        apart = distance > NEGLIGIBLE * float(np.ptp(line))
        return signed, np.where(apart[:, None], away / np.where(apart, signed, 1.0)[:, None], across)


@dataclass(frozen=True)
class NearPlane(Bound):
    """Keep vertices within a distance of a plane.

    Parameters
    ----------
    point
        ``(3,)`` point on the plane [L].
    normal
        ``(3,)`` normal of the plane, of any length.
    distance
        Largest distance from the plane [L].
    vertices
        Indices of vertices. Default: all movable ones.

    Examples
    --------
    >>> from compas_cgc import NearPlane
    >>> NearPlane((0, 0, 0), (0, 0, 1), 3.5).distance
    3.5
    """

    point: Triple
    normal: Triple
    distance: float
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        check_positive(self.distance, "distance")
        unit(self.normal, "the normal of a plane")

    def transformed(self, motion: Motion) -> NearPlane:
        """Return the plane after a motion."""
        point = motion.points(np.asarray(self.point, float))
        return replace(self, point=point, normal=motion.direction(self.normal), distance=motion.measure(self.distance))

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slack of points: the limit less their distance from the plane."""
        normal = unit(self.normal, "the normal of a plane")
        above = (points - np.asarray(self.point, float)) @ normal
        return self.distance - np.abs(above), np.where(above > 0.0, -1.0, 1.0)[:, None] * normal


def _turns_left(line: FloatArray) -> bool:
    x, y = line[:, 0], line[:, 1]
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0


def _each(direction: tuple[float, float, float], points: FloatArray) -> FloatArray:
    return np.broadcast_to(np.array(direction), (len(points), 3))
