"""Creases of a design as seams: panels end where the design folds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from ..meshing.kinks import sharp_parameters
from ..meshing.polyline import nearest_on_polyline
from .curve_panels import Lengths
from .panelling import Panelling
from .spline_surface import SplineSurface

__all__ = ["along_parameters", "beside_parameters", "continued", "creases_of", "held_on_creases"]

STRAIGHT = 1e-6  # of the range of a parameter, within which a crease keeps its value
ON = 1e-4  # of the range of a parameter, within which a vertex is on a crease
TOUCHING = 0.1  # of an edge or a panel, within which the end of a crease is on another line


def creases_of(surface: SplineSurface) -> tuple[FloatArray, ...]:
    """Return the kinks of a spline surface, which it has at knots only, as parameters (2, 2)."""
    lines = []
    for axis, value in sharp_parameters(surface.at, surface.domain, [knots.tolist() for knots in surface.knots]):
        line = surface.domain.T.copy()
        line[:, axis] = value
        lines.append(line)
    return tuple(lines)


def along_parameters(surface: SplineSurface, creases: Sequence[FloatArray]) -> tuple[list[tuple[int, float]], list[FloatArray]]:
    """Return the axes and values of parameters along which creases divide a whole surface, and all other creases (k, 2)."""
    whole, others = list[tuple[int, float]](), list[FloatArray]()
    for line in creases:
        low, high = line.min(axis=0), line.max(axis=0)
        reach = STRAIGHT * np.ptp(surface.domain, axis=1)
        for axis in range(2):
            other = 1 - axis
            ends = np.array([low[other], high[other]])
            if high[axis] - low[axis] <= reach[axis] and (np.abs(ends - surface.domain[other]) <= reach[other]).all():
                whole.append((axis, float(line[:, axis].mean())))
                break
        else:
            others.append(line)
    return whole, others


def beside_parameters(surface: SplineSurface, plane: Lengths, creases: Sequence[FloatArray], width: float) -> list[tuple[int, float]]:
    """Return the axes and mean values of parameters that creases (k, 2) through the whole surface nearly keep.

    Lines of a grid there would leave slivers: the crease is one of its lines.

    Parameters
    ----------
    surface
        The surface.
    plane
        Its mean lengths.
    creases
        ``(k, 2)`` parameters along creases.
    width
        Width of a panel, within half of which a crease has to stay [L].
    """
    found = []
    for line in creases:
        reach, wanders = TOUCHING * width, np.ptp(plane.to_plane(line), axis=0)
        for axis in range(2):
            ends = plane.to_plane(np.array([line.min(axis=0), line.max(axis=0)]))[:, 1 - axis]
            sides = plane.to_plane(surface.domain.T)[:, 1 - axis]
            if wanders[axis] <= 0.5 * width and (np.abs(ends - sides) <= reach).all():
                found.append((axis, float(line[:, axis].mean())))
    return found


def continued(plane: Lengths, creases: Sequence[FloatArray], others: Sequence[FloatArray], edge: float) -> list[FloatArray]:
    """Return creases (k, 2) whose ends within a panel go on straight to the next line, so that panels end where they fold.

    Parameters
    ----------
    plane
        The plane in which the design is meshed.
    creases
        ``(k, 2)`` parameters along creases.
    others
        ``(k, 2)`` parameters along other seams and closed rims.
    edge
        Length of edges aimed at [L].
    """
    import shapely

    flat = [plane.to_plane(line) for line in creases]
    lines = [shapely.LineString(line) for line in (*flat, *(plane.to_plane(line) for line in others))]
    size = float(np.hypot(*(own[-1] for own in plane.lengths)))
    found = []
    for k, line in enumerate(flat):
        rest = shapely.union_all(lines[:k] + lines[k + 1 :])
        ends: list[FloatArray] = []
        for end, before in ((line[0], line[1]), (line[-1], line[-2])):
            along = (end - before) / max(float(np.linalg.norm(end - before)), 1e-300)
            ray = shapely.LineString([end + TOUCHING * edge * along, end + size * along])
            hits = shapely.get_coordinates(shapely.intersection(ray, rest))
            is_loose = shapely.distance(shapely.Point(end), rest) > TOUCHING * edge and not np.allclose(line[0], line[-1])
            nearest = hits[np.argsort(np.linalg.norm(hits - end, axis=1))[:1]]
            ends.append(nearest if is_loose else np.empty((0, 2)))
        found.append(plane.to_parameters(np.concatenate([ends[0], line, ends[1]])))
    return found


def held_on_creases(surface: SplineSurface, panelling: Panelling, creases: Sequence[FloatArray]) -> Panelling:
    """Return panels whose vertices on creases keep both parameters: their distance is that from the crease."""
    reach = ON * float(np.ptp(surface.domain, axis=1).max())
    held = panelling.held.copy()
    for line in creases:
        held[nearest_on_polyline(panelling.parameters, line)[0] <= reach] = True
    return panelling._replace(held=held)
