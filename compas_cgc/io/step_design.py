"""Finished designs of STEP files: one untrimmed surface, or the triangles of all faces."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any
from typing import Optional
from typing import Union

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import FileError
from .cursor import guarded
from .opencascade import EDGE
from .opencascade import FACE
from .opencascade import opencascade
from .rhino.designs import DrawnDesign
from .rhino.designs import DrawnSpline

__all__ = ["read_step_design"]

DEFLECTION = 5e-5  # of triangles from trimmed faces, relative to the size
TOLERANCE = 1e-4  # of the surface fitted to these triangles, relative to the size
ANGLE = 0.1  # largest angle between adjacent triangles [rad]
COINCIDENCE = 1e-7  # distance within which points of neighbouring faces coincide, relative to the size
ON_SIDE = 1e-6  # distance of an edge from a side of its surface, relative to the range of the parameters
EDGE_POINTS = 9


def read_step_design(path: Union[str, os.PathLike]) -> DrawnDesign:
    """Read a design from a STEP file, in millimetres.

    An untrimmed surface is read exactly; other faces are sewn and divided into triangles.

    Parameters
    ----------
    path
        The .step or .stp file.

    Raises
    ------
    FileError
        If the file cannot be read or holds no faces, or if the package that reads STEP files is not installed.
    """
    occt = opencascade()
    if not Path(path).is_file():
        raise FileError(f"there is no file {path}")
    try:
        shape = occt.read_step(str(path))
        faces = occt.shape_explore(shape, FACE)
    except Exception as error:
        raise FileError(f"{path} cannot be read as a STEP file; export it again, as AP214 or AP242 ({error!s:.80})") from None
    if not faces:
        raise FileError(f"{path} holds no faces; export the design as surfaces, not as curves or meshes")
    with guarded(Path(path)):
        low, high = (np.array(corner) for corner in occt.aabb(shape, True))
        size = float(np.linalg.norm(high - low))
        spline = _spline(occt, faces[0]) if len(faces) == 1 else None
        vertices, triangles = np.empty((0, 3)), np.empty((0, 4), np.int64)
        if spline is None:
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
    points, corners, _ = occt.tesselate(shape, DEFLECTION * size, ANGLE)
    V = np.asarray(points, float).reshape(-1, 3)
    F = np.asarray(corners, np.int64).reshape(-1, 3)
    first = np.arange(len(V))
    for one, other in cKDTree(V).query_pairs(COINCIDENCE * size, output_type="ndarray"):
        first[max(one, other)] = min(first[one], first[other])
    used, F = np.unique(first[first][F], return_inverse=True)
    F = F.reshape(-1, 3)
    F = F[(F != np.roll(F, 1, axis=1)).all(axis=1)]
    return V[used], np.column_stack([F, F[:, 2]])
