"""A mesh where the file has curves only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing.outline import Outlined
from ...meshing.outline import mesh_from_outline
from ...meshing.polyline import nearest_on_polyline
from .archive import Item
from .curves import curve_points
from .curves import to_drawn
from .layers import Selection
from .sketch import Drawn
from .sketch import Part
from .surfaces import MeshedSurface
from .user_text import user_target

__all__ = ["outline_part"]


def outline_part(found: Selection, edge_length: Optional[float], tolerance: float) -> MeshedSurface:
    """Return a mesh between outlines and creases, with vertices at the supports and the creases as its edges follow them.

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
    creases = [(item, points) for item, points in ((item, curve_points(item.geometry, fine)) for item in found.creases) if len(points) > 1]
    columns = [to_drawn(item, fine).points for item in found.supports if item.kind in ("point", "point cloud")]
    try:
        made = mesh_from_outline(
            boundary, holes, [points for _, points in creases], edge_length, tolerance, np.concatenate([np.empty((0, 3)), *columns])
        )
    except MeshError as error:
        raise FileError(str(error)) from None
    label = f"the mesh in {found.outlines[0].label}"
    faces = np.column_stack([made.faces, made.faces[:, 2]])
    note = f"there is no mesh in the file; one with edges of about {edge_length:g} was made in {len(curves)} outlines"
    return MeshedSurface(Part(label, made.vertices, faces, 0.0, None, {}), _pieces(made, creases), [note])


def _pieces(made: Outlined, creases: Sequence[tuple[Item, FloatArray]]) -> list[Drawn]:
    """Return what lies of the creases within the outline, along edges."""
    flat = [points * [1.0, 1.0, 0.0] for _, points in creases]
    drawn = []
    for path in made.creases:
        line = made.vertices[path]
        gaps = [nearest_on_polyline(line * [1.0, 1.0, 0.0], curve)[0].max() for curve in flat]
        item = creases[int(np.argmin(gaps))][0]
        drawn.append(Drawn(item.label, "curve", line, user_target(item.text), item.text))
    return drawn


def _area(points: FloatArray) -> float:
    x, y = points[:-1, 0], points[:-1, 1]
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
