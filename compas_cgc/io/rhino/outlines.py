"""Meshing of files that hold curves only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing.chains import chains
from ...meshing.outline import Outlined
from ...meshing.outline import mesh_from_outline
from ...meshing.outline import own_plane
from ...meshing.polyline import nearest_on_polyline
from ...model.counts import counted
from .curves import EDGE_ACCURACY
from .curves import curve_points
from .curves import to_drawn
from .layers import Selection
from .sketch import Drawn
from .sketch import Part
from .surfaces import MeshedSurface
from .user_text import user_law

__all__ = ["outline_part", "outlined"]

COINCIDENCE = 0.01  # distance below which outlines coincide, relative to the edge length


def outline_part(found: Selection, edge_length: Optional[float], tolerance: float) -> MeshedSurface:
    """Return a mesh bounded by outlines, with vertices at the supports and edges along the creases.

    Outlines inside others are holes.

    Parameters
    ----------
    found
        Objects of the file by role.
    edge_length
        Intended edge length [L], None if no mesh is requested.
    tolerance
        Absolute tolerance of the file [L].

    Raises
    ------
    FileError
        If the outline, the edge length or the mesher is missing.
    """
    if edge_length is None or not found.outlines:
        mend = "create one with Rhino's command Mesh or QuadRemesh, and save the file again"
        if found.outlines:
            mend += "; or give an edge length (--edge-length) to mesh the outline"
        elif found.creases:
            mend += "; or close an outline (Rhino: Join, CloseCrv) and give an edge length (--edge-length)"
        raise FileError(f"the file has no mesh; {mend}")
    fine = 0.25 * tolerance, EDGE_ACCURACY
    outlines = [(f"outline {item.label}", curve_points(item.geometry, *fine)) for item in found.outlines]
    creases = [Drawn(item.label, "curve", curve_points(item.geometry, *fine), user_law(item.text), item.text) for item in found.creases]
    columns = [to_drawn(item, *fine).points for item in found.supports if item.kind in ("point", "point cloud")]
    try:
        made = outlined(outlines, creases, np.concatenate([np.empty((0, 3)), *columns]), edge_length, tolerance)
    except MeshError as error:
        raise FileError(str(error)) from None
    label = f"the mesh in {found.outlines[0].label}"
    return made._replace(part=made.part._replace(label=label), notes=[f"the file has no mesh; {made.notes[0]}", *made.notes[1:]])


def outlined(
    outlines: Sequence[tuple[str, FloatArray]], creases: Sequence[Drawn], columns: FloatArray, edge_length: float, tolerance: float
) -> MeshedSurface:
    """Return a mesh bounded by outlines, with edges along creases.

    Parameters
    ----------
    outlines
        Names and points (k, 3) of closed curves, or of curves that meet end to end [L]; curves inside others are holes.
    creases
        Curves that become edges.
    columns
        ``(k, 3)`` points that become vertices [L].
    edge_length
        Intended edge length [L].
    tolerance
        Distance below which two points coincide [L].

    Raises
    ------
    MeshError
        If an outline is open or cannot be meshed.
    """
    drawn = _joined(outlines, tolerance)
    for name, points in drawn:
        gap = float(np.linalg.norm(points[0] - points[-1])) if len(points) > 3 else np.inf
        if gap > tolerance:
            missing = f" with a gap of {gap:.3g}" if np.isfinite(gap) else ""
            raise MeshError(f"{name} is open{missing}; close it (Rhino: CloseCrv), or draw the missing part")
    axes = own_plane(max((points for _, points in drawn), key=_area))
    if axes is not None:
        flat = outlined(
            [(name, points @ axes.T) for name, points in drawn],
            [crease._replace(points=crease.points @ axes.T) for crease in creases],
            columns @ axes.T,
            edge_length,
            tolerance,
        )
        part = flat.part._replace(vertices=flat.part.vertices @ axes)
        return flat._replace(part=part, creases=[crease._replace(points=crease.points @ axes) for crease in flat.creases])
    rings = _once(drawn, min(tolerance, COINCIDENCE * edge_length))
    lifted = [_lifted(ring, columns, edge_length) for ring in rings]
    count = sum(number for _, number in lifted)
    lines = [crease for crease in creases if len(crease.points) > 1]
    parts = _parts([ring for ring, _ in lifted])
    meshes = [mesh_from_outline(own[0], own[1:], [crease.points for crease in lines], edge_length, tolerance, columns) for own in parts]
    made = _together(meshes)
    faces = np.column_stack([made.faces, made.faces[:, 2]])
    holes = len(rings) - len(parts)
    within = f" and {counted(holes, 'hole')}" if holes else ""
    whole = "an outline" if len(parts) == 1 else f"{len(parts)} outlines"
    note = f"a mesh with edges of about {edge_length:g} was generated from {whole}{within}"
    twice = ["duplicate outlines were used once"] if len(rings) < len(drawn) else []
    if count:
        twice.append(f"{count} corner{'s were' if count > 1 else ' was'} moved to the height of the support above or below")
    beside = [
        f"{crease.label} lies outside the outline and was ignored"
        for crease in lines
        if all(_is_beside(own[0], crease.points) for own in parts)
    ]
    part = Part("the mesh in the outlines", made.vertices, faces, 0.0, None, {})
    return MeshedSurface(part, _pieces(made, lines), [note, *twice, *beside])


def _joined(outlines: Sequence[tuple[str, FloatArray]], tolerance: float) -> list[tuple[str, FloatArray]]:
    """Return outlines with open curves joined where two ends meet, each with the name of its first curve."""
    whole, pieces = list[tuple[str, FloatArray]](), list[tuple[str, FloatArray]]()
    for name, points in outlines:
        is_open = len(points) > 1 and float(np.linalg.norm(points[0] - points[-1])) > tolerance
        (pieces if is_open else whole).append((name, points))
    made = chains([points for _, points in pieces], tolerance)
    return [*whole, *((pieces[chain.curves[0]][0], chain.points) for chain in made)]


def _parts(rings: Sequence[FloatArray]) -> list[list[FloatArray]]:
    """Return the closed curves (k, 3) of every part of a roof, each with its boundary first; parts do not touch each other in plan."""
    import shapely

    parts = list[list[FloatArray]]()
    for ring in sorted(rings, key=lambda points: -_area(points)):
        around = next((own for own in parts if shapely.Polygon(own[0][:, :2]).intersects(shapely.LineString(ring[:, :2]))), None)
        if around is None:
            parts.append([ring])
        else:
            around.append(ring)
    return parts


def _together(meshes: Sequence[Outlined]) -> Outlined:
    """Return meshes as one."""
    first = np.cumsum([0, *(len(own.vertices) for own in meshes)])
    return Outlined(
        np.concatenate([own.vertices for own in meshes]),
        np.concatenate([own.faces + k for own, k in zip(meshes, first)]),
        [[int(vertex + k) for vertex in path] for own, k in zip(meshes, first) for path in own.creases],
    )


def _is_beside(boundary: FloatArray, points: FloatArray) -> bool:
    """Check whether a curve (k, 3) lies entirely outside a boundary (k, 3) in plan."""
    import shapely

    return not shapely.Polygon(boundary[:, :2]).intersects(shapely.LineString(points[:, :2]))


def _once(outlines: Sequence[tuple[str, FloatArray]], tolerance: float) -> list[FloatArray]:
    """Return the curves (k, 3) without duplicates."""
    kept: list[FloatArray] = []
    for _, points in outlines:
        if not any(
            nearest_on_polyline(points, other)[0].max() <= tolerance and nearest_on_polyline(other, points)[0].max() <= tolerance
            for other in kept
        ):
            kept.append(points)
    return kept


def _lifted(ring: FloatArray, columns: FloatArray, edge_length: float) -> tuple[FloatArray, int]:
    """Return an outline (k, 3) with corners at the height of points exactly above or below them, and the number of these corners.

    Sides beside a corner are longer than an edge; shorter ones are parts of a curve, on which one point would make a spike.
    """
    if not len(columns):
        return ring, 0
    corners, reach = ring[:-1].copy(), COINCIDENCE * edge_length
    distance, nearest = cKDTree(columns[:, :2]).query(corners[:, :2])
    ahead = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    moved = (distance <= reach) & (np.abs(columns[nearest, 2] - corners[:, 2]) > reach)
    moved &= np.minimum(ahead, np.roll(ahead, 1)) > edge_length
    if not moved.any():
        return ring, 0
    corners[moved, 2] = columns[nearest[moved], 2]
    return np.concatenate([corners, corners[:1]]), int(np.count_nonzero(moved))


def _pieces(made: Outlined, creases: Sequence[Drawn]) -> list[Drawn]:
    """Return the parts of the creases inside the outline, along edges."""
    flat = [crease.points * [1.0, 1.0, 0.0] for crease in creases]
    drawn = []
    for path in made.creases:
        line = made.vertices[path]
        gaps = [nearest_on_polyline(line * [1.0, 1.0, 0.0], curve)[0].max() for curve in flat]
        drawn.append(creases[int(np.argmin(gaps))]._replace(points=line))
    return drawn


def _area(points: FloatArray) -> float:
    """Return the area enclosed by a closed curve (k, 3) in the plane where it is largest."""
    away = points - points[0]
    return 0.5 * float(np.linalg.norm(np.cross(away[:-1], away[1:]).sum(axis=0)))
