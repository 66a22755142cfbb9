"""STEP files: the regions of a result as trimmed NURBS faces of one shell, through OpenCASCADE."""

from __future__ import annotations

import tempfile
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from ..discrete.arrays import FloatArray
from ..errors import FileError
from ..fabrication.shell.fit import Fit
from ..fabrication.shell.fit import Piece
from ..fabrication.shell.heights import DEGREE
from ..fabrication.shell.regions import region_surfaces
from ..model.problem import CGCProblem

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["step_bytes"]

CURVE_DEGREE = 3
MILLIMETRES = {"Millimeters": 1.0, "Centimeters": 10.0, "Meters": 1e3, "Kilometers": 1e6, "Inches": 25.4, "Feet": 304.8, "Yards": 914.4}


def step_bytes(problem: CGCProblem) -> tuple[bytes, list[str]]:
    """Return a STEP file in millimetres with one shell of all regions, and notes on its accuracy.

    Parameters
    ----------
    problem
        A solved problem; its units are metres by default.

    Raises
    ------
    MeshError
        If the surfaces do not meet their tolerances, see :func:`compas_cgc.fabrication.shell.regions.region_surfaces`.
    FileError
        If the package that writes STEP files is not installed, or if the faces do not make one valid shell.
    """
    occt = _occt()
    fit = region_surfaces(problem)
    factor = MILLIMETRES.get(problem.drawing.units or "Meters", 1e3)
    shell = _shell(occt, fit, lambda points: factor * (fit.centre + fit.scale * points))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shell.step"
        occt.write_step(shell, str(path), "MM", problem.drawing.name or "compas_cgc")
        content = path.read_bytes()
    half, most, largest = (100.0 * error for error in fit.percentiles())
    return content, [
        f"{len(fit.pieces)} faces in one shell, {factor * fit.gap:.2g} mm apart at most, "
        f"within {factor * fit.distance:.3g} mm of the mesh; "
        f"error of K away from supports {half:.2g} % (50 %), {most:.2g} % (95 %), {largest:.2g} % (100 %)"
    ]


def _occt() -> Any:
    try:
        return import_module("compas_occt._occt")
    except ImportError:
        raise FileError("STEP files require the package compas_occt; install it with: pip install 'compas_cgc[cad]'") from None


def _shell(occt: Any, fit: Fit, placed: Callable[[FloatArray], FloatArray]) -> Any:
    """Return the shell of all faces, which share their edges."""
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
        loops = _loops(fit, own)
        outer = max(loops, key=lambda loop: _area(piece, fit, loop))
        face = occt.make_face_surface(_surface(occt, piece, placed), loop=occt.make_wire([made[k] for k in outer]))
        for hole in loops:
            if hole is not outer:
                face = occt.face_add_loop(face, occt.make_wire([made[k] for k in hole]))
        faces.append(face)
    shell = occt.fix_shell(occt.shell_from_faces(faces))
    if not occt.is_valid(shell):
        raise FileError("OpenCASCADE does not accept the faces as one valid shell; refine the mesh, or write .3dm")
    return shell


def _loops(fit: Fit, own: list[int]) -> list[list[int]]:
    """Return the edges of a region (indices) in the order of its boundary loops."""
    left, loops = list(own), []
    while left:
        loop = [left.pop(0)]
        start, here = fit.edges[loop[0]].path[[0, -1]].tolist()
        while here != start:
            k = next(k for k in left if here in fit.edges[k].path[[0, -1]])
            left.remove(k)
            loop.append(k)
            first, last = fit.edges[k].path[[0, -1]].tolist()
            here = last if here == first else first
        loops.append(loop)
    return loops


def _area(piece: Piece, fit: Fit, loop: list[int]) -> float:
    """Return the area of the box around a loop in the plane of a region."""
    plan = piece.local(np.concatenate([fit.curves[k] for k in loop]))[:, :2]
    return float(np.prod(np.ptp(plan, axis=0)))


def _curve(occt: Any, points: FloatArray) -> Any:
    """Return the interpolating curve of points (k, 3) with the domain 0 to 1."""
    spline = make_interp_spline(np.linspace(0.0, 1.0, len(points)), points, k=CURVE_DEGREE)
    knots, times = np.unique(spline.t, return_counts=True)
    return occt.nurbscurve_from_parameters(spline.c.tolist(), [1.0] * len(spline.c), knots.tolist(), times.tolist(), CURVE_DEGREE, False)


def _surface(occt: Any, piece: Piece, placed: Callable[[FloatArray], FloatArray]) -> Any:
    """Return the graph of heights as a surface; the control points lie above the Greville abscissae."""
    a, b = piece.space.shape
    u, v = (np.convolve(own[1:-1], np.full(DEGREE, 1.0 / DEGREE), "valid") for own in piece.space.knots)
    grid = np.stack([*np.meshgrid(u, v, indexing="ij"), piece.coefficients.reshape(a, b)], axis=-1).reshape(-1, 3)
    # compas_occt expects rows of constant v.
    control = placed(grid @ piece.axes).reshape(a, b, 3).swapaxes(0, 1)
    (ku, mu), (kv, mv) = (np.unique(own, return_counts=True) for own in piece.space.knots)
    return occt.nurbssurface_from_parameters(
        control.tolist(), np.ones((b, a)).tolist(), ku.tolist(), kv.tolist(), mu.tolist(), mv.tolist(), DEGREE, DEGREE, False, False
    )
