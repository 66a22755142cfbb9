"""Outlines of pieces, and the seams between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .patchwork import CREASE
from .patchwork import CUT
from .patchwork import SIDES
from .patchwork import Patchwork
from .patchwork import mates
from .patchwork import outline_sides

__all__ = ["Loop", "Seam", "outline_loops", "seams_between"]


class Loop(NamedTuple):
    """A closed outline of a piece, with the piece to its left."""

    nodes: IntArray  # (k,)
    points: FloatArray  # (k, 2) [L]


class Seam(NamedTuple):
    """A line along which two pieces, or two sides of one piece, are joined."""

    number: int
    kind: str  # crease, seam or cut
    pieces: tuple[int, int]
    nodes: IntArray  # (k,) nodes along the seam; the first piece lies to its left
    sides: tuple[FloatArray, FloatArray]  # (k, 2) the line in the plane of each piece [L]
    lengths: tuple[float, float]  # of each side in the plane [L]
    length: float  # in space [L]


def outline_loops(patchwork: Patchwork) -> list[list[Loop]]:
    """Return the loops around every piece, the outer one first."""
    out = outline_sides(patchwork)
    start, piece = patchwork.plane[out], np.broadcast_to(patchwork.piece[:, None], out.shape)[out]
    tail, head = _fans(patchwork, out)
    loops: list[list[Loop]] = [[] for _ in range(int(patchwork.piece.max()) + 1)]
    after = {int(corner): i for i, corner in enumerate(tail.tolist())}
    nodes = patchwork.faces[out]
    seen = np.zeros(len(nodes), bool)
    for first in range(len(nodes)):
        if seen[first]:
            continue
        chain, at = [], first
        while not seen[at]:
            seen[at] = True
            chain.append(at)
            at = after[int(head[at])]
        loops[piece[first]].append(Loop(nodes[chain], start[chain]))
    for own in loops:
        own.sort(key=lambda loop: -signed_area(loop.points))
    return loops


def signed_area(points: FloatArray) -> float:
    """Return the signed area of a polygon (k, 2), positive if counterclockwise [L^2]."""
    x, y = (points - points.mean(axis=0)).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def seams_between(patchwork: Patchwork) -> list[Seam]:
    """Return the seams, numbered from 1: connected lines of one kind between the same two pieces."""
    mate = mates(patchwork.faces).ravel()
    out = outline_sides(patchwork).ravel()
    side = np.flatnonzero(out & (mate > np.arange(len(mate))))
    piece = np.repeat(patchwork.piece, 3)
    # The piece with the smaller number lies to the left; within one piece the orientation is consistent.
    left = np.where(piece[side] < piece[mate[side]], side, mate[side])
    within = piece[side] == piece[mate[side]]
    left[within] = _one_way(patchwork, side[within], mate)
    right = mate[left]
    kind = np.clip(patchwork.side.ravel()[left], CUT, CREASE)
    keys = np.column_stack([piece[left], piece[right], kind])
    seams: list[Seam] = []
    for key in np.unique(keys, axis=0):
        chosen = left[(keys == key).all(axis=1)]
        for chain in _chains(patchwork, chosen):
            seams.append(_seam(patchwork, len(seams) + 1, chain, mate))
    return seams


def _one_way(own: Patchwork, sides: IntArray, mate: IntArray) -> IntArray:
    """Return sides (k,) within one piece, or their mates, so that consecutive sides have the same orientation."""
    both = np.r_[sides, mate[sides]]
    order = np.argsort(own.faces.ravel()[both], kind="stable")
    node = own.faces.ravel()[both[order]]
    first = np.flatnonzero(np.r_[True, node[1:] != node[:-1]])
    pairs = first[np.diff(np.r_[first, len(node)]) == 2]
    one, other = both[order[pairs]], both[order[pairs + 1]]
    # A side that arrives at a node is the mate of one that leaves it.
    ahead, after = np.r_[mate[one], mate[other]], np.r_[other, one]
    graph = sparse.coo_matrix((np.ones(len(ahead), np.int8), (ahead, after)), shape=(len(mate),) * 2)
    label = connected_components(graph, directed=False)[1]
    lowest = np.full(len(mate), len(mate))
    np.minimum.at(lowest, label[both], both)
    return np.where(lowest[label[sides]] <= lowest[label[mate[sides]]], sides, mate[sides])


def _seam(own: Patchwork, number: int, chain: IntArray, mate: IntArray) -> Seam:
    nodes, plane = own.faces.ravel(), own.plane.reshape(-1, 2)
    path = np.r_[nodes[chain], nodes[_next(chain[-1:])]]
    left = np.vstack([plane[chain], plane[_next(chain[-1:])]])
    across = mate[chain]
    right = np.vstack([plane[_next(across)], plane[across[-1:]]])
    lengths = tuple(_chord(plane, each) for each in (chain, across))
    piece = np.repeat(own.piece, 3)
    space = float(np.linalg.norm(np.diff(own.space[path], axis=0), axis=1).sum())
    kind = SIDES[int(np.clip(own.side.ravel()[chain[0]], CUT, CREASE))]
    return Seam(number, kind, (int(piece[chain[0]]), int(piece[across[0]])), path, (left, right), (lengths[0], lengths[1]), space)


def _chord(plane: FloatArray, sides: IntArray) -> float:
    return float(np.linalg.norm(plane[_next(sides)] - plane[sides], axis=1).sum())


def _next(corner: IntArray) -> IntArray:
    """Return the corner after each in its face, numbered through all faces."""
    return corner - corner % 3 + (corner % 3 + 1) % 3


def _chains(own: Patchwork, sides: IntArray) -> list[IntArray]:
    """Return sides as chains of consecutive ones; a chain ends at branching nodes."""
    nodes = own.faces.ravel()
    tail, head = nodes[sides], nodes[_next(sides)]
    leaving = np.bincount(tail, minlength=len(own.space))
    arriving = np.bincount(head, minlength=len(own.space))
    through = (leaving == 1) & (arriving == 1)
    at = {int(u): i for i, u in enumerate(tail.tolist())}
    seen = np.zeros(len(sides), bool)
    chains = []
    # Open chains first, then closed ones.
    for first in np.argsort(through[tail], kind="stable").tolist():
        chain, i = [], first
        while not seen[i]:
            seen[i] = True
            chain.append(int(sides[i]))
            if through[head[i]] and int(head[i]) in at:
                i = at[int(head[i])]
        if chain:
            chains.append(np.array(chain, dtype=np.int64))
    return chains


def _fans(own: Patchwork, out: np.ndarray) -> tuple[IntArray, IntArray]:
    """Return the corner fans at the start and the end of every outline side.

    A node that an outline passes twice has one fan of faces per pass, found by turning around the node inside the piece.
    """
    mate = mates(own.faces).ravel()
    flat = out.ravel()
    sides = np.flatnonzero(flat)
    # Turn through the faces from the end of a side to the next outline side.
    corner = _next(sides)
    while True:
        inner = ~flat[corner]
        if not inner.any():
            break
        corner[inner] = _next(mate[corner[inner]])
    return sides, corner
