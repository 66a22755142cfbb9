"""Sampling of plane curves and of the area between them."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
import shapely.affinity
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from .sizing import MIN_GAP_SIZE
from .sizing import SizeField
from .sizing import size_field
from .stretches import Stretch
from .stretches import graded
from .stretches import narrow_corners
from .stretches import stretches_of
from .stretches import without_copies

__all__ = ["Cell", "Spread", "cells", "lattice", "spread"]

MIN_LEVELS = 4  # least number of lattices, each with half the spacing of the previous one
FULL_LENGTH = 0.75  # relative edge length above which the coarsest lattice is used
MIN_DISTANCE = 0.82  # distance between lattice points, relative to the edge length
ROTATIONS = (0.0, np.pi / 6, np.pi / 12, np.pi / 4)  # rotations of lattices tried; lattices have sixfold symmetry
FOOT_DISTANCE = 0.3  # relative distance from a curve within which a point gets a vertex at its foot on the curve
MERGE_DISTANCE = 0.1  # relative distance within which points coincide or lie on a curve
TOGETHER, RUN = 0.5 * MIN_GAP_SIZE, 0.25  # relative distance and length from which curves run together, without room for triangles
_NO_ROWS = np.empty(0)


class Spread(NamedTuple):
    """Points spread along curves, with the size field."""

    rings: list[FloatArray]  # (k, 2) points around each ring, the first not repeated [L]
    pieces: list[FloatArray]  # (k, 2) points along each piece of a crease between crossings, inside the domain [L]
    loose: FloatArray  # (k, 2) given points off all curves [L]
    sizes: SizeField


def spread(
    domain: shapely.Polygon,
    rings: Sequence[FloatArray],
    creases: Sequence[FloatArray],
    points: FloatArray,
    spacing: float,
    tolerance: float,
    grade: float,
) -> Spread:
    """Return points spread along curves, with one at every kink, crossing and given point, and denser at small features.

    Parameters
    ----------
    domain
        Area between the rings.
    rings
        ``(k, 2)`` closed curves around the domain, the outer one first [L].
    creases
        ``(k, 2)`` curves in the domain, which may cross each other and themselves [L].
    points
        ``(k, 2)`` points that become vertices; points outside the domain are ignored [L].
    spacing
        Target distance [L].
    tolerance
        Distance below which two points coincide [L].
    grade
        Growth of the vertex distance per distance from a small feature.

    Returns
    -------
    Spread
    """
    lines = [shapely.LineString(ring) for ring in rings]
    count = len(lines)
    for crease in creases:
        # Split self-crossing creases at their crossings.
        lines += list(shapely.get_parts(shapely.node(shapely.LineString(crease))))
    reach = max(tolerance, MERGE_DISTANCE * spacing)
    within = [point for point in points if domain.distance(shapely.Point(point)) <= reach]
    curves = shapely.MultiLineString(lines)
    on_curve = [point for point in within if curves.distance(shapely.Point(point)) <= reach]
    loose = np.array([point for point in within if curves.distance(shapely.Point(point)) > reach]).reshape(-1, 2)
    nodes = _nodes(lines, spacing, on_curve, _feet(lines, loose, spacing))
    inside_nodes = np.array([node for node in nodes if domain.distance(shapely.Point(node)) <= reach]).reshape(-1, 2)
    stretches = [stretch for line in lines for stretch in stretches_of(line, nodes, 0.1 * spacing)]
    rims = set(map(id, lines[:count]))
    stretches = [one for one in stretches if id(one.line) in rims or _is_inside(domain, one, tolerance)]
    stretches = without_copies(stretches, MIN_GAP_SIZE * spacing)
    sides = [side for one in stretches for side in one.sides()]
    sizes = size_field([shapely.get_coordinates(line) for line in lines], sides, domain, inside_nodes, loose, spacing, grade)
    rows = narrow_corners(domain, stretches, nodes, sizes)
    around: dict[int, list[FloatArray]] = {}
    pieces = []
    for k, one in enumerate(stretches):
        part = one.at(graded(one, sizes, [rows.get((k, end), _NO_ROWS) for end in (0, 1)]))
        part[[0, -1]] = nodes[list(one.nodes)]
        if id(one.line) in rims:
            around.setdefault(id(one.line), []).append(part[:-1])
        else:
            pieces.append(part)
    return Spread([np.concatenate(around[id(line)]) for line in lines[:count]], pieces, loose, sizes)


def _is_inside(domain: shapely.Polygon, stretch: Stretch, tolerance: float) -> bool:
    middle = shapely.Point(stretch.leaving(0, 0.5 * stretch.length))
    return bool(domain.contains(middle)) and bool(domain.boundary.distance(middle) > tolerance)


class Cell(NamedTuple):
    """A part of the plane enclosed by curves."""

    polygon: shapely.Polygon
    loose: list[FloatArray]  # (k, 2) inner curves that enclose nothing [L]


def cells(domain: shapely.Polygon, rings: Sequence[FloatArray], pieces: Sequence[FloatArray]) -> list[Cell]:
    """Return the parts of a domain divided by rings (k, 2), whose first point is not repeated, and pieces (k, 2)."""
    lines = [shapely.LineString(np.concatenate([ring, ring[:1]])) for ring in rings]
    loose = [shapely.LineString(piece) for piece in pieces]
    network = shapely.node(shapely.MultiLineString(lines + loose))
    found = [cell for cell in shapely.get_parts(shapely.polygonize([network])) if domain.contains(cell.representative_point())]
    middles = [piece.interpolate(0.5, normalized=True) for piece in loose]
    # Curves on the boundary of a cell are not inside it.
    reach = 1e-9 * np.sqrt(domain.area)
    inside = [[cell.contains(middle) and cell.boundary.distance(middle) > reach for middle in middles] for cell in found]
    return [Cell(cell, [piece for piece, within in zip(pieces, own) if within]) for cell, own in zip(found, inside)]


def lattice(domain: shapely.Polygon, spacing: float, shift: float = 0.0) -> FloatArray:
    """Return the points (k, 2) of a triangular lattice inside a domain [L], shifted by a fraction of the spacing."""
    x0, y0, x1, y1 = domain.bounds
    x0, y0 = x0 - shift * spacing, y0 - shift * spacing * np.sqrt(3) / 2
    rows = np.arange(y0, y1, spacing * np.sqrt(3) / 2)
    columns = np.arange(x0, x1 + spacing, spacing)
    x = columns[None, :] + 0.5 * spacing * (np.arange(len(rows)) % 2)[:, None]
    points = np.column_stack([x.ravel(), np.repeat(rows, len(columns))])
    return points[shapely.contains_xy(domain, points)]


def lattices(domain: shapely.Polygon, sizes: SizeField) -> Iterator[FloatArray]:
    """Yield lattice points (k, 2) inside a domain for several shifts and rotations, with distances by the size field."""
    for turn in ROTATIONS:
        turned = shapely.affinity.rotate(domain, -turn, origin=(0, 0), use_radians=True)
        back = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        for shift in (0.0, 0.25, 0.5, 0.75):
            levels = _levels(turned, sizes, shift, back)
            points = np.concatenate(levels)
            yield points[_apart(points, MIN_DISTANCE * sizes(points))] if len(levels) > 1 else points


def _levels(domain: shapely.Polygon, sizes: SizeField, shift: float, back: FloatArray) -> list[FloatArray]:
    """Return the points (k, 2) of successively finer lattices, rotated back, each where the size field needs it."""
    step = spacing = sizes.edge_length
    points = lattice(domain, step, shift)
    wanted = sizes(points @ back)
    levels = [(points @ back)[wanted > FULL_LENGTH * spacing]]
    if len(levels[0]) == len(points):
        return levels
    while len(levels) < MIN_LEVELS or step > sizes.smallest:
        step *= 0.5
        # The finest lattices are built only where needed.
        points = lattice(domain, step, shift) if len(levels) < MIN_LEVELS else _halved(points[wanted <= 4.0 * step], step, domain)
        wanted = sizes(points @ back)
        levels.append((points @ back)[wanted <= FULL_LENGTH * spacing])
    return levels


def _halved(points: FloatArray, step: float, domain: shapely.Polygon) -> FloatArray:
    """Return the points (k, 2) of the lattice with half the spacing around given lattice points."""
    corners = step * np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)], [1.5, np.sqrt(0.75)]])
    finer = (points[:, None] + corners).reshape(-1, 2)
    return finer[shapely.contains_xy(domain, finer)]


def _apart(points: FloatArray, distance: FloatArray) -> Mask:
    """Return the mask of points, in order, that keep their distance from previously selected ones."""
    free = np.ones(len(points), bool)
    near = cKDTree(points).query_ball_point(points, distance, return_sorted=False) if len(points) else []
    for i in range(len(points)):
        if free[i]:
            free[near[i]] = False
            free[i] = True
    return free


def _feet(lines: list[shapely.LineString], points: FloatArray, spacing: float) -> FloatArray:
    """Return the nearest points (k, 2) on lines to nearby points, which become vertices to avoid slivers."""
    near = [
        (line, shapely.Point(point)) for point in points for line in lines if line.distance(shapely.Point(point)) < FOOT_DISTANCE * spacing
    ]
    return np.array([line.interpolate(line.project(point)).coords[0] for line, point in near]).reshape(-1, 2)


def _nodes(lines: list[shapely.LineString], spacing: float, points: Sequence[FloatArray], feet: FloatArray) -> FloatArray:
    """Return given points, kinks, ends and crossings of lines, and feet of points, merged within a tenth of the spacing (k, 2)."""
    found = [np.reshape(points, (-1, 2))]
    for i, line in enumerate(lines):
        corners = shapely.get_coordinates(line)
        found.append(corners[_kinks(corners, bool(line.is_closed))])
        for other in lines[:i]:
            found.append(_meetings(line, other, spacing))
        if not line.is_closed:
            for end in (corners[0], corners[-1]):
                # Snap an end near another curve to it.
                near = [other for other in lines if other is not line and other.distance(shapely.Point(end)) <= 0.1 * spacing]
                on = [shapely.get_coordinates(other.interpolate(other.project(shapely.Point(end)))) for other in near[:1]]
                found.append(on[0] if on else end[None])
    found.append(feet)
    nodes: list[FloatArray] = []
    for node in np.concatenate(found):
        if all(np.linalg.norm(node - other) > 0.1 * spacing for other in nodes):
            nodes.append(node)
    return np.array(nodes)


def _meetings(line: shapely.LineString, other: shapely.LineString, spacing: float) -> FloatArray:
    """Return the points (k, 2) at which two lines cross, and the ends of the parts along which they run together."""
    crossings = shapely.get_coordinates(line.intersection(other))
    if line.distance(other) > TOGETHER * spacing:
        return crossings
    together = [part for part in shapely.get_parts(line.intersection(other.buffer(TOGETHER * spacing))) if part.length > RUN * spacing]
    apart = shapely.points(crossings)
    inside = [np.asarray(shapely.distance(part, apart)) <= TOGETHER * spacing for part in together]
    # Curves that cross once at a small angle do not run together.
    runs = [(part, within) for part, within in zip(together, inside) if np.count_nonzero(within) != 1]
    if not runs:
        return crossings
    ends = [other.interpolate(other.project(shapely.Point(end))).coords[0] for part, _ in runs for end in (part.coords[0], part.coords[-1])]
    return np.concatenate([np.array(ends), crossings[~np.any([within for _, within in runs], axis=0)]])


def _kinks(points: FloatArray, closed: bool) -> Mask:
    """Return where a polyline turns by more than 30 degrees; the first point of a closed one without such turns."""
    ahead = np.diff(points, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-300)
    cosine = np.einsum("ij,ij->i", ahead, np.roll(ahead, 1, axis=0))
    kink = np.append(cosine < np.cos(np.radians(30)), False)
    if not closed:
        kink[0] = False
    elif not kink.any():
        kink[0] = True
    return kink
