"""A mesh where the file has curves only."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing.outline import mesh_from_outline
from .curves import curve_points
from .layers import Selection
from .sketch import Part

__all__ = ["outline_part"]


def outline_part(found: Selection, edge_length: Optional[float], tolerance: float) -> tuple[Part, list[str]]:
    """Return a mesh between outlines and creases, and notes.

    The outline that encloses most is the boundary, the others are holes.

    Parameters
    ----------
    found
        What the file holds.
    edge_length
        Length of edges aimed at [L], or None if no mesh was asked for.
    tolerance
        Absolute tolerance of the file [L].

    Raises
    ------
    FileError
        If there is no outline, no edge length, or no mesher.
    """
    if edge_length is None or not found.outlines:
        mend = "make one with Rhino's command Mesh or QuadRemesh, and save the file again"
        if found.outlines:
            mend += "; or give an edge length (--edge-length) to mesh the outline"
        raise FileError(f"there is no mesh in the file; {mend}")
    fine = 0.25 * tolerance if tolerance > 0 else 1e-4 * edge_length
    curves = [curve_points(item.geometry, fine) for item in found.outlines]
    open_ = [item.label for item, points in zip(found.outlines, curves) if len(points) < 4 or (points[0] != points[-1]).any()]
    if open_:
        raise FileError(f"outline {open_[0]} is not closed; close it (Rhino: CloseCrv)")
    boundary, *holes = sorted(curves, key=lambda points: -_area(points))
    creases = [points for points in (curve_points(item.geometry, fine) for item in found.creases) if len(points) > 1]
    try:
        made = mesh_from_outline(boundary, holes, creases, edge_length, tolerance)
    except MeshError as error:
        raise FileError(str(error)) from None
    label = f"the mesh in {found.outlines[0].label}"
    faces = np.column_stack([made.faces, made.faces[:, 2]])
    note = f"there is no mesh in the file; one with edges of about {edge_length:g} was made in {len(curves)} outlines"
    return Part(label, made.vertices, faces, 0.0, None, {}), [note]


def _area(points: FloatArray) -> float:
    x, y = points[:-1, 0], points[:-1, 1]
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
