"""Meshing of files that hold curves only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing.chains import chains
from ...meshing.outline import Outlined
from ...meshing.outline import mesh_from_outline
from ...meshing.outline import own_plane
from ...meshing.polyline import arc_lengths
from ...meshing.polyline import nearest_on_polyline
from ...meshing.polyline import point_at
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
FOLLOWING = np.array([1.0, 1.0, np.nan])  # factor of curves whose heights are not known


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
    bounds, folds = [ring for ring, _ in lifted], [crease.points for crease in lines]
    if count and np.ptp(np.concatenate([*rings, *folds])[:, 2]) <= COINCIDENCE * edge_length:
        # The heights of a plan mean nothing once its supports have others: curves without supports follow the surface between them.
        bounds = [ring if number else ring * FOLLOWING for ring, number in lifted]
        folds = [points * FOLLOWING for points in folds]
    parts = _parts(bounds)
    meshes = [mesh_from_outline(own[0], own[1:], folds, edge_length, tolerance, columns) for own in parts]
    made = _together(meshes)
    faces = np.column_stack([made.faces, made.faces[:, 2]])
    holes = len(rings) - len(parts)
    within = f" and {counted(holes, 'hole')}" if holes else ""
    whole = "an outline" if len(parts) == 1 else f"{len(parts)} outlines"
    note = f"a mesh with edges of about {edge_length:g} was generated from {whole}{within}"
    twice = ["duplicate outlines were used once"] if len(rings) < len(drawn) else []
    if count:
        twice.append(f"the outline was moved to the height of the support above or below it at {counted(count, 'place')}")
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
    for ring in sorted(rings, key=lambda points: -shapely.Polygon(points[:, :2]).area):
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
    """Return an outline (k, 3) through the points exactly above or below it, and the number of places that were moved.

    Heights change evenly between such points, and between them and other corners, which stay. Sides beside a corner are longer than
    an edge; shorter ones are parts of a curve.
    """
    arcs, reach = arc_lengths(ring[:, :2]), COINCIDENCE * edge_length
    distance, at = nearest_on_polyline(columns[:, :2], ring[:, :2])
    at, first = np.unique(at[distance <= reach], return_index=True)
    rise = columns[distance <= reach, 2][first] - np.interp(at, arcs, ring[:, 2])
    count = int(np.count_nonzero(np.abs(rise) > reach))
    if not count:
        return ring, 0
    ahead = np.diff(arcs)
    corners = arcs[:-1][np.minimum(ahead, np.roll(ahead, 1)) > edge_length]
    stay = corners[_apart(corners, at, arcs[-1]) > reach]
    places = np.sort(np.concatenate([arcs, at[_apart(at, arcs, arcs[-1]) > reach]]))
    moved = point_at(ring, places) if len(places) > len(ring) else ring.copy()
    moved[:, 2] += np.interp(places, np.concatenate([at, stay]), np.concatenate([rise, 0.0 * stay]), period=arcs[-1])
    return moved, count


def _apart(positions: FloatArray, others: FloatArray, period: float) -> FloatArray:
    """Return the distances of arc lengths (n,) from the nearest of others (m,) along a closed curve."""
    off = np.abs(positions[:, None] - others)
    return np.minimum(off, period - off).min(axis=1, initial=np.inf)


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
