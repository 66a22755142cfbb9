"""Choice of the best triangulation in plan among several lattices and grades, by valence and smallest angle."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.plan import flattened
from .boundary import boundary_loops
from .curve_sampling import Cell
from .curve_sampling import Spread
from .curve_sampling import cells
from .curve_sampling import lattices
from .edge_flips import valences
from .relaxation import plane_angles
from .relaxation import relaxed
from .valence_annealing import annealed
from .weld import weld

__all__ = ["best_triangles", "fill"]

CLEARANCES = (0.56, 0.62)  # distances of a lattice from curves that are tried, relative to the edge length
FIRST_TRIES, GOOD_QUALITY = 16, 0.9  # number of triangulations tried first, and the quality that ends the search
ANNEALED_TRIES = 3  # number of the best ones that are annealed if none is good
GOOD_ANGLE = 27.0  # degrees; above this smallest angle only valences matter
GRADES = (0.25, 0.15, 0.1)  # growth of edge lengths per distance from a small feature
MAX_GRADED = 1000  # number of vertices above which no smaller grade is tried


class _Triangles(NamedTuple):
    """A triangulation in plan."""

    plan: FloatArray  # (n, 2) [L]
    faces: IntArray  # (m, 3), counterclockwise
    held: Mask  # (n,) fixed points
    kept: IntArray  # (k, 2) fixed edges besides those on the boundary
    quality: float  # share of inner vertices with valence 6, less a penalty for small angles


def best_triangles(domain: shapely.Polygon, lay: Callable[[float], Spread]) -> tuple[Spread, FloatArray, IntArray]:
    """Return points spread along curves, and the best points (n, 2) and triangles (m, 3) between them.

    Parameters
    ----------
    domain
        Area to be filled.
    lay
        Function that spreads points along the curves for a grade.
    """
    found: list[tuple[Spread, _Triangles]] = []
    for grade in GRADES:
        laid = lay(grade)
        tried = iter(_between(domain, laid))
        found.append((laid, _best(islice(tried, FIRST_TRIES), laid)))
        if found[-1][1].quality >= GOOD_QUALITY or len(found[-1][1].plan) > MAX_GRADED:
            break
        if not laid.sizes.graded:
            found.append((laid, _best(tried, laid)))
            break
    laid, best = max(found, key=lambda one: one[1].quality)
    return laid, best.plan, best.faces


def fill(areas: Sequence[Cell], seeds: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the points (n, 2) and triangles (m, 3) of areas that are triangulated separately and share their sides."""
    from compas_cgal.triangulation import constrained_delaunay_triangulation

    points, faces, count = [], [], 0
    for area in areas:
        own = seeds[shapely.contains_xy(area.polygon, seeds)]
        rings = [flattened(ring[:-1]) for ring in map(shapely.get_coordinates, (area.polygon.exterior, *area.polygon.interiors))]
        # The triangulation needs at least one point; without inner ones give a point of the ring.
        inner = flattened(own).tolist() or rings[0][:1].tolist()
        found = constrained_delaunay_triangulation(rings[0], inner, rings[1:], [flattened(line) for line in area.loose])
        points.append(np.asarray(found[0])[:, :2])
        faces.append(np.asarray(found[1], dtype=np.int64) + count)
        count += len(points[-1])
    joined = weld(flattened(np.concatenate(points)), np.concatenate(faces), 0.0)
    return joined.vertices[:, :2], joined.faces


def _between(domain: shapely.Polygon, laid: Spread) -> Iterable[_Triangles]:
    """Yield relaxed triangulations with lattices at several clearances from fixed points."""
    areas = cells(domain, laid.rings, laid.pieces)
    fixed = np.concatenate([*laid.rings, *laid.pieces, laid.loose])
    for lattice in lattices(domain, laid.sizes):
        gap, size = cKDTree(fixed).query(lattice)[0], laid.sizes(lattice)
        for clear in CLEARANCES:
            plan, faces = fill(areas, np.concatenate([lattice[gap > clear * size], laid.loose]))
            a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
            faces = np.where((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0)[:, None], faces[:, [0, 2, 1]], faces)
            held, kept = _held(laid, fixed, plan)
            yield _judged(*relaxed(plan, faces, held, kept, laid.sizes), held, kept)


def _best(tried: Iterable[_Triangles], laid: Spread) -> _Triangles:
    """Return the best triangulation; anneal the best three if none is good."""
    first = sorted(tried, key=lambda one: -one.quality)
    best = first[0]
    for one in first[:ANNEALED_TRIES]:
        if best.quality >= GOOD_QUALITY:
            break
        plan, faces = annealed(*one[:4], laid.sizes)
        fixed = np.concatenate([*laid.rings, *laid.pieces, laid.loose])
        best = max(best, _judged(plan, faces, *_held(laid, fixed, plan)), key=lambda one: one.quality)
    return best


def _held(laid: Spread, fixed: FloatArray, plan: FloatArray) -> tuple[Mask, IntArray]:
    """Return the fixed points (n,) and fixed edges (k, 2) of a triangulation."""
    place = cKDTree(plan)
    held = np.zeros(len(plan), bool)
    held[place.query(fixed)[1]] = True
    paths = [place.query(piece)[1] for piece in laid.pieces]
    return held, np.concatenate([np.empty((0, 2), np.int64), *(np.column_stack([path[:-1], path[1:]]) for path in paths)])


def _judged(plan: FloatArray, faces: IntArray, held: Mask, kept: IntArray) -> _Triangles:
    loops = boundary_loops(faces)
    inner = np.ones(len(plan), bool)
    inner[np.concatenate(loops)] = False
    regular = float(np.mean(valences(len(plan), faces)[inner] == 6)) if inner.any() else 1.0
    # Angles between two curves are given by the drawing.
    n = len(plan)
    still = np.concatenate([kept, *(np.column_stack([loop, np.roll(loop, -1)]) for loop in loops)])
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    on_curve = np.isin(sides.min(axis=-1) * n + sides.max(axis=-1), still.min(axis=1) * n + still.max(axis=1))
    between = on_curve & np.roll(on_curve, 1, axis=1)
    smallest = float(np.degrees(plane_angles(plan, faces)[~between].min(initial=np.pi)))
    return _Triangles(plan, faces, held, kept, regular + 0.05 * min(0.0, smallest - GOOD_ANGLE))
