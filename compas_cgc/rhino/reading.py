"""Read a .3dm file: what it holds, what that means, what was done to it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Optional
from typing import Union

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import FileError
from ..meshing import path_edges
from ..meshing.polyline import points_along
from .archive import read_archive
from .creases import read_creases
from .curves import curve_points
from .layers import layer_names
from .model import Model3dm
from .objects import Item
from .objects import list_items
from .selection import select
from .shell import read_shell
from .supports import item_points
from .supports import read_supports
from .targets import read_targets
from .targets import read_vertex_values
from .units import unit_name
from .units import unit_suffix

__all__ = ["read_model"]


def read_model(
    path: Union[str, os.PathLike],
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[float] = None,
) -> Model3dm:
    """Read a surface problem from a .3dm file.

    See ``docs/3dm.md`` for the layers. Without any of them the first mesh is read, points
    as supports and curves as creases.

    Parameters
    ----------
    path
        The .3dm file, of any Rhino from version 2 on.
    layers
        Names of layers by role, see :func:`compas_cgc.rhino.layer_names`.
    crease
        What to do with a crease that does not follow mesh edges: ``"trace"`` takes the
        best path of edges, ``"split"`` cuts the mesh along it.
    tolerance
        Distance within which points are one [L]. Default: the file's.

    Returns
    -------
    Model3dm
        What cannot be used is listed in its ``problems``, and refused by ``to_cgcmesh()``.

    Raises
    ------
    FileError
        If the file cannot be read or holds no usable mesh.
    """
    names = layer_names(path, layers)
    archive = read_archive(path)
    selection = select(list_items(archive), names)
    units = unit_name(archive.Settings.ModelUnitSystem)
    unit = unit_suffix(units)
    own = float(archive.Settings.ModelAbsoluteTolerance)
    reach = tolerance if tolerance is not None else own if np.isfinite(own) and own > 0 else 0.0
    try:
        shell = read_shell(selection.mesh, reach, unit)
    except FileError as error:
        raise FileError(f"{path}: {error}") from None
    size = float(np.linalg.norm(np.ptp(shell.vertices, axis=0)))
    # Points drawn by snapping are off by rounding: that of single precision, or of transforms.
    snap = max(reach, 4.0 * shell.rounding, 1e-9 * size)
    supports, support_notes, support_problems = read_supports(selection.supports, shell.vertices, snap, unit)
    creases = read_creases(selection.creases, shell, supports, snap, crease, unit)
    shell = creases.shell
    edges = np.array(path_edges(creases.paths), dtype=np.int64).reshape(-1, 2)
    targets, target_notes, target_problems = read_targets(selection.targets, selection.mesh, selection.regions, shell, edges, unit)
    values = {"target": targets, "s": creases.s, "e": creases.e}
    for name, written in read_vertex_values(selection.mesh, shell).items():
        values[name] = np.where(np.isfinite(written), written, values[name])
    return Model3dm(
        name=Path(path).stem,
        vertices=shell.vertices,
        faces=shell.faces,
        supports=supports,
        creases=tuple(creases.paths),
        targets=values["target"],
        s=values["s"],
        e=values["e"],
        constraints=tuple(_constraint(item, shell.vertices, snap) for item in selection.constraints),
        units=units,
        tolerance=own,
        notes=tuple(selection.notes + shell.notes + support_notes + creases.notes + target_notes),
        problems=tuple(support_problems + creases.problems + target_problems),
    )


def _constraint(item: Item, vertices: FloatArray, tolerance: float) -> dict:
    """Return a constraint as plain data: where it is, which vertices lie on it, and its user text."""
    if item.kind == "curve":
        points = curve_points(item.geometry, tolerance)
        on = points_along(vertices, points, tolerance) if len(points) > 1 else np.empty(0, np.int64)
    else:
        points = item_points(item)
        on = points_along(vertices, np.repeat(points[:1], 2, axis=0), tolerance)
    return {"kind": item.kind, "points": points.tolist(), "vertices": on.tolist(), "text": dict(item.text)}
