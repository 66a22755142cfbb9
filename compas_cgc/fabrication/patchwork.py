"""Patchwork: a surface cut into flat pieces that keep their common nodes."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..meshing.split_sides import split_sides
from ..meshing.split_sides import weighted

__all__ = ["CREASE", "CUT", "EDGE", "FREE", "SEAM", "SIDES", "Patchwork", "split_piece"]

# Kinds of sides of faces, from lines of subdivision to boundaries of the surface.
SIDES = ("none", "fold", "cut", "seam", "crease", "edge")
NONE, EDGE, CUT, SEAM, CREASE, FREE = range(len(SIDES))


@dataclass(frozen=True)
class Patchwork:
    """A mesh with every face also placed in the plane, piece by piece.

    A cut adds its nodes to both neighbours, so that both sides of every seam have the same edges.
    """

    space: Vertices  # (n, 3) nodes on the surface [L]
    names: IntArray  # (n,) keys of the nodes; those of mesh vertices are kept
    faces: Faces  # (m, 3) nodes
    plane: FloatArray  # (m, 3, 2) position of every corner [L]
    side: IntArray  # (m, 3) kind of the side from a corner to the next, index into SIDES
    piece: IntArray  # (m,) piece of every face
    region: IntArray  # (m,) region of every face
    parent: IntArray  # (m,) mesh face that contains it

    def size(self) -> float:
        """Return the largest extent along an axis of the plane [L]."""
        return float(np.ptp(self.plane.reshape(-1, 2), axis=0).max(initial=0.0))


def mates(faces: Faces) -> IntArray:
    """Return the opposite half-edge of every side, as 3 x face + corner, or -1 (m, 3)."""
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max(initial=0)) + 1
    key = np.minimum(u, v) * n + np.maximum(u, v)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    mate = np.full(len(key), -1)
    mate[order[same]], mate[order[same + 1]] = order[same + 1], order[same]
    return mate.reshape(-1, 3)


def pairs_of_equal(one: IntArray, other: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the common values of two arrays, with all pairs of their positions."""
    order = np.argsort(other, kind="stable")
    low, high = np.searchsorted(other[order], one, "left"), np.searchsorted(other[order], one, "right")
    count = high - low
    first = np.repeat(np.arange(len(one)), count)
    second = order[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)]
    return one[first], first, second


def weights_in(corners: FloatArray, points: FloatArray) -> FloatArray:
    """Return the barycentric weights of points (k, 3) in triangles (k, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    u, v, w = b - a, c - a, points - a
    uu, uv, vv = (np.einsum("ij,ij->i", x, y) for x, y in ((u, u), (u, v), (v, v)))
    wu, wv = np.einsum("ij,ij->i", w, u), np.einsum("ij,ij->i", w, v)
    area = uu * vv - uv * uv
    s, t = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    return np.column_stack([1.0 - s - t, s, t])


def outline_sides(patchwork: Patchwork) -> Mask:
    """Return which sides bound their piece (m, 3)."""
    mate = mates(patchwork.faces)
    other = np.where(mate >= 0, patchwork.piece[mate // 3], -1)
    return (patchwork.side >= SEAM) | (other != patchwork.piece[:, None])


def connected_pieces(patchwork: Patchwork) -> Patchwork:
    """Renumber the pieces so that each connected part is one, in the order of first faces."""
    mate = mates(patchwork.faces)
    within = np.argwhere(~outline_sides(patchwork))
    m = len(patchwork.faces)
    graph = sparse.coo_matrix((np.ones(len(within), np.int8), (within[:, 0], mate[within[:, 0], within[:, 1]] // 3)), shape=(m, m))
    _, label = connected_components(graph, directed=False)
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return replace(patchwork, piece=rank[inverse.ravel()])


def split_piece(patchwork: Patchwork, piece: int, normal: FloatArray, level: float, tolerance: float) -> Patchwork:
    """Cut a piece along a straight line in its plane.

    Where the line meets an edge shared with another piece, the faces of both get the new node.

    Parameters
    ----------
    patchwork
        The surface.
    piece
        Number of the piece.
    normal, level
        The line ``x @ normal = level``, with a unit normal (2,).
    tolerance
        Distance from the line below which a node lies on it [L].

    Returns
    -------
    Patchwork
        Patchwork in which the part beyond the line is a new piece with the next free number.
    """
    own = patchwork
    while True:
        inside = own.piece == piece
        place = np.sign(_heights(own.plane, normal, level, tolerance))
        crossing = (place * np.roll(place, -1, axis=1) < 0) & inside[:, None]
        if not crossing.any():
            break
        own = _with_nodes(own, crossing, own.plane @ normal - level)
    middle = _heights(own.plane, normal, level, tolerance).sum(axis=1)
    beyond = inside & (middle > 0)
    labels = np.where(beyond, own.piece.max() + 1, own.piece)
    # Edges between the two parts become cuts.
    mate = mates(own.faces)
    parted = (mate >= 0) & (labels[mate // 3] != labels[:, None]) & (own.piece[mate // 3] == own.piece[:, None]) & (own.side < SEAM)
    return replace(own, piece=labels, side=np.where(parted, CUT, own.side))


def _heights(plane: FloatArray, normal: FloatArray, level: float, tolerance: float) -> FloatArray:
    height = plane @ normal - level
    return np.where(np.abs(height) <= tolerance, 0.0, height)


def _with_nodes(own: Patchwork, crossing: Mask, height: FloatArray) -> Patchwork:
    """Insert a node at the zero of `height` on every edge with a crossing side, and divide its faces."""
    split = split_sides(own.faces, crossing, height, np.roll(height, -1, axis=1), len(own.space))
    tail, head = split.ends.T
    nodes = (1.0 - split.share)[:, None] * own.space[tail] + split.share[:, None] * own.space[head]
    names = np.r_[own.names, own.names.max(initial=-1) + 1 + np.arange(len(nodes))]
    plane = weighted(split.weights, own.plane[split.parent])
    side = np.where(split.side < 0, NONE, np.take_along_axis(own.side[split.parent], split.side, axis=1))
    old = split.parent
    return Patchwork(np.vstack([own.space, nodes]), names, split.faces, plane, side, own.piece[old], own.region[old], own.parent[old])
