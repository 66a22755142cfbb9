"""Conversion inside Rhino and Grasshopper, in double precision.

RhinoCommon stores vertices in single and in double precision. ``mesh.Vertices[i]`` returns the
former, so this module uses ``ToPoint3dArray``. ``Rhino`` is imported lazily, so that the module
can be imported and tested outside Rhino.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Iterable
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...errors import MeshError
from ...model.laws import as_law
from ...model.lengths import unit_suffix
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
    """Return a Rhino mesh with the coordinates in double precision.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    colours
        ``(n, 3)`` RGB colours of the vertices, 0..255.
    """
    import Rhino

    mesh = Rhino.Geometry.Mesh()
    # Set before the first vertex, as the doubles of earlier vertices would be lost.
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
    """Return points (k, 3) along a Rhino curve whose polyline is within a tolerance of the curve [L].

    Corners of polylines are exact.
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
    targets: Iterable[tuple[Rhino.Geometry.Point3d, Union[float, str]]] = (),
    tolerance: float = 1e-3,
    units: str = "Meters",
    crease: str = "trace",
) -> ReadProblem:
    """Return the problem of Rhino geometry, as :func:`compas_cgc.io.rhino.read_3dm` does for a file.

    Parameters
    ----------
    mesh
        Rhino mesh: triangles or quads, welded or unwelded, in single or double precision.
    supports
        Points at fixed vertices.
    creases
        Curves along which the surface may fold.
    targets
        Pairs of a point in a region and its Gaussian curvature [1/L^2], or a text of its law such as ``H = 0.1``.
    tolerance
        Distance below which points coincide [L], usually ``ModelAbsoluteTolerance`` of the document.
    units
        Name of the unit system.
    crease
        ``"trace"`` or ``"split"``.

    Returns
    -------
    ReadProblem
        ``checked()`` returns the problem; ``notes`` and ``diagnostics`` are messages for the user.

    Raises
    ------
    FileError
        If the geometry does not form a usable mesh.
    """
    vertices, faces = mesh_to_arrays(mesh)
    rounding = rounding_of(vertices, mesh.Vertices.UseDoublePrecisionVertices)
    dots = [Drawn(f"target {i}", "point", points_to_array([p]), as_law(K), {}) for i, (p, K) in enumerate(targets)]
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
    """Mesh Rhino surfaces, or the area inside closed curves, and return the problem with supports and creases.

    Surfaces are converted to rhino3dm without loss by Rhino's own encoding, and meshed like those of a file. Requires the extras
    ``rhino`` and ``mesher``.

    Parameters
    ----------
    surfaces
        Breps, surfaces, extrusions and SubDs; or closed curves, of which the largest is the outline and the others are holes.
    edge_length
        Intended edge length [L]. Default: a thirtieth of the size of the surfaces.
    supports, creases, tolerance, units, crease
        As for :func:`problem_from_rhino`. In the area inside curves, supports become vertices and creases become edges.

    Raises
    ------
    FileError
        If they cannot be meshed; the message states what to do in Rhino.
    """
    items = list(surfaces)
    outlines = [one for one in items if hasattr(one, "TryGetPolyline")]
    if outlines and len(outlines) < len(items):
        raise FileError("the input has both curves and surfaces; connect either surfaces or closed curves")
    fine = 0.25 * tolerance
    if not outlines:
        drawn = [Drawn(f"curve {i}", "curve", curve_to_points(curve, fine), None, {}) for i, curve in enumerate(creases)]
        parts = _meshed(items, edge_length, tolerance, units, drawn)
        return _assembled(parts, supports, [] if parts[0].laid else creases, tolerance, units, crease)
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
    """Return points (k, 3), closed exactly if first and last coincide within the tolerance."""
    if len(points) > 3 and np.linalg.norm(points[0] - points[-1]) <= tolerance:
        return np.concatenate([points[:-1], points[:1]])
    return points


def _meshed(
    surfaces: Sequence[Rhino.Geometry.GeometryBase], edge_length: Optional[float], tolerance: float, units: str, creases: Sequence[Drawn]
) -> list[MeshedSurface]:
    """Return the meshes of surfaces; a single one gets edges along creases if possible."""
    items = [
        Item(_in_rhino3dm(one), type(one).__name__, str(number), "the canvas", "", {}, {}, False) for number, one in enumerate(surfaces)
    ]
    length = default_edge_length(items) if edge_length is None else edge_length
    return [surface_part(item, length, tolerance, unit_suffix(units), creases if len(items) == 1 else ()) for item in items]


def _in_rhino3dm(geometry: Rhino.Geometry.GeometryBase) -> Any:
    """Return a Rhino object as an object of rhino3dm."""
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
