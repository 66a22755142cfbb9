"""Layout of faces on a surface of constant curvature by rigid motions from face to face."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.csgraph import connected_components

from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from . import _layout
from . import space_form

__all__ = ["Layout", "among", "cut_open", "lay"]


class Layout(NamedTuple):
    """Faces on a surface of constant curvature, open along edges that are not joined."""

    points: FloatArray  # (p, 3) points of the space form
    faces: Faces  # (m, 3) indices of points at the corners of every face
    origin: Indices  # (p,) vertex of every point; a vertex on a seam has several points
    gap: float  # largest distance between the positions of a vertex in different faces [L]
    edge_error: float  # largest relative difference between an edge and its chord in the layout


def lay(vertices: Vertices, faces: Faces, joined: Edges, K: float, arc: bool = False) -> Layout:
    """Lay out faces (m, 3) breadth first from the centre of every piece.

    Each face moves rigidly to its predecessor, so that errors do not grow from ring to ring.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    joined
        ``(e, 4)`` edges that stay joined, with their left and right faces.
    K
        Gaussian curvature [1/L^2].
    arc
        Whether edges are arc lengths instead of chords.
    """
    order, before = _way(vertices, faces, joined)
    corners = _layout.laid(vertices, faces, order, before, _sides(faces, before), K, arc)
    opened, origin = cut_open(faces, joined)
    flat, where = corners.reshape(-1, 3), opened.ravel()
    count = np.bincount(where, minlength=len(origin))
    mean = np.column_stack([np.bincount(where, flat[:, k], len(origin)) / count for k in range(3)])
    first = np.empty(len(origin), np.int64)
    first[where[::-1]] = np.arange(len(where))[::-1]
    gap = float(space_form.chords(flat, flat[first[where]], K).max(initial=0.0))
    # Project the mean of the positions back onto the surface.
    points = space_form.normalised(mean, K)
    return Layout(points, opened, origin, gap, _edge_error(vertices, faces, points[opened], K, arc))


def among(edges: Edges, chosen: Optional[ArrayLike], n: int) -> Mask:
    """Return which edges (e, 2) are among others (s, 2) of a mesh of n vertices, regardless of direction (e,)."""
    own = np.sort(edges, axis=1) @ np.array([n, 1])
    others = np.sort(np.asarray(() if chosen is None else chosen, dtype=np.int64).reshape(-1, 2), axis=1) @ np.array([n, 1])
    return np.isin(own, others)


def cut_open(faces: Faces, joined: Edges) -> tuple[Faces, IntArray]:
    """Return faces (m, 3) that share vertices only across joined edges (e, 4), and the old vertex of each new one (k,)."""
    m = len(faces)
    u, v, left, right = joined.T
    pairs = np.vstack([np.column_stack([_corner(faces, left, w), _corner(faces, right, w)]) for w in (u, v)])
    graph = sparse.coo_matrix((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(3 * m, 3 * m))
    _, label = connected_components(graph, directed=False)
    # Keep the order of the old vertices: a mesh without seams keeps its numbering.
    _, first = np.unique(label, return_index=True)
    order = np.argsort(faces.ravel()[first], kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return rank[label].reshape(m, 3), faces.ravel()[first][order]


def _way(V: Vertices, F: Faces, joined: Edges) -> tuple[Indices, Indices]:
    """Return the order of layout (m,) and the predecessor of every face (m,), -1 for the first ones."""
    m = len(F)
    left, right = joined[:, 2:].T
    graph = sparse.coo_matrix((np.ones(2 * len(left)), (np.r_[left, right], np.r_[right, left])), shape=(m, m)).tocsr()
    count, part = connected_components(graph, directed=False)
    centres = V[F].mean(axis=1)
    order, before = [], np.full(m, -1)
    for label in range(count):
        inside = np.flatnonzero(part == label) if count > 1 else np.arange(m)
        middle = inside[np.argmin(np.linalg.norm(centres[inside] - centres[inside].mean(axis=0), axis=1))]
        reached, parents = breadth_first_order(graph, middle, directed=False)
        order.append(reached)
        before[reached[1:]] = parents[reached[1:]]
    return np.concatenate(order).astype(np.int64), before


def _sides(faces: Faces, before: Indices) -> IntArray:
    """Return the corners opposite the edge shared with the predecessor, in the predecessor and in the face (m, 2)."""
    sides = np.zeros((len(faces), 2), np.int64)
    own = np.flatnonzero(before >= 0)
    mine, theirs = faces[own], faces[before[own]]
    for k, (here, there) in enumerate(((theirs, mine), (mine, theirs))):
        alone = ~(here[:, :, None] == there[:, None, :]).any(axis=2)
        sides[own, k] = np.argmax(alone, axis=1)
    return sides


def _corner(F: Faces, faces: IntArray, vertices: IntArray) -> IntArray:
    """Return the corners, numbered over all faces, of given vertices in given faces."""
    return 3 * faces + np.argmax(F[faces] == vertices[:, None], axis=1)


def _edge_error(V: Vertices, F: Faces, corners: FloatArray, K: float, arc: bool) -> float:
    """Return the largest relative difference between edges and those of the layout with corners (m, 3, 3)."""
    there, places = corners.reshape(-1, 3), V[F]
    chord = space_form.chords(there, np.roll(corners, -1, axis=1).reshape(-1, 3), K)
    own = space_form.geodesics(chord, K) if arc else chord
    long = np.linalg.norm(np.roll(places, -1, axis=1) - places, axis=2).ravel()
    return float((np.abs(own - long) / long).max(initial=0.0))
