"""Mesh generation from an outline, holes and creases in plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import MeshError
from .map_matching import edge_net
from .polyline import arc_lengths
from .polyline import nearest_on_polyline
from .weld import weld

if TYPE_CHECKING:
    from .curve_sampling import Cell

__all__ = ["Outlined", "fill", "mesh_from_outline"]


class Outlined(NamedTuple):
    """A mesh made from curves."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3), upwards
    creases: list[list[int]]  # vertex paths along the creases


def mesh_from_outline(
    outline: FloatArray, holes: Sequence[FloatArray], creases: Sequence[FloatArray], edge_length: float, tolerance: float
) -> Outlined:
    """Fill an outline with near-equilateral triangles, most vertices of valence 6, whose edges follow all the curves.

    A triangular lattice fills the plan; along the curves it gives way to points spread
    evenly on them. Heights are those of the curves and as smooth as can be between them.

    Parameters
    ----------
    outline
        ``(k, 3)`` points around the boundary, first and last equal [L].
    holes
        The same for holes in it.
    creases
        ``(k, 3)`` points along each crease; what lies outside is left out.
    edge_length
        Length of edges aimed at [L].
    tolerance
        Length below which two points are one [L].

    Returns
    -------
    Outlined

    Raises
    ------
    MeshError
        If the mesher is not installed, or the curves do not bound an area.
    """
    try:
        import compas_cgal.triangulation  # noqa: F401
        import shapely

        from .curve_sampling import cells
        from .curve_sampling import lattice
        from .curve_sampling import spread
    except ImportError as error:
        raise MeshError(f"a mesh from curves needs {error.name}; install it: pip install 'compas_cgc[mesher]'") from None
    if not edge_length > 0:
        raise MeshError(f"the edge length must be above zero, not {edge_length!r}")
    rings = [np.asarray(ring)[:, :2] for ring in (outline, *holes)]
    domain = shapely.Polygon(rings[0], rings[1:])
    if not domain.is_valid or domain.area < edge_length**2:
        reason = shapely.is_valid_reason(domain) if not domain.is_valid else "its area is less than that of an edge squared"
        raise MeshError(f"the outline and its holes do not bound an area that can be meshed ({reason}); correct the curves")
    around, inner = spread(domain, rings, [np.asarray(crease)[:, :2] for crease in creases], edge_length, tolerance)
    fixed = np.concatenate([*around, *inner])
    seeds = lattice(domain, edge_length)
    seeds = seeds[cKDTree(fixed).query(seeds)[0] > 0.6 * edge_length]
    plan, faces = fill(cells(domain, around, inner), seeds)
    a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
    faces = np.where((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0)[:, None], faces[:, [0, 2, 1]], faces)
    on = cKDTree(fixed).query(plan)[0] <= 1e-9 * edge_length
    heights = np.zeros(len(plan))
    heights[on] = _heights_on_curves(plan[on], [outline, *holes, *creases])
    vertices = np.column_stack([plan, _heights_between(plan, faces, on, heights)])
    place = cKDTree(plan)
    return Outlined(vertices, faces, [place.query(line)[1].tolist() for line in inner])


def fill(areas: Sequence[Cell], seeds: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the points (n, 2) and triangles (m, 3) of areas that are triangulated one by one and share their sides."""
    import shapely
    from compas_cgal.triangulation import constrained_delaunay_triangulation

    points, faces, count = [], [], 0
    for area in areas:
        own = seeds[shapely.contains_xy(area.polygon, seeds)]
        rings = [_level(ring[:-1]) for ring in map(shapely.get_coordinates, (area.polygon.exterior, *area.polygon.interiors))]
        # Without points of its own the triangulation wants one of the ring's.
        inner = _level(own).tolist() or rings[0][:1].tolist()
        found = constrained_delaunay_triangulation(rings[0], inner, rings[1:], [_level(line) for line in area.loose])
        points.append(np.asarray(found[0])[:, :2])
        faces.append(np.asarray(found[1], dtype=np.int64) + count)
        count += len(points[-1])
    joined = weld(_level(np.concatenate(points)), np.concatenate(faces), 0.0)
    return joined.vertices[:, :2], joined.faces


def _level(points: FloatArray) -> FloatArray:
    return np.column_stack([points, np.zeros(len(points))])


def _heights_on_curves(plan: FloatArray, curves: Sequence[FloatArray]) -> FloatArray:
    """Return the heights of the curves that points (k, 2) lie on, of the first where they cross (k,) [L]."""
    flat = _level(plan)
    distances, heights = [], []
    for curve in curves:
        under = np.asarray(curve) * [1.0, 1.0, 0.0]
        gap, position = nearest_on_polyline(flat, under)
        distances.append(gap)
        heights.append(np.interp(position, arc_lengths(under), np.asarray(curve)[:, 2]))
    gaps = np.array(distances)
    first = np.argmax(gaps <= gaps.min(axis=0) + 1e-9 * np.ptp(plan), axis=0)
    return np.array(heights)[first, np.arange(len(plan))]


def _heights_between(plan: FloatArray, faces: IntArray, known: Mask, heights: FloatArray) -> FloatArray:
    """Return heights (n,) that are the mean of their neighbours' where they are not known [L]."""
    free = np.flatnonzero(~known)
    if not len(free) or not heights[known].any():
        return heights
    joined = edge_net(np.column_stack([plan, heights]), faces).lengths
    joined.data[:] = 1.0
    laplacian = sparse.diags(np.asarray(joined.sum(axis=1)).ravel()) - joined
    result = heights.copy()
    result[free] = spsolve(laplacian[free][:, free].tocsc(), -(laplacian[free] @ heights))
    return result
