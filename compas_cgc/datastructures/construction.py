"""Construction of meshes from faces, outlines in plan, and surfaces of COMPAS or Rhino."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from itertools import chain
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import FloatArray
from ..discrete.plan import flattened
from ..errors import MeshError

if TYPE_CHECKING:
    from ..meshing.outline import Outlined

__all__ = ["ON_THE_MESH", "checked_faces", "evaluated", "meshed_outline", "said_of_the_mesh"]

# Arguments that users try when constructing a mesh, and the call to make afterwards.
ON_THE_MESH = {
    **dict.fromkeys(("target", "targets", "K", "k", "curvature"), "set_target(0.005)"),
    **dict.fromkeys(("supports", "support", "fixed", "boundary"), 'set_supports("boundary")'),
    **dict.fromkeys(("creases", "crease", "folds"), "set_creases(paths)"),
}


CURVE_SEGMENTS = 360  # segments of the polyline that samples a COMPAS curve


class Evaluated(NamedTuple):
    """A parametric surface."""

    at: Callable[[FloatArray], FloatArray]  # from (k, 2) parameters to (k, 3) points [L]
    domain: tuple[tuple[float, float], tuple[float, float]]
    spans: tuple[Sequence[float], Sequence[float]]  # knots in u and v


def said_of_the_mesh(name: str) -> str:
    """Return what to write instead of an argument that mesh construction does not take."""
    if name in ("columns", "column", "supports_at"):
        return "give columns as points: from_outline(outline, edge_length, points=[[x, y], ...])"
    return f"set it on the mesh afterwards: mesh.{ON_THE_MESH[name]}" if name in ON_THE_MESH else ""


def checked_faces(vertices: Any, faces: Any) -> tuple[Any, dict[int, list[int]]]:
    """Return vertices as plain numbers and faces as a dict, after checking that the faces name existing vertices.

    Raises
    ------
    MeshError
        If a vertex lacks a coordinate or a face names a vertex that does not exist.
    """
    points = _plain(vertices, float, "vertices must be points of three numbers, such as [[0, 0, 0], [1, 0, 0]]")
    polygons = _plain(faces, int, "faces must be lists of vertices, such as [[0, 1, 2], [2, 1, 3]]")
    flat = next((place for place in (points.values() if isinstance(points, Mapping) else points) if len(place) != 3), None)
    if flat is not None:
        raise MeshError(f"vertices must have three coordinates, not {len(flat)} as in {flat}; add z = 0 for a plan")
    known = points if isinstance(points, Mapping) else range(len(points))
    named = polygons if isinstance(polygons, Mapping) else dict(enumerate(polygons))
    lost = set(chain.from_iterable(named.values())).difference(known)
    if lost:
        key, v = next((key, v) for key, polygon in named.items() for v in polygon if v in lost)
        ones = not isinstance(points, Mapping) and v == len(points) and all(min(polygon) > 0 for polygon in named.values())
        mend = "the faces count vertices from 1 instead of 0: subtract 1" if ones else "correct the face"
        raise MeshError(f"face {key} names vertex {v}, which does not exist; {mend}")
    return points, dict(named)


def meshed_outline(
    outline: ArrayLike,
    edge_length: float,
    holes: Iterable[ArrayLike],
    creases: Iterable[ArrayLike],
    points: Optional[ArrayLike],
    tolerance: float,
) -> Outlined:
    """Return the mesh of an outline, after checking that every point became a vertex."""
    from ..meshing.outline import mesh_from_outline
    from ..meshing.outline import refuse_outside
    from ..meshing.outline import refuse_passed_over

    groups = {"outline": [outline], "holes": holes, "creases": creases}
    curves = [[_as_curve(curve, name) for curve in _listed(group, name)] for name, group in groups.items()]
    given = None if points is None or (isinstance(points, Sequence) and not points) else _as_curve(points, "points")
    given = None if given is None or not len(given) else given
    refuse_outside(curves[0][0], curves[2])
    made = mesh_from_outline(curves[0][0], curves[1], curves[2], edge_length, tolerance, given)
    if given is not None:
        refuse_passed_over(made, given, edge_length)
    return made


def evaluated(surface: Any) -> Optional[Evaluated]:
    """Return an untrimmed surface of COMPAS, rhino3dm or RhinoCommon as :class:`Evaluated`, None for other objects."""
    if hasattr(surface, "PointAt") and hasattr(surface, "Domain") and type(surface).__name__ != "Extrusion":
        spans = (surface.Domain(0), surface.Domain(1))
        u, v = ((float(span.T0), float(span.T1)) for span in spans)
        knots = (list(surface.GetSpanVector(0)), list(surface.GetSpanVector(1)))
        return Evaluated(_points_of(surface.PointAt, "XYZ"), (u, v), knots)
    if hasattr(surface, "point_at") and hasattr(surface, "domain_v"):
        u, v = ((float(span[0]), float(span[1])) for span in (surface.domain_u, surface.domain_v))
        knots = (list(getattr(surface, "knots_u", ())), list(getattr(surface, "knots_v", ())))
        return Evaluated(_points_of(surface.point_at, "xyz"), (u, v), knots)
    return None


def _points_of(at: Callable[[float, float], Any], axes: str) -> Callable[[FloatArray], FloatArray]:
    def points(parameters: FloatArray) -> FloatArray:
        found = [at(u, v) for u, v in parameters.tolist()]
        return np.array([[getattr(point, axis) for axis in axes] for point in found]).reshape(-1, 3)

    return points


def _listed(curves: Any, name: str) -> list[Any]:
    """Return curves as a list, empty for None."""
    if curves is None:
        return []
    if isinstance(curves, (str, bytes)) or not isinstance(curves, Iterable):
        raise ValueError(f"{name} must be a list of curves: {name}=[curve], not {curves!r:.60}")
    return list(curves)


def _as_curve(curve: ArrayLike, name: str) -> FloatArray:
    """Return the points of a curve (k, 3); COMPAS curves are sampled, and points in plan get z = 0."""
    given: Any = curve
    if hasattr(given, "point_at") and hasattr(given, "domain") and not hasattr(given, "__len__"):
        given = [list(given.point_at(t)) for t in np.linspace(given.domain[0], given.domain[1], CURVE_SEGMENTS + 1)]
    if name == "outline" and _are_curves(given):
        raise ValueError("a mesh has one outline; give curves inside it as holes=[...], and mesh other outlines separately")
    try:
        points = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be points of two or three numbers, such as [[0, 0], [6, 0], [6, 4]], not {given!r:.60}") from None
    if points.ndim == 1 and len(points) and name not in ("outline", "points"):
        raise ValueError(f"{name} must be a list of curves; put the single curve into a list: {name}=[curve]")
    if points.size == 0 and points.ndim < 2:
        points = points.reshape(0, 3)
    if points.ndim == 1 and len(points) in (2, 3):
        raise ValueError(f"{name} must be a list of points; put the single point into a list: {name}=[{points.tolist()}]")
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise ValueError(f"{name} must be points with two or three coordinates, not an array of shape {points.shape}")
    return points if points.shape[1] == 3 else flattened(points)


def _are_curves(given: Any) -> bool:
    return isinstance(given, Sequence) and len(given) > 0 and all(isinstance(each, Sequence) and np.ndim(each[:1]) == 2 for each in given)


def _plain(items: Any, kind: type, wanted: str) -> Any:
    """Return arrays as lists of Python numbers, because NumPy numbers cannot be written as JSON."""
    if isinstance(items, np.ndarray):
        return items.tolist()
    try:
        if isinstance(items, Mapping):
            return {int(key): [kind(x) for x in item] for key, item in items.items()}
        return [[kind(x) for x in item] for item in items]
    except (TypeError, ValueError):
        raise MeshError(f"{wanted}, not {items!r:.60}") from None
