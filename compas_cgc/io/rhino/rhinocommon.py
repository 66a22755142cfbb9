"""Conversion inside Rhino and Grasshopper, in double precision.

RhinoCommon keeps single-precision vertices beside the doubles, and ``mesh.Vertices[i]``
gives the former: everything here goes through ``ToPoint3dArray``. ``Rhino`` is loaded
when a function needs it, so the module can be imported and tested anywhere.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import TYPE_CHECKING
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ..._lazy import attach
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ..reading import ReadProblem
from .assemble import assemble
from .precision import rounding_of
from .sketch import Drawn
from .sketch import Part

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
]

__getattr__, __dir__ = attach(__name__, {}, renamed={"model_from_rhino": f"{__name__}.problem_from_rhino"})


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
    points = [Drawn(f"point {i}", "point", points_to_array([p]), None, {}) for i, p in enumerate(supports)]
    dots = [Drawn(f"target {i}", "point", points_to_array([p]), float(K), {}) for i, (p, K) in enumerate(targets)]
    curves = list(creases)
    return assemble(
        name="Rhino",
        parts=[Part("the mesh", vertices, faces, rounding, None, {})],
        supports=lambda fine: points,
        creases=lambda fine: [Drawn(f"curve {i}", "curve", curve_to_points(c, fine), None, {}) for i, c in enumerate(curves)],
        targets=lambda fine: dots,
        constraints=lambda fine: [],
        units=units,
        tolerance=tolerance,
        crease=crease,
    )
