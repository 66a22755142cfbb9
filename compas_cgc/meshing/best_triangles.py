"""Triangulations in plan: of several lattices and grades the one with the most valences of 6 and no small angle."""

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

CLEAR = (0.56, 0.62)  # of the edge length, that a lattice keeps away from curves: both are tried
FIRST, GOOD = 16, 0.9  # triangulations that are tried at once, and the quality at which no more is done
ANNEALED = 3  # of them, the best, where none is good
ENOUGH = 27.0  # degrees of the smallest angle, above which the valences decide
GRADES = (0.25, 0.15, 0.1)  # of the distance from a small feature, by which edges grow: from there to long edges take a dozen odd valences
MANY = 1000  # vertices, above which edges grow no slower: they would be more still


class _Triangles(NamedTuple):
    """A triangulation in plan."""

    plan: FloatArray  # (n, 2) [L]
    faces: IntArray  # (m, 3), anticlockwise
    held: Mask  # (n,) points that stay
    kept: IntArray  # (k, 2) edges that do, beside those on the boundary
    quality: float  # number: the part of inner vertices with valence 6, less what the smallest angle lacks


def best_triangles(domain: shapely.Polygon, lay: Callable[[float], Spread]) -> tuple[Spread, FloatArray, IntArray]:
    """Return points spread along curves with the best points (n, 2) and triangles (m, 3) found between them.

    Parameters
    ----------
    domain
        What is to be filled.
    lay
        Points along the curves for a part of the distance from small features by which edges grow.
    """
    found: list[tuple[Spread, _Triangles]] = []
    for grade in GRADES:
        laid = lay(grade)
        tried = iter(_between(domain, laid))
        found.append((laid, _best(islice(tried, FIRST), laid)))
        if found[-1][1].quality >= GOOD or len(found[-1][1].plan) > MANY:
            break
        if not laid.sizes.graded:
            found.append((laid, _best(tried, laid)))
            break
    laid, best = max(found, key=lambda one: one[1].quality)
    return laid, best.plan, best.faces


def fill(areas: Sequence[Cell], seeds: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the points (n, 2) and triangles (m, 3) of areas that are triangulated one by one and share their sides."""
    from compas_cgal.triangulation import constrained_delaunay_triangulation

    points, faces, count = [], [], 0
    for area in areas:
        own = seeds[shapely.contains_xy(area.polygon, seeds)]
        rings = [flattened(ring[:-1]) for ring in map(shapely.get_coordinates, (area.polygon.exterior, *area.polygon.interiors))]
        # Without points of its own the triangulation wants one of the ring's.
        inner = flattened(own).tolist() or rings[0][:1].tolist()
        found = constrained_delaunay_triangulation(rings[0], inner, rings[1:], [flattened(line) for line in area.loose])
        points.append(np.asarray(found[0])[:, :2])
        faces.append(np.asarray(found[1], dtype=np.int64) + count)
        count += len(points[-1])
    joined = weld(flattened(np.concatenate(points)), np.concatenate(faces), 0.0)
    return joined.vertices[:, :2], joined.faces


def _between(domain: shapely.Polygon, laid: Spread) -> Iterable[_Triangles]:
    """Yield relaxed triangulations with lattices that keep a part of the edge length away from what is fixed."""
    areas = cells(domain, laid.rings, laid.pieces)
    fixed = np.concatenate([*laid.rings, *laid.pieces, laid.loose])
    for lattice in lattices(domain, laid.sizes):
        gap, size = cKDTree(fixed).query(lattice)[0], laid.sizes(lattice)
        for clear in CLEAR:
            plan, faces = fill(areas, np.concatenate([lattice[gap > clear * size], laid.loose]))
            a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
            faces = np.where((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0)[:, None], faces[:, [0, 2, 1]], faces)
            held, kept = _held(laid, fixed, plan)
            yield _judged(*relaxed(plan, faces, held, kept, laid.sizes), held, kept)


def _best(tried: Iterable[_Triangles], laid: Spread) -> _Triangles:
    """Return the best triangulation, or the best of the first three as annealed where none is good."""
    first = sorted(tried, key=lambda one: -one.quality)
    best = first[0]
    for one in first[:ANNEALED]:
        if best.quality >= GOOD:
            break
        plan, faces = annealed(*one[:4], laid.sizes)
        fixed = np.concatenate([*laid.rings, *laid.pieces, laid.loose])
        best = max(best, _judged(plan, faces, *_held(laid, fixed, plan)), key=lambda one: one.quality)
    return best


def _held(laid: Spread, fixed: FloatArray, plan: FloatArray) -> tuple[Mask, IntArray]:
    """Return which points (n,) of a triangulation stay, and the edges (k, 2) that do."""
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
    # An angle between two curves is the drawing's.
    n = len(plan)
    still = np.concatenate([kept, *(np.column_stack([loop, np.roll(loop, -1)]) for loop in loops)])
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    on_curve = np.isin(sides.min(axis=-1) * n + sides.max(axis=-1), still.min(axis=1) * n + still.max(axis=1))
    between = on_curve & np.roll(on_curve, 1, axis=1)
    smallest = float(np.degrees(plane_angles(plan, faces)[~between].min(initial=np.pi)))
    return _Triangles(plan, faces, held, kept, regular + 0.05 * min(0.0, smallest - ENOUGH))
