"""Coarse meshes of drawings with a plan: thinned lines and near-regular triangles between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import Delaunay
from scipy.spatial import QhullError
from scipy.spatial import cKDTree

from .._compiled import kernel
from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.plan import cross
from .creases import crease_paths
from .edge_flips import Diagonals
from .edge_flips import flipped

__all__ = ["CoarsePlan", "coarse_plan", "cut_at_turns"]

MIN_TURN = np.radians(30.0)  # turn of a line above which its vertex is kept
MAX_BENDING = np.radians(12.0)  # largest turn of a line between two kept vertices
MIN_SEGMENTS = 3  # of a closed line
CLEARANCE = 0.6  # distance of inner vertices from lines in edge lengths; above 1/2 the lines are Delaunay edges
SAMPLE_SPACING = 0.25  # spacing of the sample points for this distance, in edge lengths
SLIVER_AREA = 1e-3  # area relative to the mean below which a triangle is a sliver
SHEAR, TIE = 1e-7, 1e-9  # shear of a lattice, and difference of distances against the edge length, that are above rounding
CANCELLED = 1e-6  # mean of directions that is rounding
AREA_TOLERANCE = 0.02  # relative difference of plan areas above which the mesh overlaps itself


class CoarsePlan(NamedTuple):
    """A coarse mesh, and the positions of its vertices in the fine mesh."""

    faces: Faces  # (f, 3)
    kept: Indices  # (k,) vertices of the fine mesh that are the first ones of the coarse mesh
    within: Indices  # (p,) faces of the fine mesh that contain the other vertices
    weights: FloatArray  # (p, 3) barycentric coordinates of these
    lines: Edges  # (d, 2) the lines in vertices of the coarse mesh


def coarse_plan(
    plan: FloatArray, faces: Faces, lines: Edges, kept: Mask, step: float, anew: bool = False, symmetric: bool = False
) -> Optional[CoarsePlan]:
    """Return a mesh of the same plan with nearly uniform edge lengths.

    On the boundary and other lines some of the vertices are kept, always those in `kept` and those where a line turns or
    branches; the area between is remeshed.

    Parameters
    ----------
    plan
        ``(n, 2)`` vertices in plan [L].
    faces
        ``(m, 3)`` vertex indices, all counterclockwise in plan.
    lines
        ``(c, 2)`` inner edges to keep as lines, such as creases.
    kept
        ``(n,)`` mask of vertices to keep.
    step
        Edge length [L].
    anew
        Lay the lattice out along the boundary and the lines, not along the edges of the fine mesh, so that it moves with the plan.

    symmetric
        With `anew`, lay it out as symmetrically as the plan is; for rims of short edges.

    Returns
    -------
    CoarsePlan or None
        None if the plan overlaps itself, or if lines are closer than the edge length.
    """
    edges = edge_faces(faces)
    rim = edges[edges[:, 3] < 0, :2]
    axes = (_symmetric_frame if symmetric else _frame)(plan, rim, lines, edges[:, :2]) if anew else np.eye(2)
    direction, mirrored = 0.0 if anew else _direction(plan, edges[:, :2]), bool(np.linalg.det(axes) < 0.0)
    plan, faces = plan @ axes, faces[:, ::-1] if mirrored else faces
    ends = _ends(len(plan), rim, lines)
    around, along = (_segments(plan, own, kept | ends, step) for own in (rim, lines))
    paths = [*around, *along]
    chosen = np.unique(np.concatenate([*paths, np.flatnonzero(kept)]))
    own = plan[np.unique(faces)]
    lattice = _symmetric_lattice(own, step) if symmetric else _lattice(own, direction, step)
    inner = _inner_points(plan, lattice, np.vstack([rim, lines]), chosen, step)
    within, weights = located(inner, plan, faces, step)
    inner, weights, within = inner[within >= 0], weights[within >= 0], within[within >= 0]
    points = np.vstack([plan[chosen], inner])
    place = np.full(len(plan), -1)
    place[chosen] = np.arange(len(chosen))
    outer, inside = (_edges_of(place, own) for own in (around, along))
    try:
        coarse = _delaunay(points, direction, np.vstack([outer, inside]), plan, faces, step)
    except QhullError:
        return None
    if not len(coarse) or not _runs_along(coarse, outer, inside) or not _covers(points, coarse, plan, faces):
        return None
    if mirrored:
        coarse, weights = np.ascontiguousarray(coarse[:, ::-1]), weights[:, ::-1]
    return CoarsePlan(coarse, chosen, within, weights, inside)


def _ends(count: int, rim: Edges, lines: Edges) -> Mask:
    """Return the mask of vertices where lines meet the boundary (count,)."""
    on = np.zeros((2, count), bool)
    on[0, rim], on[1, lines] = True, True
    return on[0] & on[1]


def _edges_of(place: Indices, paths: Sequence[Indices]) -> Edges:
    """Return the edges (e, 2) along paths, with vertices renumbered by `place` (n,)."""
    return np.vstack([np.empty((0, 2), np.int64), *(np.column_stack([place[path[:-1]], place[path[1:]]]) for path in paths)])


def _segments(plan: FloatArray, edges: Edges, kept: Mask, step: float) -> list[Indices]:
    """Return the remaining vertices of every line between two kept ones."""
    thinned = []
    for path in crease_paths({(min(u, v), max(u, v)) for u, v in edges.tolist()}):
        for part in cut_at_turns(plan, np.array(path), kept):
            thinned.append(_thinned(plan[part], part, step))
    return thinned


def cut_at_turns(plan: FloatArray, path: Indices, kept: Mask) -> list[Indices]:
    """Return a path cut at sharp turns and at given vertices.

    Parameters
    ----------
    plan
        ``(n, d)`` vertices [L].
    path
        ``(k,)`` vertices; the last is the first if it is closed.
    kept
        ``(n,)`` mask of the given vertices.
    """
    closed = path[0] == path[-1]
    turn = _turns(plan[path], closed)
    at = np.flatnonzero((turn > MIN_TURN) | kept[path])
    if closed:
        at = at[at < len(path) - 1]
        if len(at):
            path = np.concatenate([path[at[0] : -1], path[: at[0] + 1]])
            at = at[1:] - at[0]
    cuts = [0, *(k for k in at.tolist() if 0 < k < len(path) - 1), len(path) - 1]
    return [path[a : b + 1] for a, b in zip(cuts[:-1], cuts[1:])]


def _turns(points: FloatArray, closed: bool) -> FloatArray:
    """Return the angle by which a polyline (p, d) turns at each of its points [rad]."""
    ahead = np.diff(points, axis=0)
    before = np.roll(ahead, 1, axis=0)
    across = np.einsum("px,px->p", ahead, before)
    squares = np.einsum("px,px->p", ahead, ahead) * np.einsum("px,px->p", before, before)
    turn = np.arctan2(np.sqrt(np.maximum(squares - across**2, 0.0)), across)
    return np.concatenate([[turn[0] if closed else 0.0], turn[1:], [turn[0] if closed else 0.0]])


def _thinned(points: FloatArray, path: Indices, step: float) -> Indices:
    """Return vertices of a path about `step` apart, including its ends."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    closed = path[0] == path[-1]
    count = max(1, round(length[-1] / step), int(np.ceil(_turns(points, closed).sum() / MAX_BENDING)), MIN_SEGMENTS if closed else 1)
    goals = np.linspace(0.0, length[-1], count + 1)
    after = np.clip(np.searchsorted(length, goals), 1, len(path) - 1)
    nearest = np.where(goals - length[after - 1] < length[after] - goals + TIE * step, after - 1, after)
    return path[np.unique(np.concatenate([[0], nearest, [len(path) - 1]]))]


def _inner_points(plan: FloatArray, lattice: FloatArray, edges: Edges, chosen: Indices, step: float) -> FloatArray:
    """Return the points (p, 2) of a triangular lattice at a distance from lines and kept vertices."""
    obstacles = np.vstack([_sampled(plan, edges, SAMPLE_SPACING * step), plan[chosen]])
    return lattice[cKDTree(obstacles).query(lattice)[0] > CLEARANCE * step]


def _lattice(plan: FloatArray, direction: float, step: float) -> FloatArray:
    """Return the points (p, 2) of a triangular lattice over a plan (n, 2), with edges in a given direction.

    Of the three possible rhombs the one that fits the plan best is used, with rows aligned to its extent: a mesh that is a
    lattice up to its boundary gets a coarser lattice up to the boundary.
    """
    best: tuple[FloatArray, FloatArray, FloatArray] = (plan, plan, plan)
    least = np.inf
    for turn in (0.0, np.pi / 3, 2 * np.pi / 3):
        axes = np.array([[np.cos(a), np.sin(a)] for a in (direction + turn, direction + turn + np.pi / 3)])
        along = plan @ np.linalg.inv(axes)
        extent = np.ptp(along, axis=0)
        if extent.prod() < (1.0 - 1e-6) * least:
            best, least = (axes, along.min(axis=0), extent), float(extent.prod())
    axes, low, extent = best
    count = np.maximum(1, np.round(extent / step)).astype(np.int64)
    row, column = np.meshgrid(*(np.linspace(0.0, 1.0, k + 1) for k in count), indexing="ij")
    return (low + extent * np.column_stack([row.ravel(), column.ravel()])) @ axes


def _symmetric_lattice(plan: FloatArray, step: float) -> FloatArray:
    """Return the points (p, 2) of a triangular lattice with rows along x in the rectangle around a plan (n, 2), symmetric as that is.

    A plan that is symmetric about an axis then gets a symmetric mesh, and symmetric surfaces.
    """
    low, extent = plan.min(axis=0), np.ptp(plan, axis=0)
    across, up = max(1, round(extent[0] / step)), 2 * max(1, round(extent[1] / (np.sqrt(3.0) * step)))
    full, between = np.linspace(0.0, 1.0, across + 1), (np.arange(across) + 0.5) / across
    rows = [np.column_stack([own, np.full(len(own), k / up)]) for k in range(up + 1) for own in [between if k % 2 else full]]
    return np.asarray(low + extent * np.vstack(rows))


def _direction(plan: FloatArray, edges: Edges) -> float:
    """Return the prevailing direction of edges modulo 60 degrees [rad]."""
    return float(np.angle(_turned(plan, edges, 6))) / 6.0


def _turned(plan: FloatArray, edges: Edges, folds: int) -> complex:
    """Return the mean of the directions of edges times a number, as complex numbers, weighted by length; 0 where they cancel."""
    along = (plan[edges[:, 1]] - plan[edges[:, 0]]) @ np.array([1.0, 1.0j])
    length = np.abs(along)
    mean = complex(length @ np.exp(1j * folds * np.angle(along))) / float(length.sum())
    return mean if abs(mean) > CANCELLED else 0.0


def _frame(plan: FloatArray, rim: Edges, lines: Edges, edges: Edges) -> FloatArray:
    """Return axes (2, 2) in which a plan is the same however it is turned, and mirrored as the fine mesh in it is.

    The first one is a direction that prevails among rim and lines, of multiples of 60 degrees, or of 30 where those at right angles
    cancel, the one nearest to what prevails modulo 180 degrees, if need be among all edges.
    """
    outer = np.vstack([rim, lines])
    sixfold, twofold = _turned(plan, outer, 6), _turned(plan, outer, 2) or _turned(plan, edges, 2)
    angle = float(np.angle(sixfold)) / 6.0 if sixfold else float(np.angle(_turned(plan, outer, 12))) / 12.0
    angle += np.pi / 3.0 * round((float(np.angle(twofold)) / 2.0 - angle) / (np.pi / 3.0))
    return _handed(plan, edges, angle)


def _symmetric_frame(plan: FloatArray, rim: Edges, lines: Edges, edges: Edges) -> FloatArray:
    """Return axes (2, 2) as :func:`_frame` does, along and across an axis of symmetry where a plan has one.

    The first one is a direction that prevails among rim and lines modulo 180 degrees. Where directions cancel it is one that prevails
    modulo 90 or else 60 degrees, the nearest to what prevails among all edges.
    """
    outer = np.vstack([rim, lines])
    folds = next((own for own in (2, 4) if _turned(plan, outer, own)), 6)
    angle, turn = float(np.angle(_turned(plan, outer, folds))) / folds, 2.0 * np.pi / folds
    angle += turn * round((float(np.angle(_turned(plan, edges, 2))) / 2.0 - angle) / turn) if folds > 2 else 0.0
    return _handed(plan, edges, angle)


def _handed(plan: FloatArray, edges: Edges, angle: float) -> FloatArray:
    """Return axes (2, 2) of which the first one has a direction, mirrored as the edges in them are."""
    hand = np.copysign(1.0, (_turned(plan, edges, 6) * np.exp(-6j * angle)).imag)
    return np.array([[np.cos(angle), -hand * np.sin(angle)], [np.sin(angle), hand * np.cos(angle)]])


def _sampled(plan: FloatArray, edges: Edges, spacing: float) -> FloatArray:
    """Return points (p, 2) along edges, at most a spacing apart."""
    along = plan[edges[:, 1]] - plan[edges[:, 0]]
    count = np.maximum(1, np.ceil(np.linalg.norm(along, axis=1) / spacing).astype(np.int64))
    owner = np.repeat(np.arange(len(edges)), count)
    part = (np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)) / count[owner]
    return plan[edges[owner, 0]] + part[:, None] * along[owner]


def _delaunay(points: FloatArray, direction: float, lines: Edges, plan: FloatArray, faces: Faces, step: float) -> Faces:
    """Return the Delaunay triangles of points (p, 2) within another mesh, constrained to the lines (c, 2)."""
    # Points of a lattice beside a line lie on one circle: a shear along the lattice decides, not rounding.
    along = np.array([np.cos(direction), np.sin(direction)])
    sheared = points + SHEAR * np.outer(points @ np.array([-along[1], along[0]]), along)
    coarse = Delaunay(sheared).simplices.astype(np.int64)
    coarse[_double_areas(points, coarse) < 0] = coarse[_double_areas(points, coarse) < 0][:, ::-1]
    # Triangles without area along a straight boundary have no orientation.
    coarse = _with_lines(points, _without_slivers(points, coarse), lines)
    coarse = _without_slivers(points, coarse)
    return np.ascontiguousarray(coarse[located(points[coarse].mean(axis=1), plan, faces, step)[0] >= 0])


def _without_slivers(points: FloatArray, faces: Faces) -> Faces:
    double = np.abs(_double_areas(points, faces))
    return np.asarray(faces[double > SLIVER_AREA * double.mean()])


def _with_lines(points: FloatArray, faces: Faces, lines: Edges) -> Faces:
    """Return triangles (f, 3) after flips of edges that cross lines (c, 2), so that lines become edges where possible.

    Lines that turn sharply are not always Delaunay edges.
    """
    n = len(points)
    codes = np.asarray(np.sort(lines, axis=1) @ [n, 1], dtype=np.int64)
    lost = points[lines[~np.isin(codes, np.sort(edge_faces(faces)[:, :2], axis=1) @ [n, 1])]]
    if not len(lost):
        return faces

    def fewer(e: Diagonals) -> FloatArray:
        return _crossed(points[e.a], points[e.b], lost) - _crossed(points[e.c], points[e.d], lost)

    return np.ascontiguousarray(flipped(points, faces, codes, fewer))


def _crossed(start: FloatArray, end: FloatArray, lines: FloatArray) -> FloatArray:
    """Return the number of lines (c, 2, 2) that each edge (k, 2) properly crosses (k,)."""
    count = np.zeros(len(start))
    for first, last in lines[:, :, None]:
        apart = cross(last - first, start - first) * cross(last - first, end - first) < 0.0
        count += apart & (cross(end - start, first - start) * cross(end - start, last - start) < 0.0)
    return count


def _double_areas(points: FloatArray, faces: Faces) -> FloatArray:
    a, b, c = points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]]
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]


def _runs_along(faces: Faces, rim: Edges, lines: Edges) -> bool:
    """Check whether the boundary of a mesh is `rim` and all lines are edges."""
    edges = edge_faces(faces)
    n = int(max(faces.max(), rim.max(initial=0), lines.max(initial=0))) + 1
    outer, inside = (np.unique(np.sort(own, axis=1) @ [n, 1]) for own in (rim, lines))
    codes = np.sort(edges[:, :2], axis=1) @ [n, 1]
    return np.array_equal(np.sort(codes[edges[:, 3] < 0]), outer) and bool(np.isin(inside, codes).all())


def _covers(points: FloatArray, coarse: Faces, plan: FloatArray, faces: Faces) -> bool:
    """Check whether two meshes cover the same plan area once, and all points are used."""
    here, there = float(_double_areas(points, coarse).sum()), float(_double_areas(plan, faces).sum())
    return abs(here - there) <= AREA_TOLERANCE * there and len(np.unique(coarse)) == len(points)


def located(points: FloatArray, plan: FloatArray, faces: Faces, step: float) -> tuple[IntArray, FloatArray]:
    """Return the face that contains each point, -1 for none (p,), and its barycentric coordinates (p, 3).

    Parameters
    ----------
    points
        ``(p, 2)`` [L].
    plan, faces
        ``(n, 2)`` [L] and ``(m, 3)``, counterclockwise.
    step
        Typical distance of the points [L].
    """
    if not len(points):
        return np.empty(0, np.int64), np.empty((0, 3))
    low = points.min(axis=0)
    cell = np.floor((points - low) / step).astype(np.int64)
    width, depth = (cell.max(axis=0) + 1).tolist()
    code = cell[:, 0] * depth + cell[:, 1]
    order = np.argsort(code, kind="stable")
    starts = np.searchsorted(code[order], np.arange(width * depth + 1))
    return _located(points, plan, faces, low, step, width, depth, order, starts)


@kernel()
def _located(
    points: FloatArray,
    plan: FloatArray,
    faces: IntArray,
    low: FloatArray,
    step: float,
    width: int,
    depth: int,
    order: IntArray,
    starts: IntArray,
) -> tuple[IntArray, FloatArray]:
    face, weights = np.full(len(points), -1), np.zeros((len(points), 3))
    best = np.full(len(points), -1e-9)  # rounding of a point on an edge
    for f in range(len(faces)):
        ax, ay = plan[faces[f, 0], 0], plan[faces[f, 0], 1]
        bx, by = plan[faces[f, 1], 0] - ax, plan[faces[f, 1], 1] - ay
        cx, cy = plan[faces[f, 2], 0] - ax, plan[faces[f, 2], 1] - ay
        double = bx * cy - by * cx
        if not double > 0.0:
            continue
        i0 = max(0, int(np.floor((ax + min(0.0, bx, cx) - low[0]) / step)))
        i1 = min(width - 1, int(np.floor((ax + max(0.0, bx, cx) - low[0]) / step)))
        j0 = max(0, int(np.floor((ay + min(0.0, by, cy) - low[1]) / step)))
        j1 = min(depth - 1, int(np.floor((ay + max(0.0, by, cy) - low[1]) / step)))
        if j0 > j1:
            continue
        for i in range(i0, i1 + 1):
            for at in range(starts[i * depth + j0], starts[i * depth + j1 + 1]):
                p = order[at]
                x, y = points[p, 0] - ax, points[p, 1] - ay
                v, w = (x * cy - y * cx) / double, (bx * y - by * x) / double
                inside = min(1.0 - v - w, v, w)
                if inside >= best[p]:
                    best[p], face[p] = inside, f
                    weights[p, 0], weights[p, 1], weights[p, 2] = 1.0 - v - w, v, w
    return face, weights
