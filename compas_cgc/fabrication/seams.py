"""Seams: edges to cut so that a surface can be laid out, the shortest ones or given paths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Union

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.csgraph import connected_components
from scipy.sparse.csgraph import dijkstra

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..meshing import boundary_loops
from ..meshing import lost_edges
from ..meshing import path_edges

__all__ = ["along_paths", "opens_to_disks", "seam_edges"]


def seam_edges(vertices: Vertices, faces: Faces, cones: Mask) -> Edges:
    """Return the edges to cut so that a connected surface becomes a disk with no cone inside.

    A tree of shortest paths connects one boundary loop (or the first cone) with all other loops and cones; a cotree of
    faces opens the remaining handles.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices of a connected oriented manifold.
    cones
        ``(n,)`` mask of inner vertices with an angle defect, which must lie on a seam.

    Returns
    -------
    (s, 2) int64
        Empty for a disk without cones.

    References
    ----------
    Erickson and Whittlesey, Greedy optimal homotopy and homology generators, SODA 2005 (tree and cotree).
    """
    edges = edge_faces(faces)
    inner = edges[edges[:, 3] >= 0]
    node, terminals = _contracted(len(vertices), faces, cones)
    if not len(terminals):
        # On a closed surface without cones any vertex may be the root.
        terminals = node[faces[0, :1]]
    tree = _tree(vertices, inner, node, int(terminals[0]))
    crossed = _cotree(len(faces), inner, tree)
    return inner[_pruned(node[inner[:, :2]], ~crossed, terminals), :2]


def along_paths(faces: Faces, seam: Union[Sequence[int], Sequence[Sequence[int]]]) -> Edges:
    """Return the edges (e, 2) of one or more paths of vertices.

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
        raise CGCError(f"the seam from vertex {a} to {b} does not follow an edge of the region; define it along edges")
    return edges


def opens_to_disks(faces: Faces) -> bool:
    """Check whether every connected part of cut faces (m, 3) is a disk."""
    edges = edge_faces(faces)
    graph = sparse.coo_matrix((np.ones(len(edges), np.int8), (edges[:, 0], edges[:, 1])), shape=(int(faces.max()) + 1,) * 2)
    _, label = connected_components(graph, directed=False)
    used = np.unique(faces)
    parts = len(np.unique(label[used]))
    return len(boundary_loops(faces)) == parts and len(used) - len(edges) + len(faces) == parts


def _contracted(n: int, faces: Faces, cones: Mask) -> tuple[IntArray, IntArray]:
    """Return vertices with every boundary loop contracted to its first one (n,), and the vertices that seams must reach."""
    node = np.arange(n)
    roots = []
    for loop in boundary_loops(faces):
        node[loop] = loop[0]
        roots.append(loop[0])
    return node, np.array([*roots, *np.flatnonzero(cones & (node == np.arange(n)))], dtype=np.int64)


def _tree(V: Vertices, inner: Edges, node: IntArray, root: int) -> Mask:
    """Return the mask of inner edges on the tree of shortest paths from a root."""
    n = len(node)
    a, b = node[inner[:, 0]], node[inner[:, 1]]
    length = np.linalg.norm(V[inner[:, 0]] - V[inner[:, 1]], axis=1)
    low, high = np.minimum(a, b), np.maximum(a, b)
    # Keep the shortest of parallel edges between contracted loops, and no loops.
    order = np.lexsort((length, high, low))
    order = order[low[order] != high[order]]
    _, first = np.unique(low[order] * n + high[order], return_index=True)
    kept = order[first]
    graph = sparse.coo_matrix((length[kept], (low[kept], high[kept])), shape=(n, n)).tocsr()
    _, before = dijkstra(graph, directed=False, indices=root, return_predecessors=True)
    tree = np.zeros(len(inner), bool)
    tree[kept] = (before[low[kept]] == high[kept]) | (before[high[kept]] == low[kept])
    return tree


def _cotree(m: int, inner: Edges, tree: Mask) -> Mask:
    """Return the mask of inner edges crossed by a tree of faces that avoids a tree of edges."""
    open_ = np.flatnonzero(~tree)
    left, right = inner[open_, 2], inner[open_, 3]
    graph = sparse.coo_matrix((np.ones(len(open_)), (left, right)), shape=(m, m)).tocsr()
    _, before = breadth_first_order(graph, 0, directed=False)
    crossed = np.zeros(len(inner), bool)
    crossed[open_] = (before[left] == right) | (before[right] == left)
    # Of two edges shared by two faces the tree crosses one.
    hit = np.flatnonzero(crossed)
    key = np.sort(inner[hit, 2:], axis=1) @ [m, 1]
    _, first = np.unique(key, return_index=True)
    crossed[:] = False
    crossed[hit[first]] = True
    return crossed


def _pruned(ends: IntArray, kept: Mask, terminals: IntArray) -> Mask:
    """Return the mask without branches that end at no terminal."""
    fixed = np.zeros(int(ends.max(initial=0)) + 1, bool)
    fixed[terminals[terminals < len(fixed)]] = True
    left = np.flatnonzero(kept)
    while True:
        # Only the remaining edges are checked; each round removes one edge per branch.
        valence = np.bincount(ends[left].ravel(), minlength=len(fixed))
        loose = ((valence == 1) & ~fixed)[ends[left]].any(axis=1)
        if not loose.any():
            pruned = np.zeros(len(kept), bool)
            pruned[left] = True
            return pruned
        left = left[~loose]
