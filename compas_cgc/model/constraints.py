"""Constraints: what a designer asks of vertices besides K."""

from __future__ import annotations

import math
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
from ..meshing.closest_points import nearest_on_polyline
from .frame import Frame
from .given import checked_number
from .given import vertex_names

__all__ = [
    "CROWN",
    "AtHeight",
    "ClosestPoints",
    "Constraint",
    "Fixed",
    "Mirror",
    "OnCurve",
    "OnLine",
    "OnPlane",
    "PositionConstraint",
    "Proximity",
    "called",
    "check_indices",
    "indices",
    "unit",
]


CROWN = "crown"


class ClosestPoints(NamedTuple):
    """Where constrained vertices should be."""

    points: FloatArray  # (k, 3) nearest points that fulfil the constraint [L]
    normal: FloatArray  # (k, 3, 3) projectors onto the directions that leave it


Triple = Union[Sequence[float], FloatArray]  # three numbers


class _Named(type):
    """A class whose wrong arguments are told by its name and its fields."""

    if not TYPE_CHECKING:

        def __call__(cls, *given, **by_name):
            try:
                signature(cls.__init__).bind(cls, *given, **by_name)
            except TypeError:
                takes = [field.name for field in fields(cls)]
                wrong = next((name for name in by_name if name not in takes), None)
                told = "" if wrong is None else f", and nothing called {wrong!r}{did_you_mean(wrong, takes)}"
                raise TypeError(f"{called(cls)} takes {', '.join(takes)}{told}; write {called(cls)}({', '.join(takes)})") from None
            return super().__call__(*given, **by_name)


def called(kind: type) -> str:
    """Return what users call a kind of constraint."""
    return "Height" if kind.__name__ == "AtHeight" else kind.__name__


@dataclass(frozen=True)
class Constraint(metaclass=_Named):
    """Base of all constraints; vertices are indices, lengths in model units.

    Examples
    --------
    >>> from compas_cgc import AtHeight, Constraint
    >>> isinstance(AtHeight("crown", 4.0), Constraint)
    True
    """

    def local(self, frame: Frame) -> Constraint:
        """Return the same constraint in a local frame."""
        return self

    def renumbered(self, index: IntArray) -> Constraint:
        """Return the same constraint where the vertices have other positions: `index` of each (n,), -1 where it is gone."""
        named = getattr(self, "vertices", None)
        if named is None or isinstance(named, str):
            return self
        kept = index[np.asarray(named, dtype=np.int64)]
        changed: dict[str, Any] = {"vertices": kept[kept >= 0].tolist()}
        return replace(self, **changed)


@dataclass(frozen=True)
class PositionConstraint(Constraint):
    """A constraint that says where vertices have to be; of some the vertices may be a word until they are bound to a problem."""

    vertices: Union[str, Sequence[int]]

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points at which vertices at some points (k, 3) fulfil the constraint."""
        raise NotImplementedError


@dataclass(frozen=True)
class OnPlane(PositionConstraint):
    """Vertices on the plane through a point [L] with a normal.

    Parameters
    ----------
    vertices
        Positions of the vertices that stay on the plane.
    point
        On the plane [L].
    normal
        Of the plane, of any length.

    Examples
    --------
    >>> from compas_cgc import OnPlane
    >>> OnPlane([4, 5], (0, 0, 0), (1, 0, 0)).vertices
    [4, 5]
    """

    vertices: Sequence[int]
    point: Triple
    normal: Triple

    def local(self, frame: Frame) -> OnPlane:
        """Return the plane in a local frame."""
        return replace(self, point=frame.to_local(np.asarray(self.point, float)))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the plane."""
        normal = unit(self.normal, "the normal of a plane")
        return ClosestPoints(points - ((points - self.point) @ normal)[:, None] * normal, _every(np.outer(normal, normal), points))


@dataclass(frozen=True)
class AtHeight(PositionConstraint):
    """Vertices at a height z [L]: those named, or the ``"crown"``, the highest vertex of the surface, wherever it comes to be.

    Parameters
    ----------
    vertices
        Positions of vertices, or ``"crown"``.
    height
        Their z [L].

    Examples
    --------
    >>> from compas_cgc import AtHeight
    >>> AtHeight("crown", 4.0)
    AtHeight(vertices='crown', height=4.0)
    """

    vertices: Union[str, Sequence[int]]
    height: float

    def __post_init__(self) -> None:
        if isinstance(self.vertices, str) and self.vertices != CROWN:
            raise ValueError(f"vertices of a height must be a list of vertices or 'crown', not {self.vertices!r}")
        if not math.isfinite(checked_number(self.height, "height")):
            raise ValueError(f"height must be a number, not {self.height!r}")

    def local(self, frame: Frame) -> AtHeight:
        """Return the height in a local frame."""
        return replace(self, height=(self.height - frame.origin[2]) / frame.scale)

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the points at the height below or above."""
        return ClosestPoints(np.column_stack([points[:, :2], np.full(len(points), self.height)]), _every(np.diag([0.0, 0.0, 1.0]), points))


@dataclass(frozen=True)
class OnLine(PositionConstraint):
    """Vertices on the endless line through a point [L] with a direction.

    Parameters
    ----------
    vertices
        Positions of the vertices that stay on the line.
    point
        On the line [L].
    direction
        Of the line, of any length.

    Examples
    --------
    >>> from compas_cgc import OnLine
    >>> OnLine([4], (0, 0, 0), (0, 0, 1)).direction
    (0, 0, 1)
    """

    vertices: Sequence[int]
    point: Triple
    direction: Triple

    def local(self, frame: Frame) -> OnLine:
        """Return the line in a local frame."""
        return replace(self, point=frame.to_local(np.asarray(self.point, float)))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the line."""
        along = unit(self.direction, "the direction of a line")
        closest = self.point + ((points - self.point) @ along)[:, None] * along
        return ClosestPoints(closest, _every(np.eye(3) - np.outer(along, along), points))


@dataclass(frozen=True)
class OnCurve(PositionConstraint):
    """Vertices on a curve, given as the points ``(p, 3)`` of a polyline [L].

    The vertices slide along the curve and stop at the ends of an open one.

    Parameters
    ----------
    vertices
        Positions of the vertices that stay on the curve.
    points
        ``(p, 3)`` points along it [L].
    closed
        Whether it returns to its first point.

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

    def local(self, frame: Frame) -> OnCurve:
        """Return the curve in a local frame."""
        return replace(self, points=frame.to_local(np.asarray(self.points, float)))

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the curve."""
        closest, tangents = nearest_on_polyline(points, np.asarray(self.points, dtype=np.float64), self.closed)
        return ClosestPoints(closest, np.eye(3) - tangents[:, :, None] * tangents[:, None, :])


@dataclass(frozen=True)
class Fixed(Constraint):
    """Vertices that stay where they are, such as a crease that is to be kept.

    Parameters
    ----------
    vertices
        Positions of the vertices that stay.

    Examples
    --------
    >>> from compas_cgc import Fixed
    >>> Fixed([0, 8]).vertices
    [0, 8]
    """

    vertices: Sequence[int]


@dataclass(frozen=True)
class Mirror(Constraint):
    """Mirror symmetry of the whole surface about the plane through a point [L] with a normal.

    Every vertex needs a mirror image among the vertices of the input, within half of the mean
    edge; the faces need not be symmetric.

    Parameters
    ----------
    point
        On the plane of symmetry [L].
    normal
        Of the plane of symmetry, of any length.

    Examples
    --------
    >>> from compas_cgc import Mirror
    >>> Mirror((7.5, 0, 0), (1, 0, 0)).normal
    (1, 0, 0)
    """

    point: Triple
    normal: Triple

    def local(self, frame: Frame) -> Mirror:
        """Return the plane in a local frame."""
        return replace(self, point=frame.to_local(np.asarray(self.point, float)))


@dataclass(frozen=True)
class Proximity(Constraint):
    """Vertices that stay nearer to the input than others: a factor on ``nearness`` for them.

    Parameters
    ----------
    vertices
        Positions of the vertices that shall stay near their places.
    weight
        How strongly, 1 as much as the rest of the surface.

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
    """Return what is given as points, or as three numbers, as an array.

    Raises
    ------
    ValueError
        If there are no numbers in it.
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
    """Return the vertices that a constraint of some kind names, sorted, each once.

    Raises
    ------
    ProblemError
        If there is no such vertex among ``n``.
    """
    given = np.asarray(vertices)
    if given.ndim != 1 or (given.size and given.dtype.kind not in "iu"):
        # Coordinates would be taken for vertices.
        given = np.asarray(vertex_names(vertices if given.ndim == 0 else given, f"vertices of the goal {called(kind)}"))
    at = np.unique(given.astype(np.int64))
    if len(at) and not (at[0] >= 0 and at[-1] < n):
        wrong = at[0] if at[0] < 0 else at[-1]
        raise ProblemError(
            [f"a constraint names vertex {wrong}; the mesh has the vertices 0 to {n - 1}; name one of these in the goal {called(kind)}"]
        )
    return at


def check_indices(constraints: Sequence[Constraint], n: int) -> None:
    """Refuse constraints that name vertices that are not among `n`.

    Raises
    ------
    ProblemError
        With a sentence that names the vertex.
    """
    for constraint in constraints:
        named = getattr(constraint, "vertices", ())
        if not isinstance(named, str):
            indices(named, n, type(constraint))
