"""Even sampling of plane curves and of the area between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask

__all__ = ["Cell", "cells", "lattice", "spread"]


def spread(
    domain: shapely.Polygon, rings: Sequence[FloatArray], creases: Sequence[FloatArray], spacing: float, tolerance: float
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Spread points along curves, with one at every kink and crossing.

    Parameters
    ----------
    domain
        Area between the rings.
    rings
        ``(k, 2)`` closed curves around it, the outer one first [L].
    creases
        ``(k, 2)`` curves in it, which may cross each other and themselves [L].
    spacing
        Distance aimed at [L].
    tolerance
        Length below which two points are one [L].

    Returns
    -------
    rings
        ``(k, 2)`` points around each ring, the first not repeated.
    pieces
        ``(k, 2)`` points along each piece of a crease between crossings, inside of the domain.
    """
    lines = [shapely.LineString(ring) for ring in rings]
    count = len(lines)
    for crease in creases:
        # A crease that crosses itself falls into pieces which do not.
        lines += list(shapely.get_parts(shapely.node(shapely.LineString(crease))))
    nodes = _nodes(lines, spacing)
    around, pieces = [], []
    for i, line in enumerate(lines):
        at = np.array([line.project(shapely.Point(node)) for node in nodes])
        on = np.array([line.distance(shapely.Point(node)) for node in nodes]) <= 0.1 * spacing
        own = np.flatnonzero(on)
        own = own[np.argsort(at[own], kind="stable")]
        closed = bool(line.is_closed)
        stretches = list(zip(own[:-1], own[1:])) + ([(own[-1], own[0])] if closed else [])
        parts = []
        for a, b in stretches:
            begin, end = at[a], at[b] if at[b] > at[a] else at[b] + line.length
            number = max(1, round(float(end - begin) / spacing), 3 if closed and len(own) == 1 else 1)
            places = np.linspace(begin, end, number + 1) % line.length if closed else np.linspace(begin, end, number + 1)
            points = shapely.get_coordinates(shapely.line_interpolate_point(line, places))
            points[0], points[-1] = nodes[a], nodes[b]
            middle = shapely.line_interpolate_point(line, (0.5 * (begin + end)) % line.length if closed else 0.5 * (begin + end))
            inside = domain.contains(middle) and domain.boundary.distance(middle) > tolerance
            if i < count or inside:
                parts.append(points)
        if i < count:
            around.append(np.concatenate([part[:-1] for part in parts]))
        else:
            pieces += parts
    return around, pieces


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


def lattice(domain: shapely.Polygon, spacing: float) -> FloatArray:
    """Return the points (k, 2) of a triangular lattice inside of a domain [L]."""
    x0, y0, x1, y1 = domain.bounds
    rows = np.arange(y0, y1, spacing * np.sqrt(3) / 2)
    columns = np.arange(x0, x1 + spacing, spacing)
    x = columns[None, :] + 0.5 * spacing * (np.arange(len(rows)) % 2)[:, None]
    points = np.column_stack([x.ravel(), np.repeat(rows, len(columns))])
    return points[shapely.contains_xy(domain, points)]


def _nodes(lines: list[shapely.LineString], spacing: float) -> FloatArray:
    """Return the kinks, ends and crossings of lines, those closer than a tenth of the spacing as one (k, 2)."""
    found = []
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
