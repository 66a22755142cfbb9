"""Panels: regions divided into groups of faces, along a grid in plan, lines of curvature, or curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..meshing import path_edges
from ..meshing.map_matching import edge_net
from ..meshing.trace import trace_curve
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from .grids import curvature_coordinates
from .grids import plan_coordinates
from .grids import square_coordinates
from .option_values import ALONG

__all__ = ["Panel", "panels"]

ROUNDS = 5  # in which faces go over to the panel that most of their neighbours are of
CRUMB = 0.2  # faces of a panel, against their share of the region, below which it goes to a neighbour
JUST = 1e-6  # part of a panel by which it may be larger than asked


class Panel(NamedTuple):
    """A group of faces of one region.

    Parameters
    ----------
    name
        Such as 3-07, region and number.
    region
        Its number.
    faces
        (f,) of the mesh, by their positions.

    Examples
    --------
    >>> Panel("A1", 0, np.array([0, 1])).name
    'A1'
    """

    name: str  # such as 3-07, region and number
    region: int
    faces: Indices  # (f,) of the mesh, by their positions


def panels(
    mesh: PosesProblem,
    size: Optional[float] = None,
    *,
    count: Optional[int] = None,
    curves: Optional[Sequence[ArrayLike]] = None,
    along: str = "plan",
) -> list[Panel]:
    """Divide every region into panels.

    Panels are groups of whole faces, so they are bounded by mesh edges and nothing of the mesh is cut: grid lines are moved by
    up to half an edge to where they follow edges best. Draw the mesh along the joints where these matter.

    Parameters
    ----------
    mesh
        A result, mesh or problem.
    size
        Width of the panels, nearly: every region is divided into a whole number of them [L].
    count
        Instead: panels that every region is divided into, nearly.
    curves
        Instead: paths of vertices by their positions, or curves as points ``(k, 3)`` [L], which the edges nearest to them follow.
    along
        ``"plan"`` for a grid along the sides of regions with four corners, else along the axes of the plan; ``"curvature"`` for
        one along the lines of curvature.

    Returns
    -------
    list of Panel
        In the order of the regions.

    Raises
    ------
    CGCError
        If not exactly one of `size`, `count` and `curves` is given, or it makes no sense.

    Examples
    --------
    >>> import compas_cgc
    >>> divided = panels(compas_cgc.read(compas_cgc.get("facade.3dm")), 4.0)
    >>> len(divided), divided[0].name
    (6, '0-1')
    """
    if sum(given is not None for given in (size, count, curves)) != 1:
        raise CGCError("say how to divide the regions by one of size, count and curves")
    if along not in ALONG:
        raise CGCError(f"along must be one of {', '.join(ALONG)}, not {along!r}")
    if size is not None and not (math.isfinite(size) and size > 0.0):
        raise CGCError(f"the size of panels must be a positive length, not {size!r}")
    if count is not None and not count >= 1:
        raise CGCError(f"there must be at least one panel to a region, not {count!r}")
    problem = mesh.to_problem().without_dummies()
    label = problem.regions()
    blocked = None if curves is None else _curve_edges(problem, curves)
    found: list[Panel] = []
    for region in range(int(label.max(initial=-1)) + 1):
        own = np.flatnonzero(label == region)
        used, corners = np.unique(problem.faces[own], return_inverse=True)
        V, F = problem.vertices[used], corners.reshape(-1, 3)
        if blocked is not None:
            cell = _pieces(F, _within(blocked, used))
        else:
            cell = _grid_cells(V, F, _coordinates(V, F, along), size, count)
        number = int(cell.max(initial=-1)) + 1
        digits = len(str(number))
        found += [Panel(f"{region}-{k + 1:0{digits}}", region, own[cell == k]) for k in range(number)]
    return found


def _coordinates(vertices: Vertices, faces: Faces, along: str) -> FloatArray:
    if along == "curvature":
        return curvature_coordinates(vertices, faces)
    square = square_coordinates(vertices, faces)
    return plan_coordinates(vertices, faces) if square is None else square


def _grid_cells(V: Vertices, F: Faces, at: FloatArray, size: Optional[float], count: Optional[int]) -> Indices:
    """Return the panel of every face (m,), from 0, by the coordinates of the vertices (n, 2)."""
    low, extent = at.min(axis=0), np.maximum(np.ptp(at, axis=0), np.finfo(float).tiny)
    if size is not None:
        numbers = [max(1, round(min(wide / size, 1e9))) for wide in extent.tolist()]
    else:
        first = max(1, round(math.sqrt((count or 1) * extent[0] / extent[1])))
        numbers = [first, max(1, round((count or 1) / first))]
    if math.prod(numbers) > len(F):
        raise CGCError(f"a region of {len(F)} triangles cannot be divided into {math.prod(numbers)} panels; ask for larger ones")
    middle = at[F].mean(axis=1)
    cell = np.zeros(len(F), np.int64)
    for axis, number in enumerate(numbers):
        lines = low[axis] + extent[axis] * np.arange(1, number) / number
        snapped = [_snapped(line, at[F][:, :, axis]) for line in lines.tolist()]
        cell = number * cell + np.searchsorted(np.sort(snapped), middle[:, axis])
    return _tidied(F, cell, CRUMB * len(F) / math.prod(numbers))


def _snapped(line: float, at: FloatArray) -> float:
    """Return the place nearby where a grid line cuts least into the faces with these coordinates of their corners (m, 3)."""
    low, high = at.min(axis=1), at.max(axis=1)
    reach = 0.5 * float(np.median(high - low))
    near = (low <= line + 2 * reach) & (high >= line - 2 * reach)
    if not near.any():
        return line
    tries = np.unique(np.append(at[near][np.abs(at[near] - line) <= reach * (1 + JUST)], line))
    low, high = low[near], high[near]
    cut = [np.maximum(np.minimum(high - one, one - low), 0.0).sum() + 1e-3 * abs(one - line) for one in tries.tolist()]
    return float(tries[int(np.argmin(cut))])


def _tidied(F: Faces, cell: Indices, few: float) -> Indices:
    """Return panels in one piece each, without teeth and crumbs, numbered in the order of their first cell."""
    edges = edge_faces(F)
    pairs = edges[edges[:, 3] >= 0, 2:]
    both = np.vstack([pairs, pairs[:, ::-1]])
    for _ in range(ROUNDS):
        # A face with two neighbours in one other panel is a tooth.
        other = cell[both[:, 1]]
        key, votes = np.unique(both[:, 0] * (cell.max() + 1) + other, return_counts=True)
        face, wanted = np.divmod(key[votes >= 2], cell.max() + 1)
        change = cell[face] != wanted
        if not change.any():
            break
        cell = cell.copy()
        cell[face[change]] = wanted[change]
    piece = _connected(len(F), pairs[cell[pairs[:, 0]] == cell[pairs[:, 1]]])
    while True:
        count = np.bincount(piece)
        present = np.flatnonzero(count)
        crumbs = present[count[present] < few]
        if not len(crumbs) or len(present) == 1:
            break
        crumb = crumbs[np.argmin(count[crumbs])]
        beside = piece[both[(piece[both[:, 0]] == crumb) & (piece[both[:, 1]] != crumb), 1]]
        if not len(beside):
            break
        piece = np.where(piece == crumb, np.bincount(beside).argmax(), piece)
    numbers, first = np.unique(piece, return_index=True)
    rank = np.empty(numbers.max() + 1, np.int64)
    rank[numbers[np.lexsort((first, cell[first]))]] = np.arange(len(numbers))
    return rank[piece]


def _connected(m: int, pairs: Edges) -> Indices:
    joined = sparse.csr_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(m, m))
    return connected_components(joined, directed=False)[1].astype(np.int64)


def _pieces(F: Faces, blocked: Edges) -> Indices:
    """Return the pieces that edges divide faces into (m,)."""
    edges = edge_faces(F)
    n = int(F.max(initial=0)) + 1
    open_ = (edges[:, 3] >= 0) & ~np.isin(np.sort(edges[:, :2], axis=1) @ [n, 1], np.sort(blocked, axis=1) @ [n, 1])
    return _connected(len(F), edges[open_, 2:])


def _within(edges: Edges, used: Indices) -> Edges:
    """Return the edges whose ends are both in use, by the numbers that these have there."""
    known = np.isin(edges, used).all(axis=1)
    return np.searchsorted(used, edges[known])


def _curve_edges(problem: CGCProblem, curves: Sequence[ArrayLike]) -> Edges:
    """Return the edges (e, 2) along curves."""
    paths: list[list[int]] = []
    net = None
    for number, curve in enumerate(curves):
        points = np.asarray(curve)
        if points.ndim == 1 and points.dtype.kind in "iu":
            paths.append(points.tolist())
            continue
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
            raise CGCError(f"curve {number} must be a path of vertices or points (k, 3), not of shape {points.shape}")
        net = net or edge_net(problem.vertices, problem.faces)
        tolerance = problem.drawing.tolerance or 1e-6 * float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
        found = trace_curve(net, points.astype(np.float64), tolerance).paths
        if not found:
            raise CGCError(f"curve {number} comes nowhere near an edge of the mesh; draw it on the mesh")
        paths += found
    return np.array(path_edges(paths), dtype=np.int64).reshape(-1, 2)
