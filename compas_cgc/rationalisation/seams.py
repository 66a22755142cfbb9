"""Seams on a design: a grid of its parameters, lines of curvature, geodesics, level lines of K, or curves that are drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional
from typing import Union

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from ..errors import MeshError
from ..meshing.polyline import resample_all
from ..model.lengths import place_text
from ..model.lengths import unit_suffix
from .creases import along_parameters
from .creases import beside_parameters
from .creases import continued
from .creases import held_on_creases
from .curve_panels import Lengths
from .curve_panels import curve_panels
from .curve_panels import parameter_rim
from .curve_panels import refuse_distorted
from .design import Design
from .grid_panels import grid_lines
from .grid_panels import grid_panels
from .level_seams import level_seams
from .panelling import Panelling
from .quad_panels import quad_panels
from .slivers import without_slivers
from .spline_surface import SplineSurface
from .streamlines import even_lines
from .unwrapping import contiguous

__all__ = ["LEVELS", "PANELS", "SeamsInput", "panels_of"]

EDGES, VERTICES = 4, 2500  # along the side of a panel at least by default, and of the whole mesh about
PANELS = 12  # along the longer side by default
LEVELS = (6, 5, 7)  # values of K between which level lines run; which of them is best depends on the design
AWAY = 2.0  # edges, within which a curve lies on the design
NEAR = 0.6  # of an edge, within which a seam that ends at the rim is led over it
OFFSETS = (0.0, 0.25, -0.25, 0.4)  # of the width of a panel, by which a grid is shifted off a rim that its lines graze
STILL = 1e-3  # of the largest step along a rim, below which a coordinate does not change
NARROW = 0.25  # of the width of a panel, below which a strip between a line and the rim is too narrow for a panel
GRAZING = "grazes"

LINES = ("curvature", "geodesics")
NAMED = ("grid", "levels", "faces", *LINES)

SeamsInput = Union[str, Sequence[Sequence[Sequence[float]]], None]


def panels_of(
    design: Design, panel: Optional[float], edges: Optional[int] = None, seams: SeamsInput = None, levels: int = LEVELS[0]
) -> Panelling:
    """Return the panels of a design, with a mesh whose edges follow the seams.

    Parameters
    ----------
    design
        The design.
    panel
        Width of the panels of a grid [L]. Default: a twelfth of the longer side.
    edges
        Edges along the side of a panel. Default: four, or more where panels are few.
    seams
        ``"grid"`` along the parameters, which are the plan where a mesh has one; ``"curvature"`` along lines of curvature, or
        ``"geodesics"``, one panel apart; ``"levels"`` along level lines of K; ``"faces"`` between the faces of a quad mesh; or
        points (k, 3) along curves on the design. Default: those drawn, else the grid.
    levels
        Number of values of K between which level lines run.

    Raises
    ------
    MeshError
        If the seams divide the design into no panels that can be meshed.
    """
    made = _panels(design, panel, edges, seams, levels)
    return held_on_creases(design.surface, made, design.creases)


def _panels(design: Design, panel: Optional[float], edges: Optional[int], seams: SeamsInput, levels: int) -> Panelling:
    width = _default_width(design) if panel is None else float(panel)
    if isinstance(seams, str) and seams not in NAMED:
        raise CGCError(f"seams must be {', '.join(map(repr, NAMED))} or curves, not {seams!r}")
    if seams == "faces":
        return _faces(design, edges)
    drawn = design.seams if seams is None else () if isinstance(seams, str) else tuple(np.asarray(line, dtype=np.float64) for line in seams)
    surface, rims = design.surface, list(design.rims) or [parameter_rim(design.surface)]
    if not len(drawn) and seams not in ("levels", *LINES):
        return _grid(design, width, edges)
    refuse_distorted(surface, rims)
    plane = Lengths.of(surface, rims)
    area = float(np.prod([own[-1] for own in plane.lengths]))
    edge = width / edges if edges is not None and panel is not None else float(np.sqrt(area / VERTICES))
    if seams in LINES:
        if any(surface.closed):
            raise MeshError(f"seams along {seams} need a design that does not close; use a grid, levels, or curves that are drawn")
        lines = even_lines(surface, str(seams), width, design.rims)
        edge = min(edge, width / (EDGES if edges is None else edges))
    elif seams == "levels":
        lines = level_seams(surface, levels, design.rims)
    else:
        lines = [_on_surface(design, plane, line, edge) for line in drawn]
    return _between(design, plane, [piece for line in lines for piece in _pieces(surface, line)], edge)


def _between(design: Design, plane: Lengths, pieces: list[FloatArray], edge: float) -> Panelling:
    """Return the panels between lines (k, 2) within the domain and the creases of a design."""
    surface, rims = design.surface, list(design.rims) or [parameter_rim(design.surface)]
    folds = [piece for line in design.creases for piece in _pieces(surface, line)]
    if folds:
        closed = [np.concatenate([rim, rim[:1]]) for rim in rims]
        pieces = [*pieces, *continued(plane, folds, [*pieces, *closed], edge)]
    pieces = [_over_rim(plane, rims, piece, edge) for piece in pieces]
    return curve_panels(surface, rims, without_slivers(surface, plane, rims, pieces, folds), edge)


def _faces(design: Design, edges: Optional[int]) -> Panelling:
    """Return the faces of a quad mesh as panels."""
    if design.quads is None:
        raise MeshError(
            "seams between faces need a design whose faces are all quads, as arrays, a COMPAS mesh or a mesh in a .3dm; "
            "use a grid, or draw the seams as curves"
        )
    corners, quads = design.quads
    return quad_panels(design.surface, corners, quads, _edges(len(quads)) if edges is None else edges)


def _edges(panels: int) -> int:
    """Return the number of edges along the side of a panel."""
    return max(EDGES, round(float(np.sqrt(VERTICES / panels))))


def _grid(design: Design, width: float, edges: Optional[int]) -> Panelling:
    """Return panels between lines of constant parameter, cut at the rim where the design is trimmed, and along its creases."""
    surface = design.surface
    whole, others = along_parameters(surface, design.creases)
    rims = list(design.rims) or [parameter_rim(surface)]
    plane = Lengths.of(surface, rims)
    near = beside_parameters(surface, plane, others, width)
    stops = [[value for own, value in whole + near if own == axis] for axis in range(2)]
    first, second = (grid_lines(surface, axis, width, stops[axis], design.rims) for axis in range(2))
    count = (len(first) - 1) * (len(second) - 1)
    number = _edges(count) if edges is None else edges
    if not design.trimmed and not others:
        return grid_panels(surface, (first, second), number)
    refuse_distorted(surface, rims)
    beside = [[value for own, value in near if own == axis] for axis in range(2)]
    kept = [values[1:-1][~np.isin(values[1:-1], beside[axis])] for axis, values in enumerate((first, second))]
    turns = [np.concatenate([_turning_values(plane.to_plane(rim)[:, axis]) for rim in rims]) for axis in range(2)]
    in_plane = [plane.to_plane(np.tile(values[:, None], 2))[:, axis] for axis, values in enumerate(kept)]
    for k, offsets in enumerate(zip(*(_offsets(*own) for own in zip(in_plane, turns)))):
        lines = []
        for axis, (values, offset) in enumerate(zip((first, second), offsets)):
            across = surface.domain[1 - axis]
            for value in kept[axis] + offset * np.diff(values).mean():
                line = np.empty((2, 2))
                line[:, axis], line[:, 1 - axis] = value, across
                lines.append(line)
        try:
            return _between(design, plane, lines, width / number)
        except MeshError as error:
            if GRAZING not in str(error) or k + 1 == len(OFFSETS):
                raise
    raise AssertionError


def _turning_values(along: FloatArray) -> FloatArray:
    """Return the values (t,) of a coordinate along a closed rim (k,) at which it stops: lines there run along the rim."""
    steps = np.diff(along, append=along[:1])
    steps[np.abs(steps) <= STILL * np.abs(steps).max(initial=0.0)] = 0.0
    return along[np.sign(steps) * np.sign(np.roll(steps, 1)) <= 0.0]


def _offsets(lines: FloatArray, turns: FloatArray) -> Sequence[float]:
    """Return the offsets of lines (k,) in the order in which they are tried: the one that leaves the widest strips first."""
    if len(lines) < 2 or not len(turns):
        return OFFSETS
    width = float(np.diff(lines).mean())
    strips = [float(np.abs(turns[:, None] - lines - offset * width).min()) / width for offset in OFFSETS]
    return OFFSETS if strips[0] >= NARROW else [OFFSETS[k] for k in np.argsort(-np.round(strips, 6), kind="stable")]


def _on_surface(design: Design, plane: Lengths, line: FloatArray, edge: float) -> FloatArray:
    """Return the parameters (k, 2) of points along a curve on the surface."""
    if line.ndim != 2 or line.shape[1] != 3 or len(line) < 2 or not np.isfinite(line).all():
        raise CGCError(f"a seam must be points (k, 3) along a curve, two or more, not of shape {line.shape}")
    fine = resample_all(line, 0.5 * edge)
    values = [np.linspace(low, high, 65) for low, high in design.surface.domain.tolist()]
    uv = np.stack(np.meshgrid(*values, indexing="ij"), axis=-1).reshape(-1, 2)
    start = uv[cKDTree(design.surface.at(uv)).query(fine)[1]]
    found = design.surface.foot(fine, start)
    away = np.linalg.norm(design.surface.at(found) - fine, axis=1)
    # A curve that is drawn beyond the rim counts up to it.
    on = np.flatnonzero(away <= AWAY * edge)
    within = slice(on[0], on[-1] + 1) if len(on) else slice(None)
    farthest = int(np.argmax(away[within]))
    if away[within][farthest] > AWAY * edge:
        unit, place = unit_suffix(design.drawing.units), place_text(fine[within][farthest], design.surface.size)
        raise MeshError(
            f"a seam is {away[within][farthest]:.3g}{unit} away from the design at {place}; draw it on the surface, or project it there"
        )
    return found[within]


def _pieces(surface: SplineSurface, line: FloatArray) -> list[FloatArray]:
    """Return a seam (k, 2) as pieces within the domain, where parameters close."""
    if not any(surface.closed):
        return [line]
    import shapely

    spans = np.ptp(surface.domain, axis=1)
    line = np.column_stack([contiguous(line[:, k], spans[k]) if surface.closed[k] else line[:, k] for k in range(2)])
    turns = np.floor((np.array([line.min(axis=0), line.max(axis=0)]) - surface.domain[:, 0]) / spans).astype(int)
    shifts = [range(-turns[1, k], 1 - turns[0, k]) if surface.closed[k] else (0,) for k in range(2)]
    copies = shapely.MultiLineString([line + spans * [i, j] for i in shifts[0] for j in shifts[1]])
    (u0, u1), (v0, v1) = surface.domain.tolist()
    cut = shapely.intersection(copies, shapely.box(u0, v0, u1, v1))
    return [shapely.get_coordinates(part) for part in shapely.get_parts(cut) if part.length > 0.0]


def _over_rim(plane: Lengths, rims: Sequence[FloatArray], line: FloatArray, edge: float) -> FloatArray:
    """Return a seam (k, 2) whose ends near the rim are led over it, so that it divides panels."""
    points = plane.to_plane(line)
    if np.linalg.norm(points[0] - points[-1]) <= 1e-9 * edge:
        return line
    rings = [np.concatenate([plane.to_plane(rim), plane.to_plane(rim)[:1]]) for rim in rims]
    ring = np.concatenate([resample_all(np.column_stack([own, np.zeros(len(own))]), 0.05 * edge)[:, :2] for own in rings])
    tree = cKDTree(ring)
    ends = []
    for end, before in ((points[0], points[1]), (points[-1], points[-2])):
        along = end - before
        ends.append(end + edge * along / max(float(np.linalg.norm(along)), 1e-300) if tree.query(end)[0] <= NEAR * edge else None)
    parts = [ends[0]] if ends[0] is not None else []
    extended = np.array([*parts, *points, *([ends[1]] if ends[1] is not None else [])])
    return plane.to_parameters(extended)


def _default_width(design: Design) -> float:
    return max(float(own[-1]) for own in Lengths.of(design.surface, design.rims).lengths) / PANELS
