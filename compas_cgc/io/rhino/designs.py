"""Finished designs of a .3dm file: one surface, its supports and its seams."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...model.problem import Drawing
from ..cursor import guarded
from .archive import Item
from .archive import list_items
from .archive import read_archive
from .archive import rhino3dm_module
from .archive import size_of
from .curves import EDGE_ACCURACY
from .curves import curve_points
from .layers import LayerNames
from .layers import drawing_or_result
from .meshes import has_mesh
from .meshes import to_part
from .parametric import ParametricSurface
from .surfaces import surface_part
from .units import north_of
from .units import unit_name

__all__ = ["DrawnDesign", "DrawnSpline", "read_all_curves", "read_drawn_design"]

LAYERS = ("design", "mesh", "surface")  # last names of layers for a design; the first with a surface is used
SUPPORTS, SEAMS = "supports", "seams"
FINE = 100  # number of edges along the diagonal of a design that is meshed before fitting


class DrawnSpline(NamedTuple):
    """An untrimmed NURBS surface."""

    control: FloatArray  # (a, b, 4) homogeneous control points [L]
    knots: tuple[FloatArray, FloatArray]
    degrees: tuple[int, int]


class DrawnDesign(NamedTuple):
    """Contents of a design file."""

    spline: Optional[DrawnSpline]  # None for a trimmed surface or a mesh
    vertices: FloatArray  # (n, 3) vertices of its mesh [L], empty for a spline
    faces: IntArray  # (m, 4), triangles repeat the last corner
    supports: list[FloatArray]  # (k, 3) points, or points along curves [L]
    seams: list[FloatArray]  # (k, 3) points along curves [L]
    units: Optional[str]
    tolerance: float  # [L]
    notes: list[str]
    north: tuple[float, float] = Drawing().north  # direction in plan


def read_drawn_design(path: Union[str, os.PathLike], seams: Optional[str] = None) -> DrawnDesign:
    """Read a design from a .3dm file.

    The design is on a layer ``Design``, ``Mesh`` or ``Surface``, or else the only surface in the file. Points and curves on a
    layer ``Supports`` are supports, and curves on a layer ``Seams`` are seams.

    Parameters
    ----------
    path
        The .3dm file.
    seams
        Another layer for the seams.

    Raises
    ------
    FileError
        If the file cannot be read or holds no surface.
    """
    with guarded(Path(path)):
        return _drawn_design(path, seams)


def _drawn_design(path: Union[str, os.PathLike], seams: Optional[str]) -> DrawnDesign:
    archive = read_archive(path)
    items, _, said = drawing_or_result([item for item in list_items(archive) if not item.hidden], LayerNames())
    tolerance = float(archive.Settings.ModelAbsoluteTolerance)
    surfaces = _surfaces(items)
    if not surfaces:
        raise FileError(f"{path} holds no surface; put the design, a NURBS surface, polysurface, SubD or mesh, on a layer named Design")
    on_seams = [item for item in items if _last(item.layer) == (seams or SEAMS).casefold()]
    lines = [curve_points(item.geometry, tolerance, EDGE_ACCURACY) for item in on_seams if item.kind == "curve"]
    if seams is not None and not lines:
        raise FileError(f"{path}: there are no curves on the layer {seams!r}; draw the seams on it, or choose another layer")
    held = [_places(item, tolerance) for item in items if _last(item.layer) == SUPPORTS and item.kind in ("curve", "point", "point cloud")]
    spline = _spline(surfaces[0].geometry) if len(surfaces) == 1 else None
    units, north = unit_name(archive.Settings.ModelUnitSystem), north_of(archive)
    if spline is not None:
        return DrawnDesign(spline, np.empty((0, 3)), np.empty((0, 4), np.int64), held, lines, units, tolerance, said, north)
    # A damaged mesh is refused before the surfaces beside it are meshed, which takes seconds.
    drawn = {k: to_part(item) for k, item in enumerate(surfaces) if item.kind == "mesh"}
    parts, notes = zip(*(drawn[k] if k in drawn else _meshed(item, surfaces, tolerance) for k, item in enumerate(surfaces)))
    counts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    vertices = np.concatenate([part.vertices for part in parts])
    faces = np.concatenate([part.faces + count for part, count in zip(parts, counts)])
    return DrawnDesign(None, vertices, faces, held, lines, units, tolerance, [*said, *(note for own in notes for note in own)], north)


def read_all_curves(path: Union[str, os.PathLike]) -> list[FloatArray]:
    """Return all visible curves of a file, each as points (k, 3) within the file's tolerance [L].

    Raises
    ------
    FileError
        If the file cannot be read or holds no curves.
    """
    with guarded(Path(path)):
        archive = read_archive(path)
        items = [item for item in list_items(archive) if item.kind == "curve" and not item.hidden]
        if not items:
            raise FileError(f"{path} holds no curves; draw the seams in it")
        return [curve_points(item.geometry, float(archive.Settings.ModelAbsoluteTolerance)) for item in items]


def _last(layer: str) -> str:
    return layer.rpartition("::")[2].casefold()


def _surfaces(items: Sequence[Item]) -> list[Item]:
    others = ("curve", "point", "point cloud", "text dot")
    surfaces = [item for item in items if item.kind not in others]
    for name in LAYERS:
        named = [item for item in surfaces if _last(item.layer) == name]
        if named:
            return named
    return surfaces


def _places(item: Item, tolerance: float) -> FloatArray:
    if item.kind == "curve":
        return curve_points(item.geometry, tolerance)
    if item.kind == "point":
        place = item.geometry.Location
        return np.array([[place.X, place.Y, place.Z]])
    return np.array([(p.X, p.Y, p.Z) for p in item.geometry.GetPoints()]).reshape(-1, 3)


def _meshed(item: Item, surfaces: Sequence[Item], tolerance: float) -> tuple[Any, list[str]]:
    try:
        made = surface_part(item, size_of(*(other.geometry for other in surfaces)) / FINE, tolerance)
        return made.part, made.notes
    except FileError:
        if not has_mesh(item):
            raise
        return to_part(item)


def _spline(geometry: Any) -> Optional[DrawnSpline]:
    """Return the NURBS form of an untrimmed surface, None for others."""
    rhino3dm = rhino3dm_module()
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(True)
    if isinstance(geometry, rhino3dm.Brep):
        if len(geometry.Faces) != 1 or not _untrimmed(geometry):
            return None
        geometry = geometry.Faces[0].UnderlyingSurface()
    if not isinstance(geometry, rhino3dm.Surface):
        return None
    nurbs = geometry.ToNurbsSurface()
    if nurbs is None:
        return None
    net = [[nurbs.Points[i, j] for j in range(nurbs.Points.CountV)] for i in range(nurbs.Points.CountU)]
    control = np.array([[(p.X, p.Y, p.Z, p.W) for p in row] for row in net])
    # openNURBS omits the first and the last knot.
    own = [np.array([knots[k] for k in range(len(knots))]) for knots in (nurbs.KnotsU, nurbs.KnotsV)]
    u, v = (np.concatenate([knots[:1], knots, knots[-1:]]) for knots in own)
    return DrawnSpline(control, (u, v), (nurbs.Degree(0), nurbs.Degree(1)))


def _untrimmed(brep: Any) -> bool:
    """Check whether the only loop of a face is the boundary of its surface."""
    face = brep.Faces[0]
    if len(face.Loops) != 1:
        return False
    surface = ParametricSurface(face.UnderlyingSurface())
    span = np.ptp(surface.domain, axis=1)
    reach = 1e-6 * size_of(brep)
    for edge in brep.Edges:
        uv = surface.pulled_back(curve_points(edge, reach), reach)
        sides = (np.abs(uv[:, :, None] - surface.domain) <= 1e-6 * span[:, None]).all(axis=0)
        if not sides.any():
            return False
    return True
