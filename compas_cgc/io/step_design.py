"""Finished designs of STEP files: one untrimmed surface, or the triangles of all faces."""

from __future__ import annotations

import math
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from typing import Optional
from typing import Union

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..errors import FileError
from .cursor import guarded
from .opencascade import EDGE
from .opencascade import FACE
from .opencascade import opencascade
from .rhino.designs import DrawnDesign
from .rhino.designs import DrawnSpline

__all__ = ["main", "read_step_design"]

TOLERANCE = 1e-4  # of the surface fitted to triangles of trimmed faces, relative to the size
# Largest distance of these triangles from their faces. With twice as much, fits deviate more than TOLERANCE between the vertices;
# with half as much, OpenCASCADE takes two to five times longer.
DEFLECTION = TOLERANCE
ANGLES = (0.1, 0.5)  # largest angle between adjacent triangles, usually and beside spikes [rad]
COARSE = 20.0  # deflection of a first division, relative to that of the second
MAX_GROWTH = 2.0  # of the number of triangles of the first division by a small angle, beyond which there are spikes
COINCIDENCE = 1e-7  # distance within which points of neighbouring faces coincide, relative to the size
ON_SIDE = 1e-6  # distance of an edge from a side of its surface, relative to the range of the parameters
EDGE_POINTS = 9
SECONDS, SECONDS_PER_BYTE = 5.0, 20e-6  # longest processor time of reading; 2 s is the most that a valid design took
MEMORY, MEMORY_PER_BYTE = 2**30, 100  # largest memory of reading [bytes]; 0.47 GB is the most that a valid design took
PATIENCE = 20.0  # longest time by the clock, relative to the processor time, as on a busy computer
_OUT_OF_TIME = getattr(signal, "SIGXCPU", 0)  # ends a process that has used its processor time


def read_step_design(path: Union[str, os.PathLike]) -> DrawnDesign:
    """Read a design from a STEP file, in millimetres.

    An untrimmed surface is read exactly; other faces are sewn and divided into triangles. A damaged file can make OpenCASCADE crash or
    divide faces for minutes into gigabytes, so it runs in a process of its own with limits of its processor time and memory.

    Parameters
    ----------
    path
        The .step or .stp file.

    Raises
    ------
    FileError
        If the file cannot be read or holds no faces, or if the package that reads STEP files is not installed.
    """
    opencascade()
    path = Path(path)
    if not path.is_file():
        raise FileError(f"there is no file {path}")
    if not Path(sys.executable or "").stem.lower().startswith("python"):
        # Within another program, such as Rhino, there may be no interpreter to start.
        return _read(path)
    size = path.stat().st_size
    limit, memory = SECONDS + SECONDS_PER_BYTE * size, MEMORY + MEMORY_PER_BYTE * size
    slow = FileError(f"{path} takes more than {limit:.0f} s to read; repair its faces, or export fewer of them")
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "design"
        try:
            done = subprocess.run(
                [sys.executable, "-c", "from compas_cgc.io.step_design import main; main()", *map(str, (path, result, limit, memory))],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                timeout=PATIENCE * limit,
            )
        except subprocess.TimeoutExpired:
            waited = f"{PATIENCE * limit:.0f} s"
            raise FileError(f"{path} was not read within {waited}, as this computer is too busy; try again later") from None
        if done.returncode == -_OUT_OF_TIME:
            raise slow
        if done.returncode:
            raise FileError(f"{path} cannot be read, as OpenCASCADE fails on it; repair its faces and export it again")
        found = pickle.loads(result.read_bytes())
    if isinstance(found, str):
        raise FileError(found)
    return found


def main() -> None:
    """Read the design in the file of the first argument, and write it, or the reason why it cannot be read, to that of the second.

    The third argument is the longest processor time [s], at which the system ends the process; the fourth is the largest memory [bytes].
    """
    path, result = map(Path, sys.argv[1:3])
    opencascade()
    if sys.platform != "win32":
        import resource

        limit, memory = math.ceil(time.process_time() + float(sys.argv[3])), int(sys.argv[4])
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))
        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
    found: Union[DrawnDesign, str]
    try:
        found = _read(path)
    except CGCError as error:
        found = str(error)
    result.write_bytes(pickle.dumps(found))


def _read(path: Path) -> DrawnDesign:
    occt = opencascade()
    try:
        shape = occt.read_step(str(path))
        faces = occt.shape_explore(shape, FACE)
    except Exception as error:
        raise FileError(f"{path} cannot be read as a STEP file; export it again, as AP214 or AP242 ({error!s:.80})") from None
    if not faces:
        raise FileError(f"{path} holds no faces; export the design as surfaces, not as curves or meshes")
    with guarded(path):
        low, high = (np.array(corner) for corner in occt.aabb(shape, True))
        size = float(np.linalg.norm(high - low))
        spline = _spline(occt, faces[0]) if len(faces) == 1 else None
        vertices, triangles = np.empty((0, 3)), np.empty((0, 4), np.int64)
        if spline is None:
            # Dividing faces between edges that do not fit to them can take minutes.
            if not occt.is_valid(shape):
                raise FileError(
                    f"{path} holds faces that are not valid, such as ones with edges off their surfaces; repair them and export again"
                )
            vertices, triangles = _triangles(occt, occt.sew(shape) if len(faces) > 1 else shape, size)
        return DrawnDesign(spline, vertices, triangles, [], [], "Millimeters", TOLERANCE * size, [])


def _spline(occt: Any, face: Any) -> Optional[DrawnSpline]:
    """Return the surface of an untrimmed face, None for others."""
    surface = occt.face_to_bspline(face)
    if surface is None or occt.surface_is_periodic_u(surface) or occt.surface_is_periodic_v(surface):
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
    return DrawnSpline(np.ascontiguousarray(control), (u, v), degrees)


def _knots(knots: Callable, times: Callable, surface: Any) -> FloatArray:
    return np.repeat(np.array(knots(surface), float), np.array(times(surface), int))


def _triangles(occt: Any, shape: Any, size: float) -> tuple[FloatArray, IntArray]:
    """Return the vertices and triangles, with a repeated last corner, of all faces; their common points are merged."""
    deflection, angle = DEFLECTION * size, _angle(occt, shape, size)
    # OpenCASCADE leaves out faces without a word where it fails, as for lack of memory.
    if not all(len(occt.tesselate(face, deflection, angle)[1]) for face in occt.shape_explore(shape, FACE)):
        raise FileError("OpenCASCADE cannot divide all faces of the file into triangles; repair its faces and export it again")
    # The shape keeps the triangles of its faces.
    points, corners, _ = occt.tesselate(shape, deflection, angle)
    V = np.asarray(points, float).reshape(-1, 3)
    F = np.asarray(corners, np.int64).reshape(-1, 3)
    first = np.arange(len(V))
    for one, other in cKDTree(V).query_pairs(COINCIDENCE * size, output_type="ndarray"):
        first[max(one, other)] = min(first[one], first[other])
    used, F = np.unique(first[first][F], return_inverse=True)
    F = F.reshape(-1, 3)
    F = F[(F != np.roll(F, 1, axis=1)).all(axis=1)]
    return V[used], np.column_stack([F, F[:, 2]])


def _angle(occt: Any, shape: Any, size: float) -> float:
    """Return the largest angle between adjacent triangles [rad].

    A small angle divides spikes, as of one misplaced control point, far below the deflection, which takes seconds for each.
    """
    small, wide = ANGLES
    # A copy has no triangles, which would be used again.
    few, many = (len(occt.tesselate(occt.copy(shape), COARSE * DEFLECTION * size, angle)[1]) for angle in (wide, 2 * small))
    return wide if many > MAX_GROWTH * few else small
