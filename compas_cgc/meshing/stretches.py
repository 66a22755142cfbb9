"""Stretches of curves between nodes, and the positions of vertices along them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from shapely.ops import substring

from ..discrete.arrays import FloatArray
from .sizing import MIN_GAP_SIZE
from .sizing import SizeField

__all__ = ["Stretch", "graded", "narrow_corners", "stretches_of", "without_copies"]

NARROW_ANGLE = np.radians(40.0)  # angle between two curves below which their vertices are paired
FIRST_PAIR = 1.5  # largest distance of the first pair from a narrow corner, in edge lengths
NO_ANGLE = MIN_GAP_SIZE / FIRST_PAIR  # angle between two curves below which they run on top of each other beyond the first pair
PAIR_REACH = 0.6  # reach of pairs relative to the shorter curve
HALF_REACH = 0.45  # the same if both ends are narrow corners

Rows = dict[tuple[int, int], FloatArray]
"""Distances (k,) of vertices from the ends of stretches, 0 or 1 [L]."""


class Stretch(NamedTuple):
    """A part of a curve between two nodes."""

    line: shapely.LineString
    begin: float  # along the line [L]
    end: float  # along the line, beyond its length if a closed line continues [L]
    nodes: tuple[int, int]  # indices of the nodes at both ends
    least: int  # least number of edges

    @property
    def length(self) -> float:
        """Length [L]."""
        return self.end - self.begin

    def at(self, places: FloatArray) -> FloatArray:
        """Return the points (k, 2) at arc lengths (k,) along the line [L]."""
        return shapely.get_coordinates(
            shapely.line_interpolate_point(self.line, places % self.line.length if self.line.is_closed else places)
        )

    @property
    def points(self) -> FloatArray:
        """Points along it (k, 2) [L]."""
        points = shapely.get_coordinates(substring(self.line, self.begin, min(self.end, self.line.length)))
        if self.end > self.line.length:
            points = np.concatenate([points, shapely.get_coordinates(substring(self.line, 0.0, self.end - self.line.length))[1:]])
        return points

    def sides(self) -> list[FloatArray]:
        """Return its parts that turn by at most 90 degrees, as points (k, 2) [L]."""
        points = self.points
        ahead = np.diff(points, axis=0)
        way = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        quarter = np.floor(np.cumsum(np.abs(np.diff(way, prepend=way[:1]))) / (0.5 * np.pi))
        stops = [0, *np.flatnonzero(np.diff(quarter)) + 1, len(points) - 1]
        return [points[first : last + 1] for first, last in zip(stops[:-1], stops[1:])]

    def leaving(self, end: int, distance: float) -> FloatArray:
        """Return the point (2,) at a distance from end 0 or 1 [L]."""
        return self.at(np.array([self.begin + distance if end == 0 else self.end - distance]))[0]


def stretches_of(line: shapely.LineString, nodes: FloatArray, reach: float) -> list[Stretch]:
    """Return the stretches of a line between the nodes (k, 2) that lie within reach of it."""
    points = shapely.points(nodes)
    at: FloatArray = np.asarray(shapely.line_locate_point(line, points))
    on = np.asarray(shapely.distance(line, points)) <= reach
    own = np.flatnonzero(on)
    own = own[np.argsort(at[own], kind="stable")].tolist()
    closed = bool(line.is_closed)
    pairs = list(zip(own[:-1], own[1:])) + ([(own[-1], own[0])] if closed else [])
    least = 3 if closed and len(own) == 1 else 1
    return [Stretch(line, float(at[a]), float(at[b] if at[b] > at[a] else at[b] + line.length), (a, b), least) for a, b in pairs]


def without_copies(stretches: Sequence[Stretch], reach: float) -> list[Stretch]:
    """Return stretches without those that run along an earlier one between the same nodes, within a distance [L]."""
    kept: list[Stretch] = []
    between: dict[frozenset[int], list[shapely.LineString]] = {}
    for one in stretches:
        others = between.setdefault(frozenset(one.nodes), [])
        line = shapely.LineString(one.points)
        if not any(shapely.hausdorff_distance(line, other, 0.25) <= reach for other in others):
            others.append(line)
            kept.append(one)
    return kept


def graded(stretch: Stretch, sizes: SizeField, rows: Sequence[FloatArray]) -> FloatArray:
    """Return arc lengths (k,) along a line spaced by the size field, with given distances from both ends [L]."""
    head, tail = stretch.begin + np.concatenate([[0.0], rows[0]]), stretch.end - np.concatenate([[0.0], rows[1]])[::-1]
    begin, end = float(head[-1]), float(tail[0])
    fine = np.linspace(begin, end, max(8, int(np.ceil(8 * (end - begin) / sizes.edge_length))) + 1)
    density = 1.0 / sizes(stretch.at(fine))
    counted = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
    number = max(stretch.least, round(float(counted[-1])))
    between = np.interp(np.linspace(0.0, counted[-1], number + 1), counted, fine)
    return np.concatenate([head[:-1], between, tail[1:]])


def narrow_corners(domain: shapely.Polygon, stretches: Sequence[Stretch], nodes: FloatArray, sizes: SizeField) -> Rows:
    """Return the distances of vertices from narrow corners on the curves that meet there.

    Vertices at equal, growing distances on both curves give triangles with angles no smaller than that of the corner, while
    independent spacing would give slivers.

    Parameters
    ----------
    domain
        Area between the curves.
    stretches
        Stretches of the curves.
    nodes
        ``(k, 2)`` nodes of the curves [L].
    sizes
        Target edge lengths.

    Returns
    -------
    rows
        Distances (k,) by index of a stretch and its end, 0 or 1 [L].
    """
    meeting: dict[int, list[tuple[int, int]]] = {}
    for k, stretch in enumerate(stretches):
        for end, node in enumerate(stretch.nodes):
            meeting.setdefault(node, []).append((k, end))
    found = [_rows(domain, stretches, nodes[node], ends, float(sizes(nodes[node][None])[0])) for node, ends in meeting.items()]
    narrow = {one for rows in found for one in rows}
    return {one: distances for rows in found for one, distances in _apart_from_others(rows, narrow, stretches).items()}


def _apart_from_others(rows: Rows, narrow: set[tuple[int, int]], stretches: Sequence[Stretch]) -> Rows:
    """Return the rows of a corner, shortened where the other end of a curve is a narrow corner too."""
    shared = [stretches[k].length for k, end in rows if (k, 1 - end) in narrow]
    return {one: distances[distances < HALF_REACH * min(shared)] if shared else distances for one, distances in rows.items()}


def _rows(domain: shapely.Polygon, stretches: Sequence[Stretch], node: FloatArray, ends: list[tuple[int, int]], size: float) -> Rows:
    if len(ends) < 2:
        return {}
    length = {one: stretches[one[0]].length for one in ends}
    reach = min(size, 0.5 * min(length.values()))
    ahead = {one: stretches[one[0]].leaving(one[1], reach) - node for one in ends}
    ends = sorted(ends, key=lambda one: float(np.arctan2(*ahead[one][::-1])))
    narrowest, paired = NARROW_ANGLE, set()
    for one, other in zip(ends, [*ends[1:], ends[0]]):
        first, second = (complex(*ahead[each]) for each in (one, other))
        angle = float(np.angle(second / first)) % (2 * np.pi)
        middle = first / abs(first) * np.exp(0.5j * angle) * reach * 0.5
        if NO_ANGLE < angle < NARROW_ANGLE and domain.contains(shapely.Point(node[0] + middle.real, node[1] + middle.imag)):
            narrowest = min(narrowest, angle)
            paired |= {one, other}
    if not paired:
        return {}
    most = PAIR_REACH * min(length[one] for one in paired)
    across = 2.0 * np.sin(0.5 * narrowest)
    growth = (1.0 + 0.5 * across) / (1.0 - 0.5 * across)
    # The vertices of the last pair are one edge length apart.
    distances = [size / across]
    while distances[0] > FIRST_PAIR * size:
        distances.insert(0, distances[0] / growth)
    within = np.array([distance for distance in distances if distance <= most])
    return dict.fromkeys(paired, within)
