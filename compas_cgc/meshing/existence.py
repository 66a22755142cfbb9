"""Existence conditions: the largest Gaussian curvature over a plane boundary."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..discrete import _kernels
from ..discrete import edge_faces
from ..discrete._memo import remembered
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import Sentence
from ..errors import names_what_was_meant
from ..errors import scaled
from .checks import Diagnostic

__all__ = ["Overload", "existence_problems", "is_plane_and_convex", "overload", "plane_of", "too_much"]

FLATNESS_TOLERANCE = 1e-9  # distance from the plane relative to the size of a curve that counts as plane


class Overload(NamedTuple):
    """A region whose target exceeds the curvature of any convex surface over its boundary."""

    curvature: float  # mean K̄ [1/L^2]
    area: float  # plane area of the vertices with a target [L^2]

    @property
    def most(self) -> float:
        """Upper bound of K̄ [1/L^2]."""
        return math.pi / self.area


def too_much(K: float, most: float) -> str:
    """Return the message about a target above the limit `most` of a plane boundary [1/L^2]."""
    said = f"the target {K:.4g} is too large for this boundary: no surface over its plane has K̄ above {most:.4g}; "
    if K > 1e4 * most:
        # A factor of 1000 in length is a factor of 1e6 in K.
        return said + f"check the units: K is in 1/(model unit)², and {K:.4g} 1/m² is {1e-6 * K:.4g} 1/mm²"
    return Sentence(said + "lower the target, add creases, or free an edge", [scaled(most / K)])


def overload(vertices: FloatArray, faces: IntArray, targets: FloatArray, asked: np.ndarray) -> Optional[Overload]:
    r"""Return a region whose targets exceed those of any convex surface over its boundary, or None.

    The Gauss map of a convex surface over a plane domain is injective, and its projected
    area is ``∫ K n·e dA = Σ K̄_i a_i`` with ``a_i`` the plane area of vertex i. The
    projected area of a hemisphere is π, so ``Σ K̄_i a_i < π`` is necessary (for a disk of
    radius r: ``K̄ < 1 / r²``).

    Only regions to which this applies are checked: all K̄ > 0, a disk without holes or
    creases, fixed along a plane convex curve.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    targets
        ``(n,)`` K̄ [1/L^2].
    asked
        ``(n,)`` mask of vertices with a target; all others are fixed.
    """
    V, F, edges = vertices, faces, edge_faces(faces)
    part_of, count = _parts(edges, asked)
    face_part = part_of[F].max(axis=1)  # corners with a target are neighbours and belong to one part
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, part_of[asked], targets[asked])
    own_faces, rims = _grouped(np.arange(len(F)), face_part, count), _rims(edges, face_part, count)
    weight = np.where(asked, targets, 0.0)[F].sum(axis=1) / 3
    share = (part_of >= 0)[F].sum(axis=1) / 3
    sizes = np.bincount(part_of[asked], minlength=count)
    for p in np.flatnonzero(lowest > 0).tolist():
        loop = _loop(rims[p])
        euler = sizes[p] + len(rims[p]) - (3 * len(own_faces[p]) + len(rims[p])) / 2 + len(own_faces[p])
        if loop is None or euler != 1 or not is_plane_and_convex(V[loop]):
            continue
        halves = 0.5 * _kernels.cross_vectors(V, F[own_faces[p]])
        across = halves.sum(axis=0)
        if not across.any():
            continue
        plane = halves @ (across / np.linalg.norm(across))
        total, area = float(weight[own_faces[p]] @ plane), float(share[own_faces[p]] @ plane)
        if area > 0 and total >= math.pi:
            return Overload(total / area, area)
    return None


@remembered
def _parts(edges: IntArray, asked: np.ndarray) -> tuple[IntArray, int]:
    """Return the connected part of every vertex with a target, -1 for fixed ones (n,), and the number of parts."""
    u, v = edges[:, 0], edges[:, 1]
    inside = asked[u] & asked[v]
    n = len(asked)
    graph = sparse.coo_matrix((np.ones(np.count_nonzero(inside)), (u[inside], v[inside])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    part_of = np.full(n, -1)
    part_of[asked] = np.unique(label[asked], return_inverse=True)[1]
    return part_of, int(part_of.max(initial=-1)) + 1


def _grouped(items: np.ndarray, group: IntArray, count: int) -> list[np.ndarray]:
    """Return the items of each group from 0 to `count` - 1, without those of group -1."""
    order = np.argsort(group, kind="stable")
    cuts = np.searchsorted(group[order], np.arange(count + 1))
    return [items[order[a:b]] for a, b in zip(cuts[:-1], cuts[1:])]


@remembered
def _rims(edges: IntArray, face_part: IntArray, count: int) -> list[IntArray]:
    """Return the boundary edges (b, 2) of each part, with the part on their left."""
    u, v, left, right = edges.T
    padded = np.append(face_part, -1)
    here, there = face_part[left], padded[right]
    border = np.flatnonzero(here != there)
    edges = np.vstack([np.column_stack([u, v])[border], np.column_stack([v, u])[border]])
    return _grouped(edges, np.concatenate([here[border], there[border]]), count)


@remembered
def _loop(rim: IntArray) -> Optional[list[int]]:
    """Return the vertices of a boundary in order, None if it is not one simple loop."""
    following = dict(rim.tolist())
    if not len(rim) or len(following) < len(rim):
        return None
    start = int(rim[0, 0])
    loop, vertex = [start], following[start]
    while vertex != start and len(loop) < len(rim):
        loop.append(vertex)
        vertex = following.get(vertex, start)
    return loop if vertex == start and len(loop) == len(rim) else None


@remembered
def is_plane_and_convex(points: FloatArray) -> bool:
    """Return whether a closed line of points (k, 3) is plane and convex."""
    points = points - points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points, full_matrices=False)
    if spread[2] > FLATNESS_TOLERANCE * spread[0] or spread[1] <= FLATNESS_TOLERANCE * spread[0]:
        return False
    edges = (np.roll(points, -1, axis=0) - points) @ axes[:2].T
    following = np.roll(edges, -1, axis=0)
    sine = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    turn = np.arctan2(sine, np.einsum("ij,ij->i", edges, following))
    turn *= np.sign(turn.sum())
    return bool((turn > -FLATNESS_TOLERANCE).all()) and abs(turn.sum() - 2 * math.pi) < 1e-6


def plane_of(points: FloatArray) -> tuple[FloatArray, float]:
    """Return two axes (2, 3) of the best-fit plane of points, and their largest distance from it relative to their size."""
    offset = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(offset, full_matrices=False)
    size = float(np.linalg.norm(offset, axis=1).max())
    return axes[:2], float(np.abs(offset @ axes[2]).max()) / size if size > 0 else 0.0


@names_what_was_meant()
def existence_problems(
    vertices: FloatArray, faces: IntArray, boundary: IntArray, targets: FloatArray, asked: np.ndarray
) -> list[Diagnostic]:
    """Return the problem of a target curvature too large for a plane boundary curve.

    Over a plane curve of area A the projected Gauss map of a graph covers at most the area
    pi, so K̄ A < pi. A sphere through an inscribed circle of radius r touches the surface,
    so K̄ <= 1 / r^2.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` and ``(m, 3)``: one piece without creases.
    boundary
        ``(b,)`` vertices around its only boundary loop, in order, all fixed.
    targets
        ``(n,)`` K̄ [1/L^2].
    asked
        ``(n,)`` mask of the vertices of the piece with a target.

    Returns
    -------
    list of Diagnostic
        Sentences, empty if the targets are admissible.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.meshing import boundary_loops
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> edge = boundary_loops(plan.faces)[0]
    >>> [text[:19] for text in existence_problems(plan.vertices, plan.faces, edge, 100 * plan.targets, plan.asked)]
    ['the target 2 is too']
    """
    target = float(targets[asked].min())
    most = _most_over(vertices, faces, boundary)
    if target <= 0 or most is None:
        return []
    if target >= most:
        return [Diagnostic(too_much(target, most))]
    excess = overload(vertices, faces, targets, asked)
    return [] if excess is None else [Diagnostic(too_much(excess.curvature, excess.most))]


@remembered
def _most_over(vertices: FloatArray, faces: IntArray, boundary: IntArray) -> Optional[float]:
    """Return the upper bound of K̄ over a boundary, None if it is not plane or has no area [1/L^2]."""
    axes, reach = plane_of(vertices[boundary])
    if reach > 1e-6:
        return None
    plan = vertices @ axes.T
    rim = plan[boundary]
    x, y = rim.T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
    if area <= FLATNESS_TOLERANCE * float(np.ptp(rim, axis=0).max()) ** 2:
        return None  # a slit without area
    most = math.pi / area
    within = np.zeros(len(vertices), bool)
    within[faces] = True
    within[boundary] = False
    inside = np.flatnonzero(within)
    if len(inside):
        middle = 0.5 * (rim + np.roll(rim, -1, axis=0))
        reach = float(np.linalg.norm(rim - middle, axis=1).max())
        near, _ = cKDTree(middle).query(plan[inside])
        # The largest inscribed circle centred at a vertex.
        for k in np.argsort(-near, kind="stable")[:50]:
            if _within(plan[inside[k]], rim):
                radius = float(near[k]) - reach
                most = min(most, 1.0 / radius**2) if radius > 0 else most
                break
    return most


def _within(point: FloatArray, polygon: FloatArray) -> bool:
    """Check whether a point of the plane lies in a polygon, by ray crossings."""
    x, y = (polygon - point).T
    ahead_x, ahead_y = np.roll(x, -1), np.roll(y, -1)
    crosses = (y > 0) != (ahead_y > 0)
    rise = np.where(crosses, ahead_y - y, 1.0)
    return bool(np.count_nonzero(crosses & (x - y * (ahead_x - x) / rise > 0)) % 2)
