"""Where a region is laid out face by face, and along which seams it is cut open."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.csgraph import connected_components
from scipy.sparse.csgraph import dijkstra

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..meshing import boundary_loops
from ..meshing import lost_edges
from ..meshing import path_edges

__all__ = ["Opened", "automatic_seam", "opened", "seam_edges"]


class Opened(NamedTuple):
    """Faces cut open so that they can be laid out, and the way from face to face."""

    order: Indices  # (m,) faces, the first one in the middle
    before: Indices  # (m,) face that each is laid beside, -1 for the first
    side: IntArray  # (m, 2) corners opposite the edge between the two, in the face before and in its own
    corner: IntArray  # (m, 3) number of the place of every corner: vertices on a seam have several
    source: Indices  # (p,) vertex of every place


def opened(vertices: Vertices, faces: Faces, seam: Optional[Edges] = None, name: str = "the region") -> Opened:
    """Cut faces (m, 3) open along the edges of a seam (e, 2), and find the way through them.

    Raises
    ------
    CGCError
        If what comes of it is not one piece without holes.
    """
    m = len(faces)
    edges = edge_faces(faces)
    n = int(faces.max(initial=0)) + 1
    crossed = edges[:, 3] >= 0
    if seam is not None and len(seam):
        crossed &= ~np.isin(np.sort(edges[:, :2], axis=1) @ [n, 1], np.sort(seam, axis=1) @ [n, 1])
    u, v, left, right = edges[crossed].T
    dual = sparse.csr_matrix((np.ones(2 * len(left)), (np.append(left, right), np.append(right, left))), shape=(m, m))
    if connected_components(dual, directed=False)[0] > 1:
        raise CGCError(f"{name} is in several pieces; lay each of them out by itself, or give another seam")
    corner, source = _places(faces, u, v, left, right)
    euler = len(source) - (2 * len(edges) - len(edges[edges[:, 3] < 0]) - len(left)) + m
    if euler != 1:
        raise CGCError(_not_a_disk(name, faces, seam))
    centres = vertices[faces].mean(axis=1)
    first = int(np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1)))
    order, before = breadth_first_order(dual, first, directed=False)
    before = np.where(before < 0, -1, before).astype(np.int64)
    return Opened(order.astype(np.int64), before, _sides(faces, before), corner, source)


def _not_a_disk(name: str, faces: Faces, seam: Optional[Edges]) -> str:
    loops = len(boundary_loops(faces))
    if seam is not None and len(seam):
        return f"the seam does not open {name} to one piece without holes; lead it from edge to edge, or give seam='auto'"
    if loops == 0:
        return f"{name} is closed; give a seam to open it along, a path of vertices"
    if loops == 1:
        return f"{name} has a handle; give a seam that opens it"
    return f"{name} has a hole, so it needs a seam: a path of vertices from one edge to the other, or seam='auto'"


def _places(faces: Faces, u: Indices, v: Indices, left: Indices, right: Indices) -> tuple[IntArray, Indices]:
    """Number the corners of faces so that those on the two sides of crossed edges are one."""
    m = len(faces)

    def at(vertex: Indices, face: Indices) -> Indices:
        return 3 * face + np.argmax(faces[face] == vertex[:, None], axis=1)

    one = np.concatenate([at(u, left), at(v, left)])
    other = np.concatenate([at(u, right), at(v, right)])
    joined = sparse.csr_matrix((np.ones(len(one)), (one, other)), shape=(3 * m, 3 * m))
    count, label = connected_components(joined, directed=False)
    source = np.empty(count, np.int64)
    source[label] = faces.ravel()
    return label.reshape(m, 3).astype(np.int64), source


def _sides(faces: Faces, before: Indices) -> IntArray:
    """Return the corners opposite the edge between every face and the one before it (m, 2)."""
    sides = np.zeros((len(faces), 2), np.int64)
    own = np.flatnonzero(before >= 0)
    mine, theirs = faces[own], faces[before[own]]
    for k, (here, there) in enumerate(((theirs, mine), (mine, theirs))):
        alone = ~(here[:, :, None] == there[:, None, :]).any(axis=2)
        sides[own, k] = np.argmax(alone, axis=1)
    return sides


def seam_edges(faces: Faces, seam: Union[Sequence[int], Sequence[Sequence[int]]]) -> Edges:
    """Return the edges (e, 2) of a seam: one path of vertices, or several.

    Raises
    ------
    CGCError
        If it does not follow edges of the faces.
    """
    paths = [seam] if len(seam) and np.ndim(seam[0]) == 0 else seam
    edges = np.array(path_edges(paths), dtype=np.int64).reshape(-1, 2)  # type: ignore[arg-type]
    lost = lost_edges(faces, edges)
    if lost.any():
        a, b = edges[np.argmax(lost)].tolist()
        raise CGCError(f"the seam from vertex {a} to {b} does not follow an edge of the region; lead it along edges")
    return edges


def automatic_seam(vertices: Vertices, faces: Faces) -> Edges:
    """Return the shortest edges (e, 2) that join every hole of some faces to their outer edge, one after the other.

    Empty where there is no hole.
    """
    loops = boundary_loops(faces)
    if len(loops) < 2:
        return np.empty((0, 2), np.int64)
    edges = edge_faces(faces)
    inner = edges[edges[:, 3] >= 0, :2]
    length = np.linalg.norm(vertices[inner[:, 0]] - vertices[inner[:, 1]], axis=1)
    graph = sparse.csr_matrix((length, (inner[:, 0], inner[:, 1])), shape=(len(vertices), len(vertices)))
    longest = max(loops, key=lambda loop: _length(vertices, loop))
    reached, waiting, found = [longest], [loop for loop in loops if loop is not longest], []
    while waiting:
        distance, before, _ = dijkstra(graph, directed=False, indices=np.concatenate(reached), return_predecessors=True, min_only=True)
        k = int(np.argmin([distance[loop].min() for loop in waiting]))
        loop = waiting.pop(k)
        path = [int(loop[np.argmin(distance[loop])])]
        while before[path[-1]] >= 0:
            path.append(int(before[path[-1]]))
        found += list(zip(path[:-1], path[1:]))
        reached += [loop, np.array(path)]
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def _length(vertices: Vertices, loop: Indices) -> float:
    return float(np.linalg.norm(vertices[loop] - vertices[np.roll(loop, -1)], axis=1).sum())
