"""Mesh generation from an outline, holes and creases in plan."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.plan import flattened
from ..errors import MeshError
from .boundary import boundary_loops
from .edge_flips import valences
from .polyline import arc_lengths
from .polyline import nearest_on_polyline
from .relaxation import plane_angles
from .relaxation import relaxed
from .weld import weld

if TYPE_CHECKING:
    import shapely

    from .curve_sampling import Cell
    from .curve_sampling import Spread

CLEAR = (0.56, 0.62)  # of the edge length, that a lattice keeps away from curves: both are tried
MOST_DENSE, NEIGHBOURS = 1500, 150  # known heights that are fitted at once, and around each point where there are more
MET = 0.2  # of the edge length, within which a point has become a vertex
LARGEST = 2e6  # vertices that a mesh may have
FIRST, GOOD = 16, 0.9  # triangulations that are tried anyway, and the quality at which no more are
ENOUGH = 27.0  # degrees of the smallest angle, above which the valences decide

__all__ = ["Outlined", "fill", "mesh_from_outline", "refuse_passed_over"]


class Outlined(NamedTuple):
    """A mesh made from curves."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3), upwards
    creases: list[list[int]]  # vertex paths along the creases


def mesh_from_outline(
    outline: FloatArray,
    holes: Sequence[FloatArray],
    creases: Sequence[FloatArray],
    edge_length: float,
    tolerance: float,
    points: Optional[FloatArray] = None,
) -> Outlined:
    """Fill an outline with near-equilateral triangles, most vertices of valence 6, whose edges follow all the curves.

    A triangular lattice fills the plan; along the curves it gives way to points spread
    evenly on them, closer together at small features, and is relaxed. Of several lattices the one that gives the best
    triangles is taken. Heights are those of the curves and as smooth as can be between them.

    Parameters
    ----------
    outline
        ``(k, 3)`` points around the boundary, the first again at the end or not [L].
    holes
        The same for holes in it.
    creases
        ``(k, 3)`` points along each crease; what lies outside is left out.
    edge_length
        Length of edges aimed at [L].
    tolerance
        Length below which two points are one [L].
    points
        ``(k, 3)`` places that become vertices, such as columns; heights count where no curve passes [L]. Over curves that
        are all at one height only they have heights of their own. Those outside of the outline are passed over.

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
        from .curve_sampling import lattices
        from .curve_sampling import spread
    except ImportError as error:
        raise MeshError(f"a mesh from curves needs {error.name}; install it: pip install 'compas_cgc[mesher]'") from None
    if not _is_length(edge_length):
        raise MeshError(f"the edge length must be above zero, a number in the unit of the outline, not {edge_length!r}")
    outline, *holes = (_closed(np.asarray(ring), tolerance) for ring in (outline, *holes))
    rings = [ring[:, :2] for ring in (outline, *holes)]
    domain = shapely.Polygon(rings[0], rings[1:])
    if not domain.is_valid or domain.area < edge_length**2:
        raise MeshError(f"the outline and its holes do not bound an area that can be meshed: {_fault(domain, outline, edge_length)}")
    expected = domain.area / (edge_length**2 * np.sqrt(3) / 2)
    if expected > LARGEST:
        raise MeshError(
            f"edges of {edge_length:g} would fill this outline with {expected:.2g} vertices; choose a longer edge, "
            f"such as {np.sqrt(domain.area) / 20:.2g}, and see that outline and edge are in the same unit"
        )
    given = np.empty((0, 3)) if points is None else np.asarray(points, dtype=np.float64).reshape(-1, 3)
    laid = spread(domain, rings, [np.asarray(crease)[:, :2] for crease in creases], given[:, :2], edge_length, tolerance)
    around, inner = laid.rings, laid.pieces
    areas = cells(domain, around, inner)
    fixed = np.concatenate([*around, *inner, laid.loose])
    plan, faces = _best(_tried(laid, areas, fixed, seeds, clear) for seeds in lattices(domain, laid.sizes) for clear in CLEAR)
    if _quality(plan, faces) < GOOD:
        plan, faces = _annealed(laid, fixed, plan, faces)
    on_curves = np.concatenate([*around, *inner])
    on = cKDTree(on_curves).query(plan)[0] <= 1e-9 * edge_length
    heights = np.zeros(len(plan))
    heights[on] = _heights_on_curves(plan[on], [outline, *holes, *creases])
    known = on.copy()
    if len(laid.loose) and given[:, 2].any():
        at = cKDTree(plan).query(laid.loose)[1]
        heights[at] = given[cKDTree(given[:, :2]).query(laid.loose)[1], 2]
        known[at] = True
    if np.ptp(heights[on]):
        heights = _heights_between(plan, known, heights)
    else:
        # Points over level curves are heads of columns: what sheet goes over them is for the solve to say.
        heights[~known] = heights[on][0]
    vertices = np.column_stack([plan, heights])
    place = cKDTree(plan)
    return Outlined(vertices, faces, [place.query(line)[1].tolist() for line in inner])


def refuse_outside(outline: FloatArray, creases: Sequence[FloatArray]) -> None:
    """Refuse creases (k, 3) of which nothing lies within the outline (k, 3), so that they would be lost.

    Raises
    ------
    MeshError
        With the place of one.
    """
    import shapely

    if len(outline) < 3:
        return
    within = shapely.Polygon(outline[:, :2])
    for k, line in enumerate(creases):
        if within.is_valid and len(line) > 1 and not within.intersects(shapely.LineString(line[:, :2])):
            x, y = line[0, :2]
            raise MeshError(f"creases[{k}], from ({x:g}, {y:g}), lies outside of the outline; move it inside, or leave it out")


def refuse_passed_over(made: Outlined, points: FloatArray, edge_length: float) -> None:
    """Refuse points (k, 3) that no vertex of a mesh became.

    Raises
    ------
    MeshError
        With a sentence that names the first of them and tells how far away it is.
    """
    gap = cKDTree(made.vertices[:, :2]).query(points[:, :2])[0]
    missed = np.flatnonzero(~(gap <= MET * edge_length))
    if len(missed):
        k = int(missed[0])
        more = f", nor do {len(missed) - 1} others" if len(missed) > 1 else ""
        raise MeshError(
            f"points[{k}] at ({points[k, 0]:.6g}, {points[k, 1]:.6g}) does not lie within the outline{more}; it is {gap[k]:.3g} from the "
            "nearest vertex; move it inside, or leave it out"
        )


def _is_length(value: object) -> bool:
    return isinstance(value, (int, float, np.number)) and 0.0 < float(value) < np.inf


def _fault(domain: shapely.Polygon, outline: FloatArray, edge_length: float) -> str:
    """Return what is wrong with a domain, and the mend."""
    import shapely

    lost = np.flatnonzero(~np.isfinite(outline).all(axis=1))
    if len(lost):
        return f"point {lost[0]} of the outline has a coordinate that is no finite number; give it one"
    said = shapely.is_valid_reason(domain)
    at = said.partition("[")[2].rstrip("]").replace(" ", ", ")
    if domain.area < MET * edge_length**2 and np.ptp(outline[:, 2]) > edge_length:
        return "seen from above it has hardly any; draw an upright outline laid flat, and stand the mesh up"
    if len(outline) > 2 and np.linalg.matrix_rank(outline[1:, :2] - outline[0, :2], tol=MET * edge_length) < 2:
        return "the points of the outline lie on one line; move one of them off it"
    if said.startswith("Self-intersection"):
        return f"a curve crosses itself or another one at ({at}); draw them apart"
    if said.startswith("Hole lies outside"):
        return f"the hole at ({at}) lies outside of the outline; move it inside, or leave it out"
    if said.startswith("Holes are nested"):
        return f"the hole at ({at}) lies in another hole; leave one of them out"
    if said.startswith("Too few points"):
        return "an outline needs three corners or more, and so does a hole"
    if domain.is_valid:
        return f"the area is less than that of an edge of {edge_length:g} squared; choose a shorter edge"
    return f"{said[:1].lower()}{said[1:]}; correct the curves"


def _closed(ring: FloatArray, tolerance: float) -> FloatArray:
    """Return a ring (k, 3) that ends where it begins, to the last digit."""
    ends = len(ring) > 1 and np.linalg.norm((ring[-1] - ring[0])[:2]) <= tolerance
    return np.concatenate([ring[:-1] if ends else ring, ring[:1]])


def _tried(laid: Spread, areas: Sequence[Cell], fixed: FloatArray, seeds: FloatArray, clear: float) -> tuple[FloatArray, IntArray]:
    """Return the relaxed triangulation with the seeds that keep a part of the edge length away from what is fixed."""
    seeds = seeds[cKDTree(fixed).query(seeds)[0] > clear * laid.sizes(seeds)]
    plan, faces = fill(areas, np.concatenate([seeds, laid.loose]))
    a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
    faces = np.where((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0)[:, None], faces[:, [0, 2, 1]], faces)
    return relaxed(plan, faces, *_held(laid, fixed, plan), laid.sizes)


def _held(laid: Spread, fixed: FloatArray, plan: FloatArray) -> tuple[Mask, IntArray]:
    """Return which points (n,) of a triangulation stay, and the edges (k, 2) that do."""
    place = cKDTree(plan)
    held = np.zeros(len(plan), bool)
    held[place.query(fixed)[1]] = True
    paths = [place.query(piece)[1] for piece in laid.pieces]
    return held, np.concatenate([np.empty((0, 2), np.int64), *(np.column_stack([path[:-1], path[1:]]) for path in paths)])


def _annealed(laid: Spread, fixed: FloatArray, plan: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Return a triangulation whose valences have been annealed, or the given one where that is better."""
    from .valence_annealing import annealed

    found = annealed(plan, faces, *_held(laid, fixed, plan), laid.sizes)
    return max((plan, faces), found, key=lambda one: _quality(*one))


def _best(made: Iterable[tuple[FloatArray, IntArray]]) -> tuple[FloatArray, IntArray]:
    """Return the best triangulation of the first, and of all where none of those is good."""
    tried: list[tuple[float, FloatArray, IntArray]] = []
    for plan, faces in made:
        tried.append((_quality(plan, faces), plan, faces))
        if len(tried) % FIRST == 0 and max(quality for quality, _, _ in tried) >= GOOD:
            break
    return max(tried, key=lambda one: one[0])[1:]


def _quality(plan: FloatArray, faces: IntArray) -> float:
    """Return how good triangles are: the part of vertices with valence 6, less what the smallest angle lacks."""
    smallest = float(np.degrees(plane_angles(plan, faces).min()))
    inner = np.ones(len(plan), bool)
    for loop in boundary_loops(faces):
        inner[loop] = False
    regular = float(np.mean(valences(len(plan), faces)[inner] == 6)) if inner.any() else 1.0
    return regular + 0.05 * min(0.0, smallest - ENOUGH)


def fill(areas: Sequence[Cell], seeds: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the points (n, 2) and triangles (m, 3) of areas that are triangulated one by one and share their sides."""
    import shapely
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


def _heights_on_curves(plan: FloatArray, curves: Sequence[FloatArray]) -> FloatArray:
    """Return the heights of the curves that points (k, 2) lie on, of the first where they cross (k,) [L]."""
    flat = flattened(plan)
    distances, heights = [], []
    for curve in curves:
        under = np.asarray(curve) * [1.0, 1.0, 0.0]
        gap, position = nearest_on_polyline(flat, under)
        distances.append(gap)
        heights.append(np.interp(position, arc_lengths(under), np.asarray(curve)[:, 2]))
    gaps = np.array(distances)
    first = np.argmax(gaps <= gaps.min(axis=0) + 1e-9 * np.ptp(plan), axis=0)
    return np.array(heights)[first, np.arange(len(plan))]


def _heights_between(plan: FloatArray, known: Mask, heights: FloatArray) -> FloatArray:
    """Return heights (n,) that are those of a thin plate through the known ones [L].

    A membrane would sag between two arches, where a plate is all but ruled.
    """
    free = np.flatnonzero(~known)
    if not len(free):
        return heights
    from scipy.interpolate import RBFInterpolator

    result = heights.copy()
    near = None if np.count_nonzero(known) <= MOST_DENSE else NEIGHBOURS
    result[free] = RBFInterpolator(plan[known], heights[known], neighbors=near, kernel="thin_plate_spline")(plan[free])
    return result
