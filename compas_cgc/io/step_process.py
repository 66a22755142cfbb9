"""Reading of a STEP file by OpenCASCADE in a process of its own: one untrimmed surface, or the triangles of all faces."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from typing import Optional

import numpy as np

from ..errors import CGCError
from ..errors import FileError
from .cursor import guarded
from .occt import BSPLINE
from .occt import EDGE
from .occt import FACE
from .occt import opencascade

__all__ = ["TOLERANCE", "contents_of_step", "main"]

TOLERANCE = 1e-4  # of the surface fitted to triangles of trimmed faces, relative to the size
# Largest distance of these triangles from their faces. With twice as much, fits deviate more than TOLERANCE between the vertices;
# with half as much, OpenCASCADE takes two to five times longer.
DEFLECTION = TOLERANCE
COARSE = 20.0  # deflection of a first division, relative to that of the second
MAX_TRIANGLES = 40_000  # about as many as the second division may have; they take a second
# Largest angle between adjacent triangles [rad]. Smaller ones divide the same faces alike, but spikes, as of one misplaced control point,
# far below the deflection.
ANGLE = 0.5
ON_SIDE = 1e-6  # distance of an edge from a side of its surface, relative to the range of the parameters
EDGE_POINTS = 9
UNDIVIDED = "OpenCASCADE cannot divide all faces of the file into triangles; repair its faces and export it again"


def main() -> None:
    """Read the STEP file of the first argument, and write its contents, or the reason why it cannot be read, to that of the second.

    The third argument is the longest processor time [s], at which the system ends the process; the fourth is the largest memory [bytes].
    """
    path, result = map(Path, sys.argv[1:3])
    if sys.platform != "win32":
        import resource

        signal.setitimer(signal.ITIMER_PROF, float(sys.argv[3]))
        resource.setrlimit(resource.RLIMIT_DATA, (int(sys.argv[4]), int(sys.argv[4])))
    try:
        contents: dict[str, Any] = contents_of_step(path)
    except CGCError as error:
        contents = {"reason": np.array(str(error))}
    with open(result, "wb") as file:
        np.savez(file, **contents)


def contents_of_step(path: Path) -> dict[str, np.ndarray]:
    """Return the contents of a STEP file, in millimetres.

    Returns
    -------
    dict
        ``tolerance`` of the design, and either ``control`` (a, b, 4), ``u``, ``v`` and ``degrees`` of an untrimmed surface, with
        homogeneous control points and knots, or ``vertices`` (n, 3) and ``triangles`` (m, 3) of all faces, which share no vertices.

    Raises
    ------
    FileError
        If the file cannot be read or holds no faces, or if the package that reads STEP files is not installed.
    """
    occt = opencascade()
    try:
        shape = occt.read_step(str(path))
        faces = occt.shape_explore(shape, FACE)
    except Exception as error:
        raise FileError(f"{path} cannot be read as a STEP file; export it again, as AP214 or AP242 ({error!s:.80})") from None
    if not faces:
        raise FileError(f"{path} holds no faces; export the design as surfaces, not as curves or meshes")
    with guarded(path):
        spline = _spline(occt, faces[0]) if len(faces) == 1 else None
        if spline is not None:
            return {**spline, "tolerance": np.array(TOLERANCE * _diagonal(np.array(occt.aabb(shape, True))))}
        # Dividing faces between edges that do not fit to them can take minutes.
        if not occt.is_valid(shape):
            raise FileError(
                f"{path} holds faces that are not valid, such as ones with edges off their surfaces; repair them and export again"
            )
        return _triangles(occt, occt.sew(shape) if len(faces) > 1 else shape)


def _spline(occt: Any, face: Any) -> Optional[dict[str, np.ndarray]]:
    """Return the surface of an untrimmed face, None for others."""
    if int(occt.face_type(face)) != BSPLINE:
        return None
    surface = occt.face_to_bspline(face)
    if occt.surface_is_periodic_u(surface) or occt.surface_is_periodic_v(surface):
        return None
    bounds = np.array(occt.surface_bounds(surface)).reshape(2, 2)
    span = np.ptp(bounds, axis=1)
    for edge in occt.shape_explore(face, EDGE):
        start, end = occt.edge_domain(edge)
        curve = occt.edge_to_bspline(edge)
        found = [occt.surface_closest_point(surface, occt.curve_point_at(curve, t)) for t in np.linspace(start, end, EDGE_POINTS)]
        uv = np.array([place[1:] for place in found])
        if not (np.abs(uv[:, :, None] - bounds) <= ON_SIDE * span[:, None]).all(axis=0).any():
            return None
    points, weights = np.array(occt.nurbssurface_poles2(surface)), np.array(occt.nurbssurface_weights2(surface))
    control = np.concatenate([points * weights[..., None], weights[..., None]], axis=-1)
    u = _knots(occt.nurbssurface_uknots, occt.nurbssurface_umults, surface)
    v = _knots(occt.nurbssurface_vknots, occt.nurbssurface_vmults, surface)
    degrees = (occt.nurbssurface_degree_u(surface), occt.nurbssurface_degree_v(surface))
    if control.shape[0] != len(u) - degrees[0] - 1:
        control = control.swapaxes(0, 1)
    return {"control": np.ascontiguousarray(control), "u": u, "v": v, "degrees": np.array(degrees)}


def _knots(knots: Callable, times: Callable, surface: Any) -> np.ndarray:
    return np.repeat(np.array(knots(surface), float), np.array(times(surface), int))


def _triangles(occt: Any, shape: Any) -> dict[str, np.ndarray]:
    """Return the vertices and triangles of all faces.

    A first division gives the size, which poles off the surface do not change, and predicts the number of triangles: as many per area of
    the same curvature as the deflection is smaller. Where there would be too many, as on spikes or for very many waves, the second
    division is coarser.
    """
    first = COARSE * DEFLECTION * _diagonal(np.array(occt.aabb(shape, False)))
    # A copy does not pass its triangles on.
    points, corners, _ = occt.tesselate(occt.copy(shape), first, ANGLE)
    if not len(points) or not np.isfinite(points).all():
        raise FileError(UNDIVIDED)
    size = _diagonal(np.array(points))
    deflection = max(DEFLECTION * size, first * len(corners) / MAX_TRIANGLES)
    # OpenCASCADE leaves out faces without a word where it fails, as for lack of memory.
    if not all(len(occt.tesselate(face, deflection, ANGLE)[1]) for face in occt.shape_explore(shape, FACE)):
        raise FileError(UNDIVIDED)
    # The shape keeps the triangles of its faces.
    points, corners, _ = occt.tesselate(shape, deflection, ANGLE)
    vertices = np.asarray(points, float).reshape(-1, 3)
    if not np.isfinite(vertices).all():
        raise FileError(UNDIVIDED)
    return {
        "vertices": vertices,
        "triangles": np.asarray(corners, np.int64).reshape(-1, 3),
        "tolerance": np.array(max(TOLERANCE * size, deflection)),
    }


def _diagonal(points: np.ndarray) -> float:
    """Return the diagonal of the box around points (n, 3)."""
    return float(np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)))
