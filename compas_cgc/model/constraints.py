"""Constraints on the positions of vertices."""

from __future__ import annotations

import math
from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import fields
from dataclasses import replace
from inspect import signature
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple
from typing import Union

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import ProblemError
from ..errors import did_you_mean
from ..meshing.closest_points import feet_on_polyline
from .given import checked_number
from .given import vertex_names
from .motion import Motion
from .motion import Triple

__all__ = [
    "CROWN",
    "Height",
    "ClosestPoints",
    "Constraint",
    "Fixed",
    "Mirror",
    "OnCurve",
    "OnLine",
    "OnPlane",
    "PositionConstraint",
    "Proximity",
    "check_indices",
    "indices",
    "unit",
]


CROWN = "crown"


class ClosestPoints(NamedTuple):
    """Nearest points that fulfil a constraint."""

    points: FloatArray  # (k, 3) [L]
    normal: FloatArray  # (k, 3, 3) projectors onto the directions that leave the constraint


class _Named(type):
    """Metaclass that names the fields of a constraint when its arguments are wrong."""

    if not TYPE_CHECKING:

        def __call__(cls, *given, **by_name):
            try:
                signature(cls.__init__).bind(cls, *given, **by_name)
            except TypeError:
                takes = [field.name for field in fields(cls)]
                wrong = next((name for name in by_name if name not in takes), None)
                hint = "" if wrong is None else f", not {wrong!r}{did_you_mean(wrong, takes)}"
                raise TypeError(f"{cls.__name__} takes {', '.join(takes)}{hint}; write {cls.__name__}({', '.join(takes)})") from None
            return super().__call__(*given, **by_name)


@dataclass(frozen=True)
class Constraint(metaclass=_Named):
    """Base class of all constraints; vertices are indices, lengths are in model units.

    Examples
    --------
    >>> from compas_cgc import Height, Constraint
    >>> isinstance(Height("crown", 4.0), Constraint)
    True
    """

    def transformed(self, motion: Motion) -> Constraint:
        """Return the constraint after a motion of the surface that it :meth:`admits`."""
        return self

    def admits(self, up: float) -> bool:
        """Check whether the constraint can follow a motion that keeps the z axis (1), reverses it (-1) or tilts it (0)."""
        return True

    def renumbered(self, index: IntArray) -> Constraint:
        """Return the constraint with the vertex numbers `index` (n,), where -1 marks removed vertices."""
        named = getattr(self, "vertices", None)
        if named is None or isinstance(named, str):
            return self
        kept = index[np.asarray(named, dtype=np.int64)]
        changed: dict[str, Any] = {"vertices": list(dict.fromkeys(kept[kept >= 0].tolist()))}
        return replace(self, **changed)

    def with_regions(self, number: Callable[[int], int]) -> Constraint:
        """Return the constraint with other numbers of the regions it names."""
        return self


@dataclass(frozen=True)
class PositionConstraint(Constraint):
    """Base class of constraints on positions; `vertices` may be a word such as ``"free"`` until the goal is bound to a problem."""

    vertices: Union[str, Sequence[int]]

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points to points (k, 3) that fulfil the constraint."""
        raise NotImplementedError


@dataclass(frozen=True)
class OnPlane(PositionConstraint):
    """Keep vertices on a plane.

    Parameters
    ----------
    vertices
        Indices of the vertices.
    point
        ``(3,)`` point on the plane [L].
    normal
        ``(3,)`` normal of the plane, of any length.

    Examples
    --------
    >>> from compas_cgc import OnPlane
    >>> OnPlane([4, 5], (0, 0, 0), (1, 0, 0)).vertices
    [4, 5]
    """

    vertices: Sequence[int]
    point: Triple
    normal: Triple

    def transformed(self, motion: Motion) -> OnPlane:
        """Return the plane after a motion."""
        return replace(self, point=motion.points(np.asarray(self.point, float)), normal=motion.direction(self.normal))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the plane."""
        normal = unit(self.normal, "the normal of a plane")
        return ClosestPoints(points - ((points - self.point) @ normal)[:, None] * normal, _every(np.outer(normal, normal), points))


@dataclass(frozen=True)
class Height(PositionConstraint):
    """Put vertices at a height z [L], or the ``"crown"``: the highest vertex of the solved surface.

    Parameters
    ----------
    vertices
        Indices of vertices, or ``"crown"``.
    height
        Their z coordinate [L].

    Examples
    --------
    >>> from compas_cgc import Height
    >>> Height("crown", 4.0)
    Height(vertices='crown', height=4.0)
    """

    vertices: Union[str, Sequence[int]]
    height: float

    def __post_init__(self) -> None:
        if isinstance(self.vertices, str) and self.vertices != CROWN:
            raise ValueError(f"vertices of a height must be a list of vertices or 'crown', not {self.vertices!r}")
        if not math.isfinite(checked_number(self.height, "height")):
            raise ValueError(f"height must be a number, not {self.height!r}")

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: a height of vertices always can, the crown must stay the highest vertex."""
        return up > 0.0 or not isinstance(self.vertices, str)

    def transformed(self, motion: Motion) -> PositionConstraint:
        """Return the height after a motion: a plane if the motion tilts the z axis."""
        if motion.up or isinstance(self.vertices, str):
            return replace(self, height=motion.height(self.height))
        return OnPlane(self.vertices, (0.0, 0.0, self.height), (0.0, 0.0, 1.0)).transformed(motion)

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the points at the height, below or above the given ones."""
        return ClosestPoints(np.column_stack([points[:, :2], np.full(len(points), self.height)]), _every(np.diag([0.0, 0.0, 1.0]), points))


@dataclass(frozen=True)
class OnLine(PositionConstraint):
    """Keep vertices on an infinite straight line.

    Parameters
    ----------
    vertices
        Indices of the vertices.
    point
        ``(3,)`` point on the line [L].
    direction
        ``(3,)`` direction of the line, of any length.

    Examples
    --------
    >>> from compas_cgc import OnLine
    >>> OnLine([4], (0, 0, 0), (0, 0, 1)).direction
    (0, 0, 1)
    """

    vertices: Sequence[int]
    point: Triple
    direction: Triple

    def transformed(self, motion: Motion) -> OnLine:
        """Return the line after a motion."""
        return replace(self, point=motion.points(np.asarray(self.point, float)), direction=motion.direction(self.direction))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the line."""
        along = unit(self.direction, "the direction of a line")
        closest = self.point + ((points - self.point) @ along)[:, None] * along
        return ClosestPoints(closest, _every(np.eye(3) - np.outer(along, along), points))


@dataclass(frozen=True)
class OnCurve(PositionConstraint):
    """Keep vertices on a curve, given as a polyline.

    The vertices slide along the curve and stop at the ends of an open one.

    Parameters
    ----------
    vertices
        Indices of the vertices.
    points
        ``(p, 3)`` points of the polyline [L].
    closed
        Whether the polyline returns to its first point.

    Examples
    --------
    >>> from compas_cgc import OnCurve
    >>> OnCurve([0, 1], [[0, 0, 0], [1, 0, 0], [1, 1, 0]]).closed
    False
    """

    vertices: Sequence[int]
    points: Union[Sequence[Triple], FloatArray]
    closed: bool = False

    def __post_init__(self) -> None:
        points = point_array(self.points, "points of a curve")
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all() or not np.ptp(points, axis=0).any():
            raise ValueError(f"points of a curve must be two or more different points (p, 3), not an array of shape {points.shape}")

    def transformed(self, motion: Motion) -> OnCurve:
        """Return the curve after a motion."""
        return replace(self, points=motion.points(np.asarray(self.points, float)))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the curve."""
        closest, tangents = feet_on_polyline(points, np.asarray(self.points, dtype=np.float64), self.closed)
        return ClosestPoints(closest, np.eye(3) - tangents[:, :, None] * tangents[:, None, :])


@dataclass(frozen=True)
class Fixed(Constraint):
    """Keep vertices at their drawn positions, such as those of a crease.

    Parameters
    ----------
    vertices
        Indices of the vertices.

    Examples
    --------
    >>> from compas_cgc import Fixed
    >>> Fixed([0, 8]).vertices
    [0, 8]
    """

    vertices: Sequence[int]


@dataclass(frozen=True)
class Mirror(Constraint):
    """Make the whole surface symmetric about a plane.

    Every vertex of the input needs a mirror image among its vertices, within half of the mean
    edge length; the faces need not be symmetric.

    Parameters
    ----------
    point
        ``(3,)`` point on the plane of symmetry [L].
    normal
        ``(3,)`` normal of the plane of symmetry, of any length.

    Examples
    --------
    >>> from compas_cgc import Mirror
    >>> Mirror((7.5, 0, 0), (1, 0, 0)).normal
    (1, 0, 0)
    """

    point: Triple
    normal: Triple

    def transformed(self, motion: Motion) -> Mirror:
        """Return the plane after a motion."""
        return replace(self, point=motion.points(np.asarray(self.point, float)), normal=motion.direction(self.normal))


@dataclass(frozen=True)
class Proximity(Constraint):
    """Keep some vertices closer to the drawing, by a factor on the setting ``nearness``.

    Parameters
    ----------
    vertices
        Indices of the vertices.
    weight
        Factor on ``nearness`` at these vertices; with 1 they are treated like all others.

    Examples
    --------
    >>> from compas_cgc import Proximity
    >>> Proximity([4], weight=10.0).weight
    10.0
    """

    vertices: Sequence[int]
    weight: float = 10.0

    def __post_init__(self) -> None:
        if not 0 < checked_number(self.weight, "weight") < math.inf:
            raise ValueError(f"weight must be a positive number, not {self.weight!r}")


def point_array(points: object, name: str) -> FloatArray:
    """Return points, or three coordinates, as an array.

    Raises
    ------
    ValueError
        If they are not numbers.
    """
    try:
        return np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be numbers x, y, z, not {points!r:.60}") from None


def unit(vector: Triple, name: str) -> FloatArray:
    """Return a unit vector (3,)."""
    given = point_array(vector, name)
    length = float(np.linalg.norm(given)) if given.shape == (3,) else 0.0
    if not (np.isfinite(length) and length > 0):
        raise ValueError(f"{name} must be three numbers, not all zero, not {given.tolist()}")
    return given / length


def _every(matrix: FloatArray, points: FloatArray) -> FloatArray:
    return np.broadcast_to(matrix, (len(points), 3, 3))


def indices(vertices: Union[str, Sequence[int]], n: int, kind: type = Constraint) -> IntArray:
    """Return the vertices that a constraint names, sorted and without duplicates.

    Raises
    ------
    ProblemError
        If a vertex is not among the ``n`` of the mesh.
    """
    given = np.asarray(vertices)
    if given.ndim != 1 or (given.size and given.dtype.kind not in "iu"):
        # Give an error for coordinates, which NumPy would cast to indices.
        given = np.asarray(vertex_names(vertices if given.ndim == 0 else given, f"vertices of the goal {kind.__name__}"))
    at = np.unique(given.astype(np.int64))
    if len(at) and not (at[0] >= 0 and at[-1] < n):
        wrong = at[0] if at[0] < 0 else at[-1]
        raise ProblemError([f"the goal {kind.__name__} names vertex {wrong}, but the mesh has vertices 0 to {n - 1}; name one of these"])
    return at


def check_indices(constraints: Sequence[Constraint], n: int) -> None:
    """Refuse constraints that name vertices outside 0 to `n` - 1.

    Raises
    ------
    ProblemError
        If there is such a vertex.
    """
    for constraint in constraints:
        named = getattr(constraint, "vertices", ())
        if not isinstance(named, str):
            indices(named, n, type(constraint))
