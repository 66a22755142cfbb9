"""Mesh generation from an outline, holes and creases in plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.plan import flattened
from ..errors import MeshError
from .polyline import arc_lengths
from .polyline import nearest_on_polyline

if TYPE_CHECKING:
    import shapely

MOST_DENSE, NEIGHBOURS = 1500, 150  # known heights that are fitted at once, and around each point where there are more
MET = 0.2  # of the edge length, within which a point has become a vertex
LARGEST = 2e6  # vertices that a mesh may have
GRAZED, WIDER = 0.25, 0.1  # of the edge length, along which a crease is all but on an edge, and less than which it is away as far again
ALONG = 32  # places for each edge length at which that is measured

__all__ = ["Outlined", "mesh_from_outline", "refuse_passed_over"]


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

        from .best_triangles import best_triangles
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
    lines = [np.asarray(crease)[:, :2] for crease in creases]
    _refuse_grazing(domain, lines, edge_length)
    laid, plan, faces = best_triangles(domain, lambda grade: spread(domain, rings, lines, given[:, :2], edge_length, tolerance, grade))
    around, inner = laid.rings, laid.pieces
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


def _refuse_grazing(domain: shapely.Polygon, creases: Sequence[FloatArray], edge_length: float) -> None:
    """Refuse creases (k, 2) that come up to the edge of a domain, or to another crease, and leave it again without having crossed it.

    Raises
    ------
    MeshError
        With the place of one.
    """
    import shapely

    from .sizing import NARROWEST

    far, curves = round(GRAZED * ALONG), [shapely.LineString(line) for line in creases]
    for k, curve in enumerate(curves):
        number = max(2, int(np.ceil(ALONG * curve.length / edge_length)))
        # Twice around a closed one, which may begin where it grazes.
        places = np.arange((2 if curve.is_closed else 1) * number + 1) / number
        spots = shapely.line_interpolate_point(curve, places % 1.0 if curve.is_closed else places, normalized=True)
        inside = shapely.contains(domain, spots)
        for j, gap in enumerate(shapely.distance(other, spots) for other in (domain.boundary, *curves[:k])):
            changes = np.diff(((gap < NARROWEST * edge_length) & (inside | (j == 0))).astype(np.int64), prepend=0, append=0)
            for begin, end in zip(np.flatnonzero(changes > 0).tolist(), np.flatnonzero(changes < 0).tolist()):
                beside = np.array([begin - far, end - 1 + far])
                # Where two curves cross, the sides of the place are not the same, one of them outside of a domain.
                if (
                    end - begin > far
                    and beside[0] >= 0
                    and beside[1] < len(spots)
                    and inside[beside].all()
                    and (gap[beside] < WIDER * edge_length).all()
                    and (j == 0 or _on_one_side(curves[j - 1], spots[beside]))
                ):
                    x, y = shapely.get_coordinates(spots[begin + int(np.argmin(gap[begin:end]))])[0]
                    what = f"creases[{j - 1}]" if j else "the edge of the outline or of a hole"
                    raise MeshError(
                        f"creases[{k}] grazes {what} at ({x:.3f}, {y:.3f}), where triangles have no room; "
                        f"let it end there or cross {'it' if j else 'the edge'}, or keep {WIDER * edge_length:.2g} away from it"
                    )


def _on_one_side(curve: shapely.LineString, spots: NDArray[np.object_]) -> bool:
    """Tell whether two points lie on the same side of a curve, to the right or to the left of it."""
    import shapely

    at = shapely.line_locate_point(curve, spots)
    foot = shapely.get_coordinates(shapely.line_interpolate_point(curve, at))
    step = 1e-6 * curve.length
    before, after = (
        shapely.get_coordinates(shapely.line_interpolate_point(curve, np.clip(at + ahead, 0.0, curve.length))) for ahead in (-step, step)
    )
    along, away = after - before, shapely.get_coordinates(spots) - foot
    sides = along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]
    return bool(sides[0] * sides[1] > 0.0)


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
