"""Even sampling of plane curves and of the area between them."""

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
from .sizing import SizeField
from .sizing import size_field
from .stretches import Stretch
from .stretches import graded
from .stretches import narrow_corners
from .stretches import stretches_of

__all__ = ["Cell", "Spread", "cells", "lattice", "spread"]

LEVELS = 4  # of lattices at least, each half as wide as the one before
FULL = 0.75  # of the edge length, above which the first of them serves
APART = 0.82  # of the edge length, that their points keep from each other
TURNS = (0.0, np.pi / 6, np.pi / 12, np.pi / 4)  # of lattices, which are their own after a sixth of a turn
BESIDE = 0.3  # of the spacing, within which a point asks for a vertex at its foot on a curve
REACH = 0.1  # of the spacing, within which a place is one with another or lies on a curve
_NO_ROWS = np.empty(0)


class Spread(NamedTuple):
    """Points spread along curves, and what they were spread by."""

    rings: list[FloatArray]  # (k, 2) points around each ring, the first not repeated [L]
    pieces: list[FloatArray]  # (k, 2) points along each piece of a crease between crossings, inside of the domain [L]
    loose: FloatArray  # (k, 2) given points that lie on no curve [L]
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
    """Spread points along curves, with one at every kink, crossing and given point, closer together at small features.

    Parameters
    ----------
    domain
        Area between the rings.
    rings
        ``(k, 2)`` closed curves around it, the outer one first [L].
    creases
        ``(k, 2)`` curves in it, which may cross each other and themselves [L].
    points
        ``(k, 2)`` places that become vertices; those outside of the domain are left out [L].
    spacing
        Distance aimed at [L].
    tolerance
        Length below which two points are one [L].
    grade
        Part of the distance from a small feature by which vertices are farther apart.

    Returns
    -------
    Spread
    """
    lines = [shapely.LineString(ring) for ring in rings]
    count = len(lines)
    for crease in creases:
        # A crease that crosses itself falls into pieces which do not.
        lines += list(shapely.get_parts(shapely.node(shapely.LineString(crease))))
    reach = max(tolerance, REACH * spacing)
    within = [point for point in points if domain.distance(shapely.Point(point)) <= reach]
    curves = shapely.MultiLineString(lines)
    on_curve = [point for point in within if curves.distance(shapely.Point(point)) <= reach]
    loose = np.array([point for point in within if curves.distance(shapely.Point(point)) > reach]).reshape(-1, 2)
    nodes = _nodes(lines, spacing, on_curve, _feet(lines, loose, spacing))
    inside_nodes = np.array([node for node in nodes if domain.distance(shapely.Point(node)) <= reach]).reshape(-1, 2)
    stretches = [stretch for line in lines for stretch in stretches_of(line, nodes, 0.1 * spacing)]
    rims = set(map(id, lines[:count]))
    stretches = [one for one in stretches if id(one.line) in rims or _is_inside(domain, one, tolerance)]
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
    """A part of the plane that curves enclose."""

    polygon: shapely.Polygon
    loose: list[FloatArray]  # (k, 2) curves inside that enclose nothing [L]


def cells(domain: shapely.Polygon, rings: Sequence[FloatArray], pieces: Sequence[FloatArray]) -> list[Cell]:
    """Return the parts that rings (k, 2), first point not repeated, and pieces (k, 2) divide a domain into."""
    lines = [shapely.LineString(np.concatenate([ring, ring[:1]])) for ring in rings]
    loose = [shapely.LineString(piece) for piece in pieces]
    network = shapely.node(shapely.MultiLineString(lines + loose))
    found = [cell for cell in shapely.get_parts(shapely.polygonize([network])) if domain.contains(cell.representative_point())]
    middles = [piece.interpolate(0.5, normalized=True) for piece in loose]
    # A curve on the side of a cell is not inside of it.
    reach = 1e-9 * np.sqrt(domain.area)
    inside = [[cell.contains(middle) and cell.boundary.distance(middle) > reach for middle in middles] for cell in found]
    return [Cell(cell, [piece for piece, within in zip(pieces, own) if within]) for cell, own in zip(found, inside)]


def lattice(domain: shapely.Polygon, spacing: float, shift: float = 0.0) -> FloatArray:
    """Return the points (k, 2) of a triangular lattice inside of a domain [L], shifted by a part of the spacing."""
    x0, y0, x1, y1 = domain.bounds
    x0, y0 = x0 - shift * spacing, y0 - shift * spacing * np.sqrt(3) / 2
    rows = np.arange(y0, y1, spacing * np.sqrt(3) / 2)
    columns = np.arange(x0, x1 + spacing, spacing)
    x = columns[None, :] + 0.5 * spacing * (np.arange(len(rows)) % 2)[:, None]
    points = np.column_stack([x.ravel(), np.repeat(rows, len(columns))])
    return points[shapely.contains_xy(domain, points)]


def lattices(domain: shapely.Polygon, sizes: SizeField) -> Iterator[FloatArray]:
    """Yield points (k, 2) inside of a domain: lattices of several places and directions, thinned out where edges are longer."""
    for turn in TURNS:
        turned = shapely.affinity.rotate(domain, -turn, origin=(0, 0), use_radians=True)
        back = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        for shift in (0.0, 0.25, 0.5, 0.75):
            levels = _levels(turned, sizes, shift, back)
            points = np.concatenate(levels)
            yield points[_apart(points, APART * sizes(points))] if len(levels) > 1 else points


def _levels(domain: shapely.Polygon, sizes: SizeField, shift: float, back: FloatArray) -> list[FloatArray]:
    """Return the points (k, 2) of lattices, turned back, each finer than the one before, where edges are as long as in the first or not."""
    step = spacing = sizes.edge_length
    points = lattice(domain, step, shift)
    wanted = sizes(points @ back)
    levels = [(points @ back)[wanted > FULL * spacing]]
    if len(levels[0]) == len(points):
        return levels
    while len(levels) < LEVELS or step > sizes.smallest:
        step *= 0.5
        # The finest ones only where they are wanted: over all of the domain they would be many.
        points = lattice(domain, step, shift) if len(levels) < LEVELS else _halved(points[wanted <= 4.0 * step], step, domain)
        wanted = sizes(points @ back)
        levels.append((points @ back)[wanted <= FULL * spacing])
    return levels


def _halved(points: FloatArray, step: float, domain: shapely.Polygon) -> FloatArray:
    """Return the points (k, 2) of a lattice with half the spacing of the one that points belong to, around these."""
    corners = step * np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)], [1.5, np.sqrt(0.75)]])
    finer = (points[:, None] + corners).reshape(-1, 2)
    return finer[shapely.contains_xy(domain, finer)]


def _apart(points: FloatArray, distance: FloatArray) -> Mask:
    """Mark points, first come first served, that keep their distance from those marked before."""
    free = np.ones(len(points), bool)
    near = cKDTree(points).query_ball_point(points, distance, return_sorted=False) if len(points) else []
    for i in range(len(points)):
        if free[i]:
            free[near[i]] = False
            free[i] = True
    return free


def _feet(lines: list[shapely.LineString], points: FloatArray, spacing: float) -> FloatArray:
    """Return the places (k, 2) on lines that are nearest to points close by: vertices spread past such a point leave it a sliver."""
    near = [(line, shapely.Point(point)) for point in points for line in lines if line.distance(shapely.Point(point)) < BESIDE * spacing]
    return np.array([line.interpolate(line.project(point)).coords[0] for line, point in near]).reshape(-1, 2)


def _nodes(lines: list[shapely.LineString], spacing: float, points: Sequence[FloatArray], feet: FloatArray) -> FloatArray:
    """Return given points, kinks, ends and crossings of lines, and feet of points, those closer than a tenth of the spacing as one."""
    found = [np.reshape(points, (-1, 2))]
    for i, line in enumerate(lines):
        corners = shapely.get_coordinates(line)
        found.append(corners[_kinks(corners, bool(line.is_closed))])
        for other in lines[:i]:
            found.append(shapely.get_coordinates(line.intersection(other)))
        if not line.is_closed:
            for end in (corners[0], corners[-1]):
                # An end that does not quite reach another curve is led there.
                near = [other for other in lines if other is not line and other.distance(shapely.Point(end)) <= 0.1 * spacing]
                on = [shapely.get_coordinates(other.interpolate(other.project(shapely.Point(end)))) for other in near[:1]]
                found.append(on[0] if on else end[None])
    found.append(feet)
    nodes: list[FloatArray] = []
    for node in np.concatenate(found):
        if all(np.linalg.norm(node - other) > 0.1 * spacing for other in nodes):
            nodes.append(node)
    return np.array(nodes)


def _kinks(points: FloatArray, closed: bool) -> Mask:
    """Mark where a polyline turns by more than 30 degrees; on a closed one without such a place, its first point."""
    ahead = np.diff(points, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-300)
    cosine = np.einsum("ij,ij->i", ahead, np.roll(ahead, 1, axis=0))
    kink = np.append(cosine < np.cos(np.radians(30)), False)
    if not closed:
        kink[0] = False
    elif not kink.any():
        kink[0] = True
    return kink
