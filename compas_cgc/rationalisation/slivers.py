"""Seams without the parts that cut slivers off at a rim."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import MeshError
from .curve_panels import Lengths
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["without_slivers"]

SLIVER = 0.01  # of the median area of panels, below which one is part of a neighbour; such panels have a tenth of the width of others
ON = 1e-6  # of the size, within which a point is on a line


def without_slivers(
    surface: SplineSurface, plane: Lengths, rims: Sequence[FloatArray], seams: Sequence[FloatArray], folds: Sequence[FloatArray]
) -> list[FloatArray]:
    """Return seams without the parts between slivers at a rim and the neighbours that border most on them.

    Slivers beside sharp edges stay, and those at the line where a closed surface is cut open, as they go on behind it.

    Parameters
    ----------
    surface
        The surface.
    plane
        The plane in which it is meshed.
    rims
        ``(k, 2)`` parameters around the surface and its holes.
    seams
        ``(k, 2)`` parameters along seams, sharp edges among them.
    folds
        ``(k, 2)`` parameters along sharp edges.

    Raises
    ------
    MeshError
        If shapely is not installed.
    """
    try:
        import shapely
    except ImportError as error:
        raise MeshError(f"a mesh from curves needs {error.name}; install it: pip install 'compas_cgc[mesher]'") from None

    flat = [plane.to_plane(np.concatenate([rim, rim[:1]])) for rim in rims]
    lines = [shapely.LineString(plane.to_plane(seam)) for seam in seams]
    rim, sharp = shapely.MultiLineString(flat), shapely.MultiLineString([plane.to_plane(fold) for fold in folds])
    parts = shapely.get_parts(shapely.union_all([rim, *lines]))
    cells = shapely.get_parts(shapely.polygonize(parts))
    cells = cells[within_rims(plane.to_parameters(shapely.get_coordinates(shapely.point_on_surface(cells))), rims)]
    if not len(cells):
        return list(seams)
    areas, reach = shapely.area(cells), ON * float(np.hypot(*(own[-1] for own in plane.lengths)))
    narrow = (areas < SLIVER * np.median(areas)) & (shapely.distance(cells, rim) <= reach) & ~(shapely.distance(cells, sharp) <= reach)
    low, high = plane.to_plane(surface.domain.T)
    x0, y0, x1, y1 = shapely.bounds(cells).T
    opened = surface.closed[0] & ((x0 <= low[0] + reach) | (x1 >= high[0] - reach))
    opened |= surface.closed[1] & ((y0 <= low[1] + reach) | (y1 >= high[1] - reach))
    middles = shapely.line_interpolate_point(parts, 0.5, normalized=True)
    free = shapely.distance(middles, rim) > reach
    dropped = []
    for sliver in np.flatnonzero(narrow & ~opened):
        beside = np.flatnonzero(free & (shapely.distance(middles, cells[sliver].exterior) <= reach))
        others = [np.flatnonzero((shapely.distance(middles[part], cells) <= reach) & (np.arange(len(cells)) != sliver)) for part in beside]
        borders = np.zeros(len(cells))
        for part, cell in zip(beside, others):
            borders[cell] += shapely.length(parts[part])
        if borders.any():
            widest = int(np.argmax(borders))
            dropped += [part for part, cell in zip(beside, others) if widest in cell]
    if not dropped:
        return list(seams)
    gone = shapely.buffer(shapely.MultiLineString(list(parts[np.unique(dropped)])), reach, cap_style="flat")
    left = [part for line in lines for part in shapely.get_parts(shapely.difference(line, gone))]
    return [plane.to_parameters(shapely.get_coordinates(part)) for part in left if shapely.length(part) > 2.0 * reach]
