"""Existence: how much Gaussian curvature a plane boundary can carry, told before a solve and during it."""

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
from ..errors import names_what_was_meant
from .checks import Diagnostic

__all__ = ["Overload", "existence_problems", "overload", "plane_of", "too_much"]

FLAT = 1e-9  # distance from its plane, against its size, of a plane curve


class Overload(NamedTuple):
    """A region that is asked for more curvature than its boundary lets a convex surface have."""

    curvature: float  # mean K̄ [1/L^2]
    area: float  # plane area under the vertices where K is asked for [L^2]

    @property
    def most(self) -> float:
        """What K̄ has to stay below [1/L^2]."""
        return math.pi / self.area


def too_much(K: float, most: float) -> str:
    """Return the sentence on a target that no surface has over its plane boundary, whose limit is `most` [1/L^2]."""
    said = f"the target {K:.4g} is more than this boundary can carry: over its plane no surface has K̄ above {most:.4g}; "
    if K > 1e4 * most:
        # A thousand to the length is a million to K.
        return said + f"K is in 1 / (model unit)², so {K:.4g} 1/m² is {1e-6 * K:.4g} 1/mm²: are the units those of the model?"
    return said + "lower the target, add creases, or free an edge"


def overload(vertices: FloatArray, faces: IntArray, targets: FloatArray, asked: np.ndarray) -> Optional[Overload]:
    r"""Return a region whose targets no convex surface over its boundary can meet, or None.

    The normals of a convex surface over a plane domain are all different, and their
    components across the plane add up to ``∫ K n·e dA = Σ K̄_i a_i`` with ``a_i`` the plane
    area under vertex i; over a whole hemisphere of normals they add up to π. So there
    must be ``Σ K̄_i a_i < π``. (For a disk of radius r that is ``K̄ < 1 / r²``.)

    Only regions where this holds without doubt are judged: all K̄ > 0, a disk without
    holes or creases in it, held along a plane convex curve.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    targets
        ``(n,)`` K̄ [1/L^2].
    asked
        ``(n,)`` vertices where K is asked for; all others are held.
    """
    V, F, edges = vertices, faces, edge_faces(faces)
    part_of, count = _parts(edges, asked)
    face_part = part_of[F].max(axis=1)  # asked corners of a face are neighbours, so of one part
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, part_of[asked], targets[asked])
    own_faces, rims = _grouped(np.arange(len(F)), face_part, count), _rims(edges, face_part, count)
    weight = np.where(asked, targets, 0.0)[F].sum(axis=1) / 3
    share = (part_of >= 0)[F].sum(axis=1) / 3
    sizes = np.bincount(part_of[asked], minlength=count)
    for p in np.flatnonzero(lowest > 0).tolist():
        loop = _loop(rims[p])
        euler = sizes[p] + len(rims[p]) - (3 * len(own_faces[p]) + len(rims[p])) / 2 + len(own_faces[p])
        if loop is None or euler != 1 or not _is_plane_and_convex(V[loop]):
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
    """Number the parts that asked vertices joined by edges form: the part of every vertex, -1 where held (n,), and how many."""
    u, v = edges[:, 0], edges[:, 1]
    inside = asked[u] & asked[v]
    n = len(asked)
    graph = sparse.coo_matrix((np.ones(np.count_nonzero(inside)), (u[inside], v[inside])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    part_of = np.full(n, -1)
    part_of[asked] = np.unique(label[asked], return_inverse=True)[1]
    return part_of, int(part_of.max(initial=-1)) + 1


def _grouped(items: np.ndarray, group: IntArray, count: int) -> list[np.ndarray]:
    """Return the items of each group from 0 to `count`; those of group -1 are left out."""
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
    """Return the vertices of a rim in order, or None when it is not one simple loop."""
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
def _is_plane_and_convex(points: FloatArray) -> bool:
    points = points - points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points, full_matrices=False)
    if spread[2] > FLAT * spread[0] or spread[1] <= FLAT * spread[0]:
        return False
    edges = (np.roll(points, -1, axis=0) - points) @ axes[:2].T
    following = np.roll(edges, -1, axis=0)
    sine = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    turn = np.arctan2(sine, np.einsum("ij,ij->i", edges, following))
    turn *= np.sign(turn.sum())
    return bool((turn > -FLAT).all()) and abs(turn.sum() - 2 * math.pi) < 1e-6


def plane_of(points: FloatArray) -> tuple[FloatArray, float]:
    """Return two axes (2, 3) of the plane nearest to points, and how far these leave it, as a part of their size."""
    offset = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(offset, full_matrices=False)
    size = float(np.linalg.norm(offset, axis=1).max())
    return axes[:2], float(np.abs(offset @ axes[2]).max()) / size if size > 0 else 0.0


@names_what_was_meant()
def existence_problems(
    vertices: FloatArray, faces: IntArray, boundary: IntArray, targets: FloatArray, asked: np.ndarray
) -> list[Diagnostic]:
    """Tell when no surface of the curvature asked for can span a plane boundary curve.

    On a plane curve around the area A the Gauss map of a graph covers at most the area
    pi, so K̄ A < pi; and a sphere through an inscribed circle of radius r touches the
    surface, so K̄ <= 1 / r^2.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` and ``(m, 3)``: one piece without creases.
    boundary
        ``(b,)`` vertices around its only boundary loop, in order, all fixed.
    targets
        ``(n,)`` K̄ [1/L^2].
    asked
        ``(n,)`` vertices of the piece where K is asked for.

    Returns
    -------
    list of Diagnostic
        Sentences, none where nothing speaks against it.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.meshing import boundary_loops
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> edge = boundary_loops(plan.faces)[0]
    >>> [said[:19] for said in existence_problems(plan.vertices, plan.faces, edge, 100 * plan.targets, plan.asked)]
    ['the target 2 is mor']
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
    """Return what K̄ has to stay below over a boundary, None where that is not plane or spans nothing [1/L^2]."""
    axes, reach = plane_of(vertices[boundary])
    if reach > 1e-6:
        return None
    plan = vertices @ axes.T
    rim = plan[boundary]
    x, y = rim.T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
    if area <= FLAT * float(np.ptp(rim, axis=0).max()) ** 2:
        return None  # a seam, over which nothing is spanned
    most = math.pi / area
    within = np.zeros(len(vertices), bool)
    within[faces] = True
    within[boundary] = False
    inside = np.flatnonzero(within)
    if len(inside):
        middle = 0.5 * (rim + np.roll(rim, -1, axis=0))
        reach = float(np.linalg.norm(rim - middle, axis=1).max())
        near, _ = cKDTree(middle).query(plan[inside])
        # The widest circle about a vertex within the curve that the curve stays out of.
        for k in np.argsort(-near, kind="stable")[:50]:
            if _within(plan[inside[k]], rim):
                radius = float(near[k]) - reach
                most = min(most, 1.0 / radius**2) if radius > 0 else most
                break
    return most


def _within(point: FloatArray, polygon: FloatArray) -> bool:
    """Tell whether a point of the plane lies in a polygon, by the crossings to its right."""
    x, y = (polygon - point).T
    ahead_x, ahead_y = np.roll(x, -1), np.roll(y, -1)
    crosses = (y > 0) != (ahead_y > 0)
    rise = np.where(crosses, ahead_y - y, 1.0)
    return bool(np.count_nonzero(crosses & (x - y * (ahead_x - x) / rise > 0)) % 2)
