"""Shapes of OpenCASCADE: curves, surfaces, and shells of trimmed faces that share their edges; files in millimetres."""

from __future__ import annotations

import itertools
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.nurbs import NurbsPatch
from ..errors import MeshError
from ..fabrication.shell.edges import loops_of
from ..fabrication.shell.fit import Fit
from ..fabrication.shell.fit import Piece
from ..fabrication.shell.heights import DEGREE
from .occt import EDGE
from .occt import FACE
from .occt import opencascade

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["shell_of", "step_content", "trimmed_face", "untrimmed_face"]

CURVE_DEGREE = 3
TIME_STAMP = re.compile(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d[^']*'")
COUNTER = re.compile(r"PRODUCT\('(.*) [\d.]+',\s*'\1 [\d.]+',")
OCCURRENCE = re.compile(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('\d+'")
CONSTANT_TIME = "'1980-01-01T00:00:00'"
UNNAMED = "ADVANCED_FACE('',"


def step_content(shape: Any, name: str, faces: Optional[list[str]] = None, origin: Optional[FloatArray] = None) -> bytes:
    """Return a STEP file of a shape [mm] with the names of its faces, in their order.

    A shape that may be far from the origin of the model is made around a point `origin` (3,) of it and moved there [mm]: OpenCASCADE joins
    edges whose ends agree within 1e-7 mm, which is below the rounding of georeferenced coordinates.
    """
    if origin is not None:
        shape = opencascade().transform(shape, np.column_stack([np.eye(3), origin]).ravel().tolist())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shape.step"
        opencascade().write_step(shape, str(path), "MM", name)
        content = path.read_text(encoding="utf-8")
    # The same shape gives the same file, without the time and numbers that depend on the files written before.
    content = COUNTER.sub(r"PRODUCT('\1','\1',", TIME_STAMP.sub(CONSTANT_TIME, content, count=1))
    numbers = itertools.count(1)
    content = OCCURRENCE.sub(lambda _: f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{next(numbers)}'", content)
    if faces is not None:
        first, *others = content.split(UNNAMED)
        if len(others) != len(faces):
            raise MeshError(f"OpenCASCADE wrote {len(others)} faces instead of {len(faces)}; write .3dm instead")
        escaped = [own.replace("'", "''") for own in faces]
        content = first + "".join(f"ADVANCED_FACE('{own}',{rest}" for own, rest in zip(escaped, others))
    return content.encode("utf-8")


def untrimmed_face(occt: Any, patch: NurbsPatch) -> Any:
    """Return the face of a whole surface [mm]."""
    return occt.surface_to_face(_surface(occt, patch))


def trimmed_face(occt: Any, patch: NurbsPatch, curves: list[FloatArray]) -> Any:
    """Return the face of a surface inside a loop of curves through points (k, 3), each beginning where the one before ends [mm]."""
    corners = [occt.make_vertex(curve[0].tolist()) for curve in curves]
    ends = [*corners[1:], corners[0]]
    made = [
        occt.make_edge_curve(_curve(occt, points), params=(0.0, 1.0), vertices=(first, last))
        for points, first, last in zip(curves, corners, ends)
    ]
    return occt.fix_face(occt.make_face_surface(_surface(occt, patch), loop=occt.make_wire(made)))


def shell_of(occt: Any, fit: Fit, placed: Callable[[FloatArray], FloatArray]) -> tuple[Any, list[int]]:
    """Return the shell of all faces, which share their edges, and the number of the piece of each of its faces.

    A surface in several parts has one shell for each of them.

    Raises
    ------
    MeshError
        If the faces do not make one valid shell.
    """
    shells, order = [], list[int]()
    beside = [edge.regions for edge in fit.edges if len(edge.regions) == 2]
    graph = coo_matrix((np.ones(len(beside)), np.reshape(beside, (-1, 2)).T), shape=(len(fit.pieces), len(fit.pieces)))
    count, part = connected_components(graph, directed=False)
    try:
        faces = _faces(occt, fit, placed)
        for number in range(count):
            own = np.flatnonzero(part == number).tolist()
            shell, numbers = _sewn(occt, [faces[k] for k in own])
            shells.append(shell)
            order += [own[k] for k in numbers]
    except RuntimeError as error:
        raise MeshError(f"OpenCASCADE cannot trim and join the surfaces ({error}); refine the mesh, or write .3dm") from None
    return shells[0] if count == 1 else occt.compound_from_shapes(shells), order


def _sewn(occt: Any, faces: list[Any]) -> tuple[Any, list[int]]:
    """Return the shell of connected faces, and the number of each of its faces, which are copies in another order."""
    shell = occt.fix_shell(occt.shell_from_faces(faces))
    if not occt.is_valid(shell):
        raise MeshError("OpenCASCADE does not accept the faces as one valid shell; refine the mesh, or write .3dm")
    middles = cKDTree([_middle(occt, face) for face in faces])
    order = middles.query([_middle(occt, face) for face in occt.shape_explore(shell, FACE)])[1].tolist()
    if sorted(order) != list(range(len(faces))):
        raise MeshError("OpenCASCADE did not keep all faces in the shell; refine the mesh, or write .3dm")
    return shell, order


def _faces(occt: Any, fit: Fit, placed: Callable[[FloatArray], FloatArray]) -> list[Any]:
    """Return the trimmed face of every piece; neighbours share their edges."""
    ends: dict[int, list[FloatArray]] = {}
    for edge, curve in zip(fit.edges, fit.curves):
        for vertex, point in zip(edge.path[[0, -1]].tolist(), curve[[0, -1]]):
            ends.setdefault(vertex, []).append(point)
    corners = {vertex: placed(np.mean(points, axis=0)) for vertex, points in ends.items()}
    nodes = {vertex: occt.make_vertex(point.tolist()) for vertex, point in corners.items()}
    made = []
    for edge, curve in zip(fit.edges, fit.curves):
        first, last = edge.path[[0, -1]].tolist()
        points = np.vstack([corners[first], placed(curve[1:-1]), corners[last]])
        made.append(occt.make_edge_curve(_curve(occt, points), params=(0.0, 1.0), vertices=(nodes[first], nodes[last])))
    faces = []
    for number, piece in enumerate(fit.pieces):
        own = [k for k, edge in enumerate(fit.edges) if number in edge.regions]
        loops = loops_of(fit.edges, own)
        outer = max(loops, key=lambda loop: _area(piece, fit, loop))
        face = occt.make_face_surface(_surface(occt, _graph(piece, placed)), loop=occt.make_wire([made[k] for k in outer]))
        for hole in loops:
            if hole is not outer:
                face = occt.face_add_loop(face, occt.make_wire([made[k] for k in hole]))
        faces.append(face)
    return faces


def _middle(occt: Any, face: Any) -> FloatArray:
    """Return the mean of the middles of the edges of a face (3,); OpenCASCADE takes centroids of volumes below faces, which may be 0."""
    middles = []
    for edge in occt.shape_explore(face, EDGE):
        start, end = occt.edge_domain(edge)
        middles.append(occt.curve_point_at(occt.edge_to_bspline(edge), 0.5 * (start + end)))
    return np.mean(middles, axis=0)


def _area(piece: Piece, fit: Fit, loop: list[int]) -> float:
    """Return the area of the box around a loop in the plane of a region."""
    plan = piece.local(np.concatenate([fit.curves[k] for k in loop]))[:, :2]
    return float(np.prod(np.ptp(plan, axis=0)))


def _curve(occt: Any, points: FloatArray) -> Any:
    """Return the interpolating curve of points (k, 3) with the domain 0 to 1, in proportion to the length of the chords."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spline = make_interp_spline(along / along[-1], points, k=min(CURVE_DEGREE, len(points) - 1))
    knots, times = np.unique(spline.t, return_counts=True)
    return occt.nurbscurve_from_parameters(spline.c.tolist(), [1.0] * len(spline.c), knots.tolist(), times.tolist(), spline.k, False)


def _graph(piece: Piece, placed: Callable[[FloatArray], FloatArray]) -> NurbsPatch:
    """Return the graph of heights as a surface; the control points lie above the Greville abscissae."""
    a, b = piece.space.shape
    u, v = (np.convolve(own[1:-1], np.full(DEGREE, 1.0 / DEGREE), "valid") for own in piece.space.knots)
    grid = np.stack([*np.meshgrid(u, v, indexing="ij"), piece.coefficients.reshape(a, b)], axis=-1).reshape(-1, 3)
    control = placed(grid @ piece.axes).reshape(a, b, 3)
    return NurbsPatch(np.concatenate([control, np.ones((a, b, 1))], axis=-1), piece.space.knots, (DEGREE, DEGREE))


def _surface(occt: Any, patch: NurbsPatch) -> Any:
    """Return a NURBS surface."""
    # compas_occt expects rows of constant v.
    control = patch.control.swapaxes(0, 1)
    points, weights = control[..., :3] / control[..., 3:], control[..., 3]
    (ku, mu), (kv, mv) = (np.unique(own, return_counts=True) for own in patch.knots)
    return occt.nurbssurface_from_parameters(
        points.tolist(), weights.tolist(), ku.tolist(), kv.tolist(), mu.tolist(), mv.tolist(), *patch.degrees, False, False
    )
