"""Conversion inside Rhino and Grasshopper, in double precision.

RhinoCommon keeps single-precision vertices beside the doubles, and ``mesh.Vertices[i]``
gives the former: everything here goes through ``ToPoint3dArray``. ``Rhino`` is loaded
when a function needs it, so the module can be imported and tested anywhere.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Iterable
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...errors import MeshError
from ..reading import ReadProblem
from .archive import Item
from .archive import rhino3dm_module
from .assemble import assemble
from .outlines import outlined
from .precision import rounding_of
from .sketch import Drawn
from .sketch import Part
from .surfaces import MeshedSurface
from .surfaces import default_edge_length
from .surfaces import rounded_length
from .surfaces import surface_part
from .units import unit_suffix

if TYPE_CHECKING:
    import Rhino

__all__ = [
    "curve_to_points",
    "mesh_from_arrays",
    "mesh_to_arrays",
    "points_to_array",
    "points_to_rhino",
    "polyline_to_rhino",
    "problem_from_rhino",
    "problem_from_surfaces",
]


def mesh_to_arrays(mesh: Rhino.Geometry.Mesh) -> tuple[FloatArray, IntArray]:
    """Return the vertices (n, 3) [L] and faces (m, 4) of a Rhino mesh; a triangle repeats its last corner."""
    corners = [(face.A, face.B, face.C, face.D) for face in mesh.Faces]
    return points_to_array(mesh.Vertices.ToPoint3dArray()), np.array(corners, dtype=np.int64).reshape(-1, 4)


def mesh_from_arrays(vertices: FloatArray, faces: IntArray, colours: Optional[IntArray] = None) -> Rhino.Geometry.Mesh:
    """Return a Rhino mesh with every bit of the coordinates.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    colours
        ``(n, 3)`` red, green and blue of the vertices, 0..255.
    """
    import Rhino

    mesh = Rhino.Geometry.Mesh()
    # Before the first vertex: the doubles of vertices added earlier would be lost.
    mesh.Vertices.UseDoublePrecisionVertices = True
    deque(map(mesh.Vertices.Add, *np.asarray(vertices, dtype=np.float64).T.tolist()), maxlen=0)
    deque(map(mesh.Faces.AddFace, *np.asarray(faces, dtype=np.int64).T.tolist()), maxlen=0)
    if colours is not None:
        deque(map(mesh.VertexColors.Add, *np.asarray(colours, dtype=np.int64).T.tolist()), maxlen=0)
    mesh.Normals.ComputeNormals()
    return mesh


def points_to_array(points: Iterable[Rhino.Geometry.Point3d]) -> FloatArray:
    """Return the coordinates of Rhino points (k, 3) [L]."""
    return np.array([(p.X, p.Y, p.Z) for p in points], dtype=np.float64).reshape(-1, 3)


def points_to_rhino(points: ArrayLike) -> list[Rhino.Geometry.Point3d]:
    """Return Rhino points of coordinates (k, 3) [L]."""
    import Rhino

    return [Rhino.Geometry.Point3d(x, y, z) for x, y, z in np.asarray(points, dtype=np.float64).tolist()]


def polyline_to_rhino(points: ArrayLike) -> Rhino.Geometry.PolylineCurve:
    """Return a Rhino polyline through points (k, 3) [L]."""
    import Rhino

    return Rhino.Geometry.PolylineCurve(points_to_rhino(points))


def curve_to_points(curve: Rhino.Geometry.Curve, tolerance: float) -> FloatArray:
    """Return points along a Rhino curve whose polyline keeps within a tolerance of it (k, 3) [L].

    The corners of a polyline come back exactly.
    """
    found, polyline = curve.TryGetPolyline()
    if not found:
        line = curve.ToPolyline(tolerance, 0.1, 0.0, 0.0)
        polyline = [] if line is None else [line.Point(i) for i in range(line.PointCount)]
    return points_to_array(polyline)


def problem_from_rhino(
    mesh: Rhino.Geometry.Mesh,
    supports: Iterable[Rhino.Geometry.Point3d] = (),
    creases: Iterable[Rhino.Geometry.Curve] = (),
    targets: Iterable[tuple[Rhino.Geometry.Point3d, float]] = (),
    tolerance: float = 1e-3,
    units: str = "Meters",
    crease: str = "trace",
) -> ReadProblem:
    """Fit Rhino geometry together as :func:`compas_cgc.io.rhino.read_3dm` does with a file.

    Parameters
    ----------
    mesh
        Mesh as Rhino makes it: unwelded, quads, single or double precision.
    supports
        Points at vertices that stay.
    creases
        Curves that the surface may fold along.
    targets
        Pairs of a point in a region and its Gaussian curvature [1/L^2].
    tolerance
        Distance within which points are one [L]; Rhino's is ``ModelAbsoluteTolerance``.
    units
        Name of the unit system.
    crease
        ``"trace"`` or ``"split"``.

    Returns
    -------
    ReadProblem
        ``checked()`` gives the problem, ``notes`` and ``diagnostics`` what to tell the user.

    Raises
    ------
    FileError
        If no usable mesh comes of it.
    """
    vertices, faces = mesh_to_arrays(mesh)
    rounding = rounding_of(vertices, mesh.Vertices.UseDoublePrecisionVertices)
    dots = [Drawn(f"target {i}", "point", points_to_array([p]), float(K), {}) for i, (p, K) in enumerate(targets)]
    part = MeshedSurface(Part("the mesh", vertices, faces, rounding, None, {}), [], [])
    return _assembled([part], supports, list(creases), tolerance, units, crease, dots)


def problem_from_surfaces(
    surfaces: Sequence[Rhino.Geometry.GeometryBase],
    edge_length: Optional[float] = None,
    supports: Sequence[Rhino.Geometry.Point3d] = (),
    creases: Sequence[Rhino.Geometry.Curve] = (),
    tolerance: float = 1e-3,
    units: str = "Meters",
    crease: str = "trace",
) -> ReadProblem:
    """Mesh surfaces of Rhino, or what lies within closed curves, and fit supports and creases to it.

    Surfaces go over to rhino3dm by Rhino's own encoding of them, which loses nothing, and are meshed as those of a file are;
    it takes the extras ``rhino`` and ``mesher``.

    Parameters
    ----------
    surfaces
        Breps, surfaces, extrusions and SubDs; or closed curves, of which the widest is the outline and the others are holes.
    edge_length
        Length of edges aimed at [L]. Default: a thirtieth of the surfaces' size.
    supports, creases, tolerance, units, crease
        As for :func:`problem_from_rhino`. Between curves supports become vertices, and creases edges.

    Raises
    ------
    FileError
        If they cannot be meshed; the sentence says what to do in Rhino.
    """
    items = list(surfaces)
    outlines = [one for one in items if hasattr(one, "TryGetPolyline")]
    if outlines and len(outlines) < len(items):
        raise FileError("there are curves among the surfaces; connect either surfaces, or closed curves")
    if not outlines:
        return _assembled(_meshed(items, edge_length, tolerance, units), supports, creases, tolerance, units, crease)
    fine = 0.25 * tolerance
    rings = [(f"curve {i}", _closed(curve_to_points(curve, fine), tolerance)) for i, curve in enumerate(outlines)]
    every = np.concatenate([points for _, points in rings])
    length = rounded_length(every) if edge_length is None else edge_length
    lines = [Drawn(f"curve {i}", "curve", curve_to_points(curve, fine), None, {}) for i, curve in enumerate(creases)]
    try:
        made = outlined(rings, lines, points_to_array(supports), length, tolerance)
    except MeshError as error:
        raise FileError(str(error)) from None
    # The creases are edges of the mesh now, cut at the outline.
    return _assembled([made._replace(notes=[f"a mesh: {made.notes[0]}", *made.notes[1:]])], supports, [], tolerance, units, crease)


def _closed(points: FloatArray, tolerance: float) -> FloatArray:
    """Return points (k, 3) whose last one is the first, where they all but meet."""
    if len(points) > 3 and np.linalg.norm(points[0] - points[-1]) <= tolerance:
        return np.concatenate([points[:-1], points[:1]])
    return points


def _meshed(
    surfaces: Sequence[Rhino.Geometry.GeometryBase], edge_length: Optional[float], tolerance: float, units: str
) -> list[MeshedSurface]:
    """Return the meshes of surfaces."""
    items = [
        Item(_in_rhino3dm(one), type(one).__name__, str(number), "the canvas", "", {}, {}, False) for number, one in enumerate(surfaces)
    ]
    length = default_edge_length(items) if edge_length is None else edge_length
    return [surface_part(item, length, tolerance, unit_suffix(units)) for item in items]


def _in_rhino3dm(geometry: Rhino.Geometry.GeometryBase) -> Any:
    """Return an object of Rhino as one of rhino3dm."""
    rhino3dm = rhino3dm_module()
    if isinstance(geometry, rhino3dm.CommonObject):
        return geometry
    import Rhino

    made = rhino3dm.CommonObject.Decode(json.loads(geometry.ToJSON(Rhino.FileIO.SerializationOptions())))
    if made is None:
        raise FileError(f"the {type(geometry).__name__} cannot be read by rhino3dm; run Rhino's command Mesh on it, and connect the mesh")
    return made


def _assembled(
    parts: Sequence[MeshedSurface],
    supports: Iterable[Rhino.Geometry.Point3d],
    creases: Sequence[Rhino.Geometry.Curve],
    tolerance: float,
    units: str,
    crease: str,
    targets: Sequence[Drawn] = (),
) -> ReadProblem:
    points = [Drawn(f"point {i}", "point", points_to_array([p]), None, {}) for i, p in enumerate(supports)]
    joints = [joint for part in parts for joint in part.creases]
    return assemble(
        name="Rhino",
        parts=[part.part for part in parts],
        supports=lambda fine: points,
        creases=lambda fine: [Drawn(f"curve {i}", "curve", curve_to_points(c, fine), None, {}) for i, c in enumerate(creases)] + joints,
        targets=lambda fine: list(targets),
        constraints=lambda fine: [],
        units=units,
        tolerance=tolerance,
        crease=crease,
        notes=[note for part in parts for note in part.notes],
    )
