"""Triangle meshes of trimmed parametric surfaces with given boundary points."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from .edge_flips import flipped
from .edge_flips import turn
from .kinks import KINK_ANGLE
from .kinks import angles_between
from .kinks import sharp_parameters
from .kinks import sharp_seam
from .weld import clean_faces
from .weld import weld

if TYPE_CHECKING:
    import shapely

__all__ = ["FaceMesh", "SurfaceMesh", "mesh_face", "mesh_from_surface"]

GRID_SIZE = 24  # divisions of the domain for measuring lengths
MIN_DISTANCE = 0.75  # distance between points relative to the edge length
REFINEMENT = 3  # refinement of the lattice that fills gaps
SMOOTHINGS = 6
SIDE_SAMPLES = 512  # divisions of a side for measuring its length
WELD_DISTANCE = 1e-6  # distance relative to the edge length within which points of two sides coincide
KINK_TOLERANCE = 1e-6  # distance from a kink relative to the parameter range
MIN_AREA_SHARE = 0.98  # least share of the largest part of an area

Evaluate = Callable[[FloatArray], FloatArray]


class FaceMesh(NamedTuple):
    """Mesh of a face; the points of its loops come first, in order."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3), counterclockwise in parameter space
    deviation: float  # largest distance between a triangle's centre and the surface there [L]
    kinks: tuple[FloatArray, ...] = ()  # (k, 3) polylines along mesh edges on kinks, then on given curves [L]


class SurfaceMesh(NamedTuple):
    """Mesh of a whole surface."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    deviation: float  # largest distance between a triangle's centre and the surface there [L]
    creases: list[list[int]]  # vertices along each kink


def mesh_face(
    evaluate: Evaluate,
    loops: Sequence[FloatArray],
    points: Sequence[FloatArray],
    edge_length: float,
    kinks: Sequence[tuple[int, float]] = (),
    curves: Sequence[FloatArray] = (),
) -> FaceMesh:
    """Return a mesh of near-equilateral triangles within the loops of a trimmed surface.

    Points of a triangular lattice, measured along the surface, are kept if their distances in space suffice. A constrained
    Delaunay triangulation in parameter space is flipped to a Delaunay triangulation in space.

    Parameters
    ----------
    evaluate
        Function from parameters (k, 2) to points (k, 3).
    loops
        ``(k, 2)`` parameters around the face, the outer loop first, the first point not repeated.
    points
        ``(k, 3)`` points of the loops, which become vertices [L].
    edge_length
        Target edge length [L].
    kinks
        Kinks as pairs of parameter axis, 0 or 1, and value. Mesh edges run along a kink if the loops have points at both of its
        ends.
    curves
        Parameters (k, 2) of points along curves that become mesh edges. Ends on the boundary are points of the loops; curves do not
        cross each other or kinks.

    Raises
    ------
    MeshError
        If the mesher is not installed, or the loops do not enclose an area.
    """
    try:
        import shapely

        from .best_triangles import fill
        from .curve_sampling import Cell
        from .curve_sampling import cells
        from .curve_sampling import lattice
    except ImportError as error:
        raise MeshError(f"meshing surfaces needs {error.name}; install it: pip install 'compas_cgc[mesher]'") from None
    to_lengths, to_parameters = _unrolled(evaluate, np.concatenate(loops))
    rings = [to_lengths(loop) for loop in loops]
    rim, places = np.concatenate(rings), np.concatenate(points)
    domain = _repaired(shapely.Polygon(rings[0], rings[1:]))
    corners = shapely.get_coordinates(domain)
    strange = corners[cKDTree(rim).query(corners)[0] > 0.0]
    rim, places = np.concatenate([rim, strange]), np.concatenate([places, evaluate(to_parameters(strange))])
    lines = _kink_lines(evaluate, domain, loops, kinks, edge_length) if not len(strange) else []
    lines += curves if not len(strange) else []
    flat = [to_lengths(line) for line in lines]
    ends = np.array([line[k] for line in lines for k in (0, -1)]).reshape(-1, 2)
    # Ends of lines at crossings of kinks, which no loop has a point at.
    crossings = np.unique(ends[cKDTree(np.concatenate(loops)).query(ends)[0] > 0.0], axis=0)
    within = [*(line[1:-1] for line in lines), crossings]
    rim = np.concatenate([rim, *(to_lengths(line) for line in within)])
    places = np.concatenate([places, *(evaluate(line) for line in within)])
    seeds = np.concatenate([lattice(domain, edge_length / finer) for finer in (1, REFINEMENT)])
    spots = evaluate(to_parameters(seeds)) if len(seeds) else np.empty((0, 3))
    chosen = _apart(spots, places, MIN_DISTANCE * edge_length)
    plan, faces = fill(cells(domain, rings, flat) if flat else [Cell(domain, [])], seeds[chosen])
    # The triangulation reorders the points.
    known = np.concatenate([rim, seeds[chosen]])
    order = cKDTree(known).query(plan)[1]
    faces = order[faces]
    plan, place = known, np.concatenate([places, spots[chosen]])
    a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
    faces = np.where((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0)[:, None], faces[:, [0, 2, 1]], faces)
    held = len(rim)
    paths = [cKDTree(known).query(line)[1] for line in flat]
    kept = _edge_keys(len(plan), paths)
    for _ in range(SMOOTHINGS):
        faces = _delaunay(plan, place, faces, kept)
        plan, place = _smoothed(plan, place, faces, held, lambda new: evaluate(to_parameters(new)))
    faces = _delaunay(plan, place, faces, kept)
    # Measure along normals, because near a pole the centres in parameter space and in space differ along the surface.
    gap = evaluate(to_parameters(plan[faces].mean(axis=1))) - place[faces].mean(axis=1)
    deviation = float(np.abs(np.einsum("ij,ij->i", gap, face_normals(place, faces))).max(initial=0.0))
    return FaceMesh(place, faces, deviation, tuple(place[path] for path in paths))


def _kink_lines(
    evaluate: Evaluate, domain: shapely.Polygon, loops: Sequence[FloatArray], kinks: Sequence[tuple[int, float]], edge_length: float
) -> list[FloatArray]:
    """Return evenly spaced parameters (k, 2) along kinks between loop points on them."""
    import shapely

    rim = np.concatenate(loops)
    size = np.ptp(rim, axis=0)
    area = shapely.Polygon(loops[0], loops[1:])
    found = []
    for axis, value in kinks:
        on = rim[np.abs(rim[:, axis] - value) <= KINK_TOLERANCE * size[axis]]
        crossing = np.array([[value, other] if axis == 0 else [other, value] for way, other in kinks if way != axis]).reshape(-1, 2)
        inside = shapely.contains_xy(area, crossing) & (cKDTree(rim).query(crossing)[0] > KINK_TOLERANCE * float(size.max()))
        on = np.concatenate([on, crossing[inside]])
        on = on[np.argsort(on[:, 1 - axis], kind="stable")]
        for first, last in zip(on[:-1], on[1:]):
            middle = shapely.Point(0.5 * (first + last))
            if area.contains(middle) and area.boundary.distance(middle) > KINK_TOLERANCE * float(size.min()):
                found.append(_divided_side(evaluate, first, last, edge_length))
    return found


def _edge_keys(count: int, paths: Sequence[IntArray]) -> IntArray:
    """Return a unique number for every edge along paths of vertices."""
    ends = np.concatenate([np.empty((0, 2), np.int64), *(np.column_stack([path[:-1], path[1:]]) for path in paths)])
    return ends.min(axis=1, initial=count) * count + ends.max(axis=1, initial=0)


def _repaired(domain: shapely.Polygon) -> shapely.Polygon:
    """Return the area enclosed by loops, without small parts from self-overlaps."""
    import shapely

    if domain.is_valid and domain.area > 0:
        return domain
    parts = [part for part in shapely.get_parts(shapely.make_valid(domain)) if part.geom_type == "Polygon"]
    whole = sum(part.area for part in parts)
    largest = max(parts, key=lambda part: part.area, default=None)
    if largest is None or largest.area < MIN_AREA_SHARE * max(whole, shapely.convex_hull(domain).area * 0.01):
        raise MeshError("the edges of a face do not enclose an area in its parameter space; repair the face in the drawing")
    return largest


def _unrolled(evaluate: Evaluate, rim: FloatArray) -> tuple[Evaluate, Evaluate]:
    """Return the functions from parameters (k, 2) to lengths along them, and back."""
    low, high = rim.min(axis=0), rim.max(axis=0)
    t = np.linspace(0.0, 1.0, GRID_SIZE + 1)
    u, v = (a + (b - a) * t for a, b in zip(low, high))
    grid = evaluate(np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)).reshape(GRID_SIZE + 1, GRID_SIZE + 1, 3)
    tables = []
    for axis, values in enumerate((u, v)):
        steps = np.linalg.norm(np.diff(grid, axis=axis), axis=2).max(axis=1 - axis)
        steps = np.maximum(steps, 1e-9 * max(steps.max(), 1e-300))
        tables.append((values, np.concatenate([[0.0], np.cumsum(steps)])))

    def forth(parameters: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(parameters[:, k], *tables[k]) for k in range(2)])

    def back(lengths: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(lengths[:, k], *tables[k][::-1]) for k in range(2)])

    return forth, back


def _apart(spots: FloatArray, taken: FloatArray, distance: float) -> IntArray:
    """Return the indices of points (k, 3), in order, at a distance from `taken` (m, 3) and from each other."""
    free = np.ones(len(spots), bool)
    if not len(spots):
        return np.flatnonzero(free)
    free &= cKDTree(taken).query(spots)[0] >= distance
    tree = cKDTree(spots)
    for i in range(len(spots)):
        if free[i]:
            # Only the neighbours of the points that stay: where a surface is squeezed, all others have thousands.
            free[tree.query_ball_point(spots[i], distance)] = False
            free[i] = True
    return np.flatnonzero(free)


def _delaunay(plan: FloatArray, place: FloatArray, faces: IntArray, kept: IntArray) -> IntArray:
    """Return triangles after flips of edges whose opposite angles in space add up to more than π."""
    return flipped(plan, faces, kept, lambda e: _angle(place, e.c, e.a, e.b) + _angle(place, e.d, e.a, e.b) - np.pi - 1e-6)


def _angle(P: FloatArray, at: IntArray, one: IntArray, other: IntArray) -> FloatArray:
    x, y = P[one] - P[at], P[other] - P[at]
    return np.arctan2(np.linalg.norm(np.cross(x, y), axis=1), np.einsum("ij,ij->i", x, y))


def _smoothed(plan: FloatArray, place: FloatArray, faces: IntArray, held: int, evaluate: Evaluate) -> tuple[FloatArray, FloatArray]:
    """Return parameters (n, 2) and points (n, 3) with free points moved half way to the mean of their neighbours."""
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    count = np.bincount(np.r_[u, v], minlength=len(plan))
    near = np.column_stack([np.bincount(np.r_[u, v], np.r_[plan[v, k], plan[u, k]], len(plan)) for k in range(2)])
    moved = plan.copy()
    free = np.arange(len(plan)) >= held
    free &= count > 0
    moved[free] = 0.5 * plan[free] + 0.5 * near[free] / count[free, None]
    # Points that would invert a triangle are not moved.
    for _ in range(5):
        turned = faces[turn(moved, *faces.T) <= 0]
        if not len(turned):
            break
        moved[turned.ravel()] = plan[turned.ravel()]
    spots = place.copy()
    if free.any():
        spots[free] = evaluate(moved[free])
    return moved, spots


def mesh_from_surface(
    evaluate: Evaluate,
    domain: tuple[tuple[float, float], tuple[float, float]],
    edge_length: float,
    spans: tuple[Sequence[float], Sequence[float]] = ((), ()),
) -> SurfaceMesh:
    """Return a mesh of an untrimmed parametric surface, with creases along kinks and welded seams.

    Parameters
    ----------
    evaluate
        Function from parameters (k, 2) to points (k, 3).
    domain
        First and last parameter in both directions.
    edge_length
        Target edge length [L].
    spans
        Knots in both directions, the only possible positions of kinks and of corners of sides.

    Raises
    ------
    MeshError
        If the mesher is not installed, or the surface has no area.
    """
    (u0, u1), (v0, v1) = domain
    whole = np.array(domain, dtype=np.float64)
    kinks = sharp_parameters(evaluate, whole, spans)
    corners = np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1], [u0, v0]], dtype=np.float64)
    stops = [stop for k in range(4) for stop in _stops(evaluate, corners[k], corners[k + 1], k % 2, kinks, spans[k % 2])]
    loop = np.concatenate([_divided_side(evaluate, a, b, edge_length)[:-1] for a, b in zip(stops, [*stops[1:], stops[0]])])
    made = mesh_face(evaluate, [loop], [evaluate(loop)], edge_length, kinks)
    joined = weld(made.vertices, made.faces, WELD_DISTANCE * edge_length)
    clean = clean_faces(joined.faces)
    lines = list(made.kinks)
    for axis in range(2):
        if sharp_seam(evaluate, whole, axis, WELD_DISTANCE * edge_length):
            side = loop[loop[:, axis] == whole[axis, 0]]
            lines.append(evaluate(side[np.argsort(side[:, 1 - axis])]))
    tree = cKDTree(joined.vertices)
    return SurfaceMesh(joined.vertices, clean.faces, made.deviation, [tree.query(line)[1].tolist() for line in lines])


def _stops(
    evaluate: Evaluate, first: FloatArray, last: FloatArray, axis: int, kinks: Sequence[tuple[int, float]], knots: Sequence[float]
) -> list[FloatArray]:
    """Return the parameters (2,) of vertices on a side: start, kinks and corners."""
    low, high = sorted((first[axis], last[axis]))
    step = 1e-5 * (high - low) * np.eye(2)[axis]
    found = {value for way, value in kinks if way == axis}
    for knot in (float(knot) for knot in knots if low < knot < high):
        at = np.where(np.arange(2) == axis, knot, first)
        before, here, after = evaluate(np.array([at - step, at, at + step]))
        if angles_between((here - before)[None], (after - here)[None])[0] > KINK_ANGLE:
            found.add(knot)
    ordered = sorted(found, reverse=bool(last[axis] < first[axis]))
    return [first, *(np.where(np.arange(2) == axis, value, first) for value in ordered)]


def _divided_side(evaluate: Evaluate, first: FloatArray, last: FloatArray, edge_length: float) -> FloatArray:
    """Return parameters (k, 2) along a side, evenly spaced in space."""
    t = np.linspace(0.0, 1.0, SIDE_SAMPLES + 1)
    places = evaluate(first + t[:, None] * (last - first))
    at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    if at[-1] <= WELD_DISTANCE * edge_length:
        return np.array([first, last])
    number = max(1, round(float(at[-1]) / edge_length))
    return first + np.interp(np.linspace(0.0, at[-1], number + 1), at, t)[:, None] * (last - first)
