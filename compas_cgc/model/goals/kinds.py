"""Goals as values: what is asked besides K, with its numbers in model units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import Any
from typing import Optional
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.plan import flattened
from ...meshing.closest_points import nearest_on_polyline
from ..constraints import AtHeight
from ..constraints import ClosestPoints
from ..constraints import Constraint
from ..constraints import PositionConstraint
from ..constraints import Triple
from ..constraints import unit
from ..frame import Frame
from ..given import checked_number

__all__ = [
    "ALL",
    "FREE_EDGES",
    "Above",
    "Area",
    "Below",
    "Bound",
    "Clearance",
    "EdgeInPlan",
    "Height",
    "Length",
    "Level",
    "NearPlane",
    "OnSurface",
    "Rise",
    "Unknown",
    "Volume",
    "Whole",
    "Within",
    "in_plan",
    "is_of_whole",
]

NEAR = 1e-9  # of a line, against its size, that is on it
ALL = "all"
FREE_EDGES = "free"
Height = AtHeight  # of vertices, or of the crown, the highest vertex
Where = Union[int, Sequence[float], Sequence[Sequence[float]], FloatArray]
Vertices = Union[str, Sequence[int]]


@dataclass(frozen=True)
class Whole(Constraint):
    """Base of goals that are one number of the whole surface."""


@dataclass(frozen=True)
class Rise(Whole):
    """Height of the crown over the mean height of the supports [L]; negative where the surface hangs.

    Parameters
    ----------
    rise
        Of the crown over the supports [L]; not 0.

    Examples
    --------
    >>> import compas_cgc
    >>> mesh = compas_cgc.read(compas_cgc.get("cushion.3dm"))
    >>> result = compas_cgc.solve(mesh, goals=[compas_cgc.Rise(0.6)], unknown="all")
    >>> float(round(result.vertices[:, 2].max(), 6))
    0.6
    """

    rise: float

    def __post_init__(self) -> None:
        _finite(self.rise, "rise")
        if not self.rise:
            raise ValueError(f"rise must be a number other than 0, not {self.rise!r}")

    def local(self, frame: Frame) -> Rise:
        """Return the rise in a local frame."""
        return replace(self, rise=self.rise / frame.scale)


@dataclass(frozen=True)
class Volume(Whole):
    """Volume between the surface and a level z [L^3]; default: the mean height of the supports.

    Parameters
    ----------
    volume
        Above zero [L^3].
    level
        z that it counts from [L]. Default: the mean height of the supports.

    Examples
    --------
    >>> from compas_cgc import Volume
    >>> Volume(300.0).level is None
    True
    """

    volume: float
    level: Optional[float] = None

    def __post_init__(self) -> None:
        _positive(self.volume, "volume")
        if self.level is not None:
            _finite(self.level, "level")

    def local(self, frame: Frame) -> Volume:
        """Return the volume in a local frame."""
        level = None if self.level is None else _local_height(self.level, frame)
        return replace(self, volume=self.volume / frame.scale**3, level=level)


@dataclass(frozen=True)
class Area(Whole):
    """Area of the surface [L^2].

    Parameters
    ----------
    area
        Of the surface [L^2].

    Examples
    --------
    >>> from compas_cgc import Area
    >>> Area(240.0)
    Area(area=240.0)
    """

    area: float

    def __post_init__(self) -> None:
        _positive(self.area, "area")

    def local(self, frame: Frame) -> Area:
        """Return the area in a local frame."""
        return replace(self, area=self.area / frame.scale**2)


@dataclass(frozen=True)
class Length(Whole):
    """Length of a path of vertices, in their order [L].

    Parameters
    ----------
    vertices
        A path of two or more, in their order.
    length
        Of the path on the surface [L].

    Examples
    --------
    >>> from compas_cgc import Length
    >>> Length([0, 1, 2], 2.5).length
    2.5
    """

    vertices: Sequence[int]
    length: float

    def __post_init__(self) -> None:
        _positive(self.length, "length")
        if len(self.vertices) < 2:
            raise ValueError("vertices of a length must be a path of two or more")

    def local(self, frame: Frame) -> Length:
        """Return the length in a local frame."""
        return replace(self, length=self.length / frame.scale)


@dataclass(frozen=True)
class EdgeInPlan(PositionConstraint):
    """Edges that stay on their vertical sheets: over the line that they are drawn along, while they rise and slide.

    `vertices` are a path along an edge, or ``"free"`` for all free edges. The line is that of the drawing, unless
    its points ``(p, 2)`` or ``(p, 3)`` [L] are given.

    Parameters
    ----------
    vertices
        A path along an edge, or ``"free"`` for all free edges.
    points
        ``(p, 3)`` line to stay over [L]. Default: that of the drawing.
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

    def local(self, frame: Frame) -> EdgeInPlan:
        """Return the line in a local frame."""
        return self if self.points is None else replace(self, points=_local_plan(self.points, frame))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points over the line."""
        line = np.asarray(self.points, dtype=np.float64)
        closest, tangents = nearest_on_polyline(flattened(points), flattened(line), self.closed)
        closest[:, 2] = points[:, 2]
        return ClosestPoints(closest, np.diag([1.0, 1.0, 0.0]) - tangents[:, :, None] * tangents[:, None, :])


@dataclass(frozen=True)
class Level(PositionConstraint):
    """An edge that keeps its plan and rises as one, level: such as the ring of an oculus, which stays round.

    `vertices` are those of the edge, or ``"free"`` for every free edge, each at a height of its own. The plan is that of the
    drawing, unless points ``(k, 2)`` or ``(k, 3)`` [L] are given, one for every vertex.

    Parameters
    ----------
    vertices
        Of the edge; by default those of the free edges.
    points
        ``(p, 3)`` line in plan to stay over [L]. Default: that of the drawing.

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
            raise ValueError(f"points of a level edge must be one for every vertex, {len(self.vertices)}, not {len(self.points)}")

    def local(self, frame: Frame) -> Level:
        """Return the plan in a local frame."""
        return self if self.points is None else replace(self, points=_local_plan(self.points, frame))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the places in plan at the mean height."""
        plan = np.asarray(self.points, dtype=np.float64)[:, :2]
        places = np.column_stack([plan, np.full(len(points), points[:, 2].mean())])
        return ClosestPoints(places, _every_plan(len(points)))


@dataclass(frozen=True)
class OnSurface(PositionConstraint):
    """Vertices on a surface, given as a mesh of points ``(p, 3)`` [L] and triangles ``(q, 3)``; they slide on it.

    Parameters
    ----------
    vertices
        Positions of the vertices that slide on the mesh.
    points
        ``(p, 3)`` vertices of that mesh [L].
    faces
        ``(q, 3)`` triangles of it.

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
        points, faces = np.asarray(self.points, dtype=np.float64), np.asarray(self.faces)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise ValueError(f"points of a surface must be finite and of shape (p, 3), not {points.shape}")
        if faces.ndim != 2 or faces.shape[1] != 3 or not len(faces):
            raise ValueError(f"faces of a surface must be triangles (q, 3), one or more, not of shape {faces.shape}")
        if not ((faces >= 0) & (faces < len(points))).all():
            raise ValueError(f"faces of a surface name points that are not among its {len(points)}")

    def local(self, frame: Frame) -> OnSurface:
        """Return the surface in a local frame."""
        return replace(self, points=frame.to_local(np.asarray(self.points, float)))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the surface."""
        from ...meshing.closest_on_mesh import nearest_on_mesh

        closest, normals = nearest_on_mesh(points, np.asarray(self.points, dtype=np.float64), np.asarray(self.faces, dtype=np.int64))
        return ClosestPoints(closest, normals[:, :, None] * normals[:, None, :])


@dataclass(frozen=True)
class Bound(Constraint):
    """Base of goals that keep vertices on one side of something."""

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points (k, 3) are on the right side (k,) [L], and the unit directions further in (k, 3)."""
        raise NotImplementedError


@dataclass(frozen=True)
class Above(Bound):
    """Vertices nowhere below a height z [L]; default: all that may move.

    Parameters
    ----------
    height
        No vertex is lower than this z [L].
    vertices
        Those it holds for. Default: all that move.

    Examples
    --------
    >>> from compas_cgc import Above
    >>> Above(2.5).height
    2.5
    """

    height: float
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        _finite(self.height, "height")

    def local(self, frame: Frame) -> Above:
        """Return the height in a local frame."""
        return replace(self, height=_local_height(self.height, frame))

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points are above the height."""
        return points[:, 2] - self.height, _each((0.0, 0.0, 1.0), points)


@dataclass(frozen=True)
class Below(Bound):
    """Vertices nowhere above a height z [L]; default: all that may move.

    Parameters
    ----------
    height
        No vertex is higher than this z [L].
    vertices
        Those it holds for. Default: all that move.

    Examples
    --------
    >>> from compas_cgc import Below
    >>> Below(6.0, vertices=[3, 4]).vertices
    [3, 4]
    """

    height: float
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        _finite(self.height, "height")

    def local(self, frame: Frame) -> Below:
        """Return the height in a local frame."""
        return replace(self, height=_local_height(self.height, frame))

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points are below the height."""
        return self.height - points[:, 2], _each((0.0, 0.0, -1.0), points)


@dataclass(frozen=True)
class Clearance(Bound):
    """No point of the surface below a height z [L] over a part of the plan.

    `where` is the number of a region, a box ``(x0, y0, x1, y1)`` or a closed line of points ``(p, 2)`` or ``(p, 3)``. All
    corners of the faces over it are kept above, so that the faces themselves are.

    Parameters
    ----------
    where
        Number of a region, a box ``x0, y0, x1, y1`` in plan, or ``(p, 2)`` or ``(p, 3)`` points of a closed line.
    height
        Nothing over that place is lower than this z [L].

    Examples
    --------
    >>> from compas_cgc import Clearance
    >>> Clearance((5.5, 0.0, 9.5, 3.0), 2.5).outline().shape
    (4, 3)
    """

    where: Where
    height: float

    def __post_init__(self) -> None:
        _finite(self.height, "height")
        if not isinstance(self.where, (int, np.integer)):
            self.outline()

    def outline(self) -> FloatArray:
        """Return the closed line in plan (p, 3).

        Raises
        ------
        ValueError
            If it is neither a box nor a line.
        """
        given = np.asarray(self.where, dtype=np.float64)
        if given.ndim == 2:
            return in_plan(given, "the closed line of a clearance", 3)
        if given.shape != (4,) or not np.isfinite(given).all() or not (given[0] < given[2] and given[1] < given[3]):
            raise ValueError(f"where of a clearance must be a region, a box x0, y0, x1, y1 or a closed line, not {given.tolist()}")
        x0, y0, x1, y1 = given
        return np.array([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)])

    def local(self, frame: Frame) -> Clearance:
        """Return the place and the height in a local frame."""
        height = _local_height(self.height, frame)
        if isinstance(self.where, (int, np.integer)):
            return replace(self, height=height)
        return replace(self, where=_local_plan(self.outline(), frame), height=height)

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points are above the height."""
        return points[:, 2] - self.height, _each((0.0, 0.0, 1.0), points)


@dataclass(frozen=True)
class Within(Bound):
    """Vertices within a closed line in plan, of points ``(p, 2)`` or ``(p, 3)`` [L]; default: all that may move.

    Parameters
    ----------
    points
        ``(p, 2)`` or ``(p, 3)`` points of a closed line in plan [L].
    vertices
        Those it holds for. Default: all that move.

    Examples
    --------
    >>> from compas_cgc import Within
    >>> len(Within([[0, 0], [9, 0], [9, 9], [0, 9]]).points)
    4
    """

    points: Union[Sequence[Sequence[float]], FloatArray]
    vertices: Vertices = ALL

    def __post_init__(self) -> None:
        in_plan(self.points, "the closed line to stay within", 3)

    def local(self, frame: Frame) -> Within:
        """Return the line in a local frame."""
        return replace(self, points=_local_plan(self.points, frame))

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points are within the line."""
        from ...meshing.in_outline import inside_outline

        line, flat = in_plan(self.points, "points", 3), flattened(points)
        closest, tangents = nearest_on_polyline(flat, line, closed=True)
        inside = inside_outline(flat, line)
        away = flat - closest
        distance = np.linalg.norm(away, axis=1)
        turn = 1.0 if _turns_left(line) else -1.0
        across = turn * np.column_stack([-tangents[:, 1], tangents[:, 0], np.zeros(len(points))])
        signed = np.where(inside, distance, -distance)
        apart = distance > NEAR * float(np.ptp(line))
        return signed, np.where(apart[:, None], away / np.where(apart, signed, 1.0)[:, None], across)


@dataclass(frozen=True)
class NearPlane(Bound):
    """Vertices no further than a distance [L] from the plane through a point with a normal; default: all that may move.

    Parameters
    ----------
    point
        On the plane [L].
    normal
        Of the plane, of any length.
    distance
        None of the vertices is further from the plane [L].
    vertices
        Those it holds for. Default: all that move.

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
        _positive(self.distance, "distance")
        unit(self.normal, "the normal of a plane")

    def local(self, frame: Frame) -> NearPlane:
        """Return the plane in a local frame."""
        return replace(self, point=frame.to_local(np.asarray(self.point, float)), distance=self.distance / frame.scale)

    def slack(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points are from the nearer of the two faces of the slab."""
        normal = unit(self.normal, "the normal of a plane")
        above = (points - np.asarray(self.point, float)) @ normal
        return self.distance - np.abs(above), np.where(above > 0.0, -1.0, 1.0)[:, None] * normal


@dataclass(frozen=True)
class Unknown(Constraint):
    """Regions whose K is not given but found, together with the surface: those numbered, or ``"all"``.

    Parameters
    ----------
    regions
        Numbers of regions, or ``"all"``.

    Examples
    --------
    >>> from compas_cgc import Unknown
    >>> Unknown([0, 2]).regions
    [0, 2]
    """

    regions: Union[str, Sequence[int]] = ALL

    def __post_init__(self) -> None:
        if isinstance(self.regions, str) and self.regions != ALL:
            raise ValueError(f"regions of unknown K must be their numbers or 'all', not {self.regions!r}")


def is_of_whole(goal: Constraint) -> bool:
    """Return whether a goal is one number of the whole surface, or K that is to be found."""
    return isinstance(goal, (Whole, Unknown)) or (isinstance(goal, AtHeight) and isinstance(goal.vertices, str))


def in_plan(points: Any, name: str, fewest: int) -> FloatArray:
    """Return points as (p, 3) with z zero, the last one dropped where it closes the line.

    Raises
    ------
    ValueError
        If they are not finite points of two or three numbers, or too few.
    """
    try:
        given = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        given = np.empty((0, 0))
    if given.ndim != 2 or given.shape[-1] not in (2, 3) or not np.isfinite(given).all():
        raise ValueError(f"{name} must be finite points of two or three numbers, not of shape {given.shape}")
    flat = flattened(given)
    if len(flat) > fewest and np.array_equal(flat[0], flat[-1]):
        flat = flat[:-1]
    if len(flat) < fewest or not np.ptp(flat, axis=0).any():
        raise ValueError(f"{name} must be {fewest} or more different points")
    return flat


def _every_plan(count: int) -> FloatArray:
    return np.broadcast_to(np.diag([1.0, 1.0, 0.0]), (count, 3, 3))


def _turns_left(line: FloatArray) -> bool:
    x, y = line[:, 0], line[:, 1]
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0


def _each(direction: tuple[float, float, float], points: FloatArray) -> FloatArray:
    return np.broadcast_to(np.array(direction), (len(points), 3))


def _local_height(height: float, frame: Frame) -> float:
    return (height - float(frame.origin[2])) / frame.scale


def _local_plan(points: Any, frame: Frame) -> FloatArray:
    flat = np.asarray(points, dtype=np.float64)[:, :2]
    return (flat - frame.origin[:2]) / frame.scale


def _finite(value: float, name: str) -> None:
    if not math.isfinite(checked_number(value, name)):
        raise ValueError(f"{name} must be a number, not {value!r}")


def _positive(value: float, name: str) -> None:
    if not 0.0 < checked_number(value, name) < math.inf:
        raise ValueError(f"{name} must be a positive number, not {value!r}")
