"""Rims in the parameters of a surface, and measures within them: a fitted surface is arbitrary outside the mesh it was fitted to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..errors import MeshError
from ..meshing.in_outline import inside_outline
from .unwrapping import contiguous

__all__ = ["mean_steps", "rims_of_closed", "within_rims"]


def rims_of_closed(domain: FloatArray, period: FloatArray, holes: Sequence[FloatArray]) -> list[FloatArray]:
    """Return the rim and the holes (k, 2) of a surface whose parameters close, within the rectangle of its parameters.

    A hole across the line where a parameter closes becomes two notches of the rim.

    Parameters
    ----------
    domain
        ``(2, 2)`` first and last value of each parameter.
    period
        ``(2,)`` of each parameter that closes, infinite for others.
    holes
        ``(k, 2)`` parameters around the holes, which may jump by a period.

    Raises
    ------
    MeshError
        If the holes divide the rectangle into several parts, or shapely is not installed.
    """
    try:
        import shapely
    except ImportError:
        raise MeshError("a closed design with holes needs shapely; install it: pip install 'compas_cgc[mesher]'") from None
    (u0, u1), (v0, v1) = domain.tolist()
    area = shapely.box(u0, v0, u1, v1)
    shifts = [(-1, 0, 1) if np.isfinite(own) else (0,) for own in period]
    whole = np.where(np.isfinite(period), period, 0.0)
    for hole in holes:
        line = np.column_stack([contiguous(hole[:, k], period[k]) if np.isfinite(period[k]) else hole[:, k] for k in range(2)])
        for i in shifts[0]:
            for j in shifts[1]:
                area = area.difference(shapely.make_valid(shapely.Polygon(line + whole * [i, j])))
    if area.geom_type != "Polygon":
        raise MeshError("the holes of the closed design together separate it into parts; divide the design there")
    return [shapely.get_coordinates(ring)[:-1] for ring in (area.exterior, *area.interiors)]


def within_rims(uv: FloatArray, rims: Sequence[FloatArray]) -> Mask:
    """Return which parameters (..., 2) lie within a rim and outside its holes; all where there are no rims."""
    inside = np.full(uv.shape[:-1], not len(rims))
    for rim in rims:
        inside ^= inside_outline(uv.reshape(-1, 2), rim).reshape(inside.shape)
    return inside


def mean_steps(points: FloatArray, inside: Mask, axis: int) -> FloatArray:
    """Return the mean distances (k,) between neighbours along one axis of a grid of points (a, b, 3), where both are inside.

    A step without points inside is as long as its neighbours.
    """
    first, rest = (np.take(inside, places, axis) for places in (range(inside.shape[axis] - 1), range(1, inside.shape[axis])))
    counted = first & rest
    lengths = np.linalg.norm(np.diff(points, axis=axis), axis=2)
    count = counted.sum(axis=1 - axis)
    if not count.any():
        return np.asarray(lengths.mean(axis=1 - axis))
    means = (lengths * counted).sum(axis=1 - axis) / np.maximum(count, 1)
    known = np.flatnonzero(count)
    return np.interp(np.arange(len(means)), known, means[known])
