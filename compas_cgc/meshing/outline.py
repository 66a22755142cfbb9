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
from ..errors import MeshError
from ..errors import Remedy
from ..errors import Sentence
from .creases import path_edges
from .halving import with_inner_vertices
from .polyline import arc_lengths
from .polyline import nearest_on_polyline

if TYPE_CHECKING:
    import shapely

MAX_DENSE, NEIGHBOURS = 1500, 150  # known heights fitted at once, and neighbours per point if there are more
MAX_POINT_DISTANCE = 0.2  # distance relative to the edge length within which a point counts as a vertex
MAX_VERTICES = 2e6  # largest number of vertices of a mesh
GRAZING_LENGTH, GRAZING_DISTANCE = (
    0.25,
    0.1,
)  # length of a near-contact of curves and distance beside it that count as grazing, relative to the edge length
MIN_PLAN_COSINE = 0.7  # least cosine between the normal of an outline and z for a mesh in plan, where triangles are stretched by 1.4
SAMPLES_PER_EDGE = 32  # sample points per edge length

__all__ = ["Outlined", "mesh_from_outline", "own_plane", "refuse_passed_over"]


class Outlined(NamedTuple):
    """A mesh made from curves."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3), normals up
    creases: list[list[int]]  # vertex paths along the creases; every part between them has vertices of its own


def mesh_from_outline(
    outline: FloatArray,
    holes: Sequence[FloatArray],
    creases: Sequence[FloatArray],
    edge_length: float,
    tolerance: float,
    points: Optional[FloatArray] = None,
) -> Outlined:
    """Return a mesh of near-equilateral triangles within an outline, with edges along all curves.

    Points are spread along the curves, denser at small features, and a triangular lattice fills the rest of the plan; the result
    is relaxed. The best of several lattices is returned. Heights follow the curves, with a thin plate between them. Upright and
    steep outlines are meshed in their own plane instead of in plan.

    Parameters
    ----------
    outline
        ``(k, 3)`` points around the boundary; the first may be repeated at the end [L].
    holes
        Outlines of holes, in the same form; those whose heights are NaN follow the surface between the other curves.
    creases
        ``(k, 3)`` points along each crease, heights as for holes; parts outside are ignored [L].
    edge_length
        Target edge length [L].
    tolerance
        Distance below which two points coincide [L].
    points
        ``(k, 3)`` points that become vertices, such as columns; their heights count off the curves [L]. If all curves have the
        same height, points do not raise the mesh around them. Points outside the outline are ignored.

    Returns
    -------
    Outlined

    Raises
    ------
    MeshError
        If the mesher is not installed, or the curves do not enclose an area.
    """
    try:
        import compas_cgal.triangulation  # noqa: F401
        import shapely

        from .best_triangles import best_triangles
        from .curve_sampling import spread
    except ImportError as error:
        raise MeshError(f"a mesh from curves needs {error.name}; install it: pip install 'compas_cgc[mesher]'") from None
    if not _is_length(edge_length):
        raise MeshError(f"the edge length must be a positive number in the unit of the outline, not {edge_length!r}")
    axes = own_plane(np.asarray(outline, dtype=np.float64))
    if axes is not None:
        turned = [[np.asarray(line, dtype=np.float64) @ axes.T for line in lines] for lines in ((outline,), holes, creases)]
        given = None if points is None else np.asarray(points, dtype=np.float64).reshape(-1, 3) @ axes.T
        made = mesh_from_outline(turned[0][0], turned[1], turned[2], edge_length, tolerance, given)
        return made._replace(vertices=made.vertices @ axes)
    outline, *holes = (_closed(np.asarray(ring), tolerance) for ring in (outline, *holes))
    rings = [ring[:, :2] for ring in (outline, *holes)]
    domain = shapely.Polygon(rings[0], rings[1:])
    extent = float(np.linalg.norm(np.ptp(rings[0], axis=0)))
    if edge_length > extent > 0.0:
        shorter = f"{extent / 20:.2g}"
        raise _wrong_edge(
            f"the edge length {edge_length:g} is larger than the outline, whose size is {extent:.3g}; use a shorter edge", shorter
        )
    if not domain.is_valid or domain.area < edge_length**2:
        raise MeshError(f"the outline and its holes do not enclose an area that can be meshed: {_fault(domain, outline, edge_length)}")
    expected = domain.area / (edge_length**2 * np.sqrt(3) / 2)
    if expected > MAX_VERTICES:
        longer = f"{np.sqrt(domain.area) / 20:.2g}"
        raise _wrong_edge(f"an edge length of {edge_length:g} would give {expected:.2g} vertices; use a longer edge", longer)
    given = np.empty((0, 3)) if points is None else np.asarray(points, dtype=np.float64).reshape(-1, 3)
    lines = [np.asarray(crease)[:, :2] for crease in creases]
    _refuse_grazing(domain, lines, edge_length)
    laid, plan, faces = best_triangles(domain, lambda grade: spread(domain, rings, lines, given[:, :2], edge_length, tolerance, grade))
    around, inner = laid.rings, laid.pieces
    on_curves = np.concatenate([*around, *inner])
    on = cKDTree(on_curves).query(plan)[0] <= 1e-9 * edge_length
    heights = np.zeros(len(plan))
    heights[on] = _heights_on_curves(plan[on], [outline, *holes, *creases])
    on &= np.isfinite(heights)
    known = on.copy()
    if len(laid.loose) and given[:, 2].any():
        at = cKDTree(plan).query(laid.loose)[1]
        heights[at] = given[cKDTree(given[:, :2]).query(laid.loose)[1], 2]
        known[at] = True
    if np.ptp(heights[on]):
        heights = _heights_between(plan, known, heights)
    else:
        # Points above level curves are column heads, which do not shape the mesh before a solve.
        heights[~known] = heights[on][0]
    vertices = np.column_stack([plan, heights])
    place = cKDTree(plan)
    paths = [place.query(line)[1].tolist() for line in inner]
    sides = np.array(path_edges(paths), dtype=np.int64).reshape(-1, 2)
    return Outlined(*with_inner_vertices(vertices, faces, sides), paths)


def own_plane(outline: FloatArray) -> Optional[FloatArray]:
    """Return axes (3, 3), the rows, of the plane of a steep outline (k, 3), the last one its normal; None for an outline in plan."""
    if len(outline) < 3 or outline.shape[1] != 3 or not np.isfinite(outline).all():
        return None
    away = outline - outline.mean(axis=0)
    normal = np.cross(away, np.roll(away, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    if length <= np.finfo(float).eps * float((away**2).sum()) or abs(normal[2]) >= MIN_PLAN_COSINE * length:
        return None
    normal /= length
    # The same plane gives the same axes, whatever the sense of the outline.
    normal *= np.sign(normal[np.argmax(np.abs(normal))])
    along = np.cross([0.0, 0.0, 1.0], normal)
    along /= np.linalg.norm(along)
    return np.array([along, np.cross(normal, along), normal])


def refuse_outside(outline: FloatArray, creases: Sequence[FloatArray]) -> None:
    """Refuse creases (k, 3) that lie completely outside the outline (k, 3).

    Raises
    ------
    MeshError
        With the position of the first.
    """
    import shapely

    if len(outline) < 3:
        return
    within = shapely.Polygon(outline[:, :2])
    for k, line in enumerate(creases):
        if within.is_valid and len(line) > 1 and not within.intersects(shapely.LineString(line[:, :2])):
            x, y = line[0, :2]
            raise MeshError(f"creases[{k}], from ({x:g}, {y:g}), lies outside the outline; move it inside, or remove it")


def refuse_passed_over(made: Outlined, points: FloatArray, edge_length: float) -> None:
    """Refuse points (k, 3) that did not become vertices of a mesh.

    Raises
    ------
    MeshError
        With the first point and its distance from the nearest vertex.
    """
    gap = cKDTree(made.vertices[:, :2]).query(points[:, :2])[0]
    missed = np.flatnonzero(~(gap <= MAX_POINT_DISTANCE * edge_length))
    if len(missed):
        k = int(missed[0])
        more = f" (nor do {len(missed) - 1} others)" if len(missed) > 1 else ""
        raise MeshError(
            f"points[{k}] at ({points[k, 0]:.6g}, {points[k, 1]:.6g}) does not lie within the outline{more}; it is {gap[k]:.3g} away from "
            "the nearest vertex; move it inside, or remove it"
        )


def _refuse_grazing(domain: shapely.Polygon, creases: Sequence[FloatArray], edge_length: float) -> None:
    """Refuse creases (k, 2) that graze the boundary of a domain or another crease without crossing it.

    Raises
    ------
    MeshError
        With the position of the first.
    """
    import shapely

    from .sizing import MIN_GAP_SIZE

    far, curves = round(GRAZING_LENGTH * SAMPLES_PER_EDGE), [shapely.LineString(line) for line in creases]
    for k, curve in enumerate(curves):
        number = max(2, int(np.ceil(SAMPLES_PER_EDGE * curve.length / edge_length)))
        # Sample a closed crease twice around, because it may start at a grazing point.
        places = np.arange((2 if curve.is_closed else 1) * number + 1) / number
        spots = shapely.line_interpolate_point(curve, places % 1.0 if curve.is_closed else places, normalized=True)
        inside = shapely.contains(domain, spots)
        for j, gap in enumerate(shapely.distance(other, spots) for other in (domain.boundary, *curves[:k])):
            changes = np.diff(((gap < MIN_GAP_SIZE * edge_length) & (inside | (j == 0))).astype(np.int64), prepend=0, append=0)
            for begin, end in zip(np.flatnonzero(changes > 0).tolist(), np.flatnonzero(changes < 0).tolist()):
                beside = np.array([begin - far, end - 1 + far])
                # At a crossing the curve is on different sides before and after, or outside the domain.
                if (
                    end - begin > far
                    and beside[0] >= 0
                    and beside[1] < len(spots)
                    and inside[beside].all()
                    and (gap[beside] < GRAZING_DISTANCE * edge_length).all()
                    and (j == 0 or _on_one_side(curves[j - 1], spots[beside]))
                ):
                    x, y = shapely.get_coordinates(spots[begin + int(np.argmin(gap[begin:end]))])[0]
                    what = f"creases[{j - 1}]" if j else "the boundary of the outline or of a hole"
                    raise MeshError(
                        f"creases[{k}] grazes {what} at ({x:.3f}, {y:.3f}), which leaves no room for triangles; "
                        f"let creases[{k}] end there, cross {f'creases[{j - 1}]' if j else 'the boundary'}, "
                        f"or keep a distance of {GRAZING_DISTANCE * edge_length:.2g} model units"
                    )


def _on_one_side(curve: shapely.LineString, spots: NDArray[np.object_]) -> bool:
    """Check whether two points lie on the same side of a curve."""
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


def _wrong_edge(fault: str, better: str) -> MeshError:
    """Return the error of an edge length that does not fit the outline."""
    text = f"{fault}, such as {better}, and check that the outline and the edge length have the same unit"
    return MeshError(Sentence(text, [Remedy("edge_length", float(better))]))


def _fault(domain: shapely.Polygon, outline: FloatArray, edge_length: float) -> str:
    """Return the fault of a domain with a remedy."""
    import shapely

    lost = np.flatnonzero(~np.isfinite(outline).all(axis=1))
    if len(lost):
        return f"point {lost[0]} of the outline has a coordinate that is not a finite number; correct it"
    said = shapely.is_valid_reason(domain)
    at = said.partition("[")[2].rstrip("]").replace(" ", ", ")
    if len(outline) > 2 and np.linalg.matrix_rank(outline[1:, :2] - outline[0, :2], tol=MAX_POINT_DISTANCE * edge_length) < 2:
        return "the points of the outline lie on one line; move one of them off it"
    if said.startswith("Self-intersection"):
        return f"a curve crosses itself or another one at ({at}); draw them apart"
    if said.startswith("Hole lies outside"):
        return f"the hole at ({at}) lies outside the outline; move it inside, or remove it"
    if said.startswith("Holes are nested"):
        return f"the hole at ({at}) lies in another hole; remove one of them"
    if said.startswith("Too few points"):
        return "outlines and holes need three or more corners"
    if domain.is_valid:
        return f"the area is smaller than the square of the edge length {edge_length:g}; use a shorter edge"
    return f"{said[:1].lower()}{said[1:]}; correct the curves"


def _closed(ring: FloatArray, tolerance: float) -> FloatArray:
    """Return a closed ring (k, 3) whose last point equals the first exactly."""
    ends = len(ring) > 1 and np.linalg.norm((ring[-1] - ring[0])[:2]) <= tolerance
    return np.concatenate([ring[:-1] if ends else ring, ring[:1]])


def _heights_on_curves(plan: FloatArray, curves: Sequence[FloatArray]) -> FloatArray:
    """Return the heights of the curves at points (k, 2), of the first curve at crossings (k,) [L]."""
    distances, heights = [], []
    for curve in (np.asarray(own) for own in curves):
        gap, position = nearest_on_polyline(plan, curve[:, :2])
        distances.append(gap)
        heights.append(np.interp(position, arc_lengths(curve[:, :2]), curve[:, 2]))
    gaps = np.array(distances)
    first = np.argmax(gaps <= gaps.min(axis=0) + 1e-9 * np.ptp(plan), axis=0)
    return np.array(heights)[first, np.arange(len(plan))]


def _heights_between(plan: FloatArray, known: Mask, heights: FloatArray) -> FloatArray:
    """Return heights (n,) interpolated by a thin plate through the known ones [L].

    A membrane would sag between two arches, where a plate is nearly ruled.
    """
    free = np.flatnonzero(~known)
    if not len(free):
        return heights
    from scipy.interpolate import RBFInterpolator

    result = heights.copy()
    near = None if np.count_nonzero(known) <= MAX_DENSE else NEIGHBOURS
    result[free] = RBFInterpolator(plan[known], heights[known], neighbors=near, kernel="thin_plate_spline")(plan[free])
    return result
