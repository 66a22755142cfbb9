"""Parameters of meshes that lie over no plane: conformal maps of discs, and harmonic ones of tubes, spheres and tori."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.csgraph import minimum_spanning_tree

from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.laplacian import cotangent_laplacian
from ..discrete.plan import rectangles
from ..errors import MeshError
from ..linalg import factorise
from ..meshing.boundary import boundary_loops

__all__ = ["Unwrapped", "contiguous", "refuse_parts", "unwrapped"]

LARGEST_SCALE = 3.0  # of lengths of a conformal map, from which a surface closes so far that a pole and a rim describe it better
SECOND = 0.25  # of the longest rim, from which the second longest is an end of a tube and not a hole
BINS = 64  # along a tube, over which its lengths are measured
STIFFEST = 1e-9  # of the mean cotangent weight, that every edge has at least, so that maps exist on meshes with slivers
TOO_FEW = "the closed design has too few faces to find its shape; refine the mesh"


class Unwrapped(NamedTuple):
    """Parameters of the vertices of a mesh."""

    uv: FloatArray  # (k, 2) lengths on the average of the surface [L]
    vertices: IntArray  # (k,) the vertex of every pair of parameters; a pole has several
    period: FloatArray  # (2,) of each parameter that closes [L], infinite for others
    poles: tuple[bool, bool]  # whether the first and the last value of the second parameter are one point each
    rims: tuple[IntArray, ...]  # loops of vertices that are not sides of the parameters; holes only where a parameter closes


def refuse_parts(vertices: FloatArray, faces: IntArray) -> None:
    """Check that a mesh is connected.

    Raises
    ------
    MeshError
        If it has several parts.
    """
    single = len(vertices) - len(np.unique(faces))  # vertices without a face
    parts = connected_components(_graph(edge_faces(faces), len(vertices)))[0] - single
    if parts > 1:
        raise MeshError(f"the design has {parts} parts that are not joined; join them, or rationalise one part at a time")


def unwrapped(vertices: FloatArray, faces: IntArray, creases: Sequence[IntArray] = ()) -> Unwrapped:
    """Return parameters of a mesh by its topology.

    A disc, with holes or without, is mapped conformally; a tube is a rectangle that closes in one direction, its ends
    are the two longest rims; a closed surface without handles is a tube between its lowest and highest vertex, and one that is
    nearly closed a tube between its rim and the vertex opposite; a ring with one handle closes in both directions.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    creases
        Vertices of sharp edges (2,), beside which the parameter around a tube does not close.

    Raises
    ------
    MeshError
        If the surface has several handles, or is not orientable.

    References
    ----------
    Levy, Petitjean, Ray, Maillot, *Least squares conformal maps*, 2002, doi:10.1145/566654.566590. Gu, Yau, *Global conformal
    surface parameterization*, 2003.
    """
    n, edges, loops = len(np.unique(faces)), edge_faces(faces), boundary_loops(faces)
    handles = (2 - len(loops) - (n - len(edges) + len(faces))) / 2
    if handles < 0:
        raise MeshError("faces of the design meet at single vertices, or three at an edge; repair the mesh, or rationalise its parts")
    if handles == 0 and len(loops) == 0:
        return _sphere(vertices, faces)
    if handles == 0 and _is_tube(vertices, loops):
        return _tube(vertices, faces, loops, creases)
    if handles == 0:
        flat = _disc(vertices, faces, loops)
        return flat if _scale(vertices, faces, flat) <= LARGEST_SCALE else _cap(vertices, faces, loops)
    if handles == 1 and not loops:
        return _torus(vertices, faces)
    raise MeshError(
        f"the design has {handles:g} handles and {len(loops)} rims; give a NURBS surface, or divide the design into parts without handles"
    )


def _is_tube(vertices: FloatArray, loops: list[IntArray]) -> bool:
    """Return whether the second longest rim is the other end of a tube, rather than that of a hole."""
    if len(loops) < 2:
        return False
    lengths = sorted((_length(vertices, loop) for loop in loops), reverse=True)
    return lengths[1] > SECOND * lengths[0]


def _length(vertices: FloatArray, loop: IntArray) -> float:
    return float(np.linalg.norm(vertices[loop] - vertices[np.roll(loop, -1)], axis=1).sum())


def _disc(vertices: FloatArray, faces: IntArray, loops: list[IntArray]) -> Unwrapped:
    """Return the least squares conformal map, as large as the surface and turned into the narrowest rectangle."""
    n, used = len(vertices), np.unique(faces)
    stiffness = -cotangent_laplacian(vertices, faces)
    # The area of the map is a quadratic form of its rims.
    half = sparse.coo_matrix((np.full(3 * len(faces), 0.5), (faces.ravel(), np.roll(faces, -1, axis=1).ravel())), shape=(n, n))
    area = (half - half.T).tocsr()
    matrix = sparse.bmat([[stiffness, -area], [area, stiffness]], format="csr")
    loop = max(loops, key=lambda own: _length(vertices, own))
    first = int(loop[0])
    last = int(loop[np.argmax(np.linalg.norm(vertices[loop] - vertices[first], axis=1))])
    known = np.zeros(2 * n, bool)
    known[[first, last, n + first, n + last]] = True
    values = np.zeros(2 * n)
    values[last] = float(np.linalg.norm(vertices[last] - vertices[first]))
    free = np.concatenate([used, n + used])
    free = free[~known[free]]
    places = np.tile(vertices, (2, 1))[free]
    values[free] = factorise(matrix[free][:, free].tocsr(), symmetric=True, points=places).solve(-(matrix[free] @ values))
    uv = values.reshape(2, n).T
    uv = uv * np.sqrt(_area(vertices, faces) / max(abs(_plane_area(uv, faces)), 1e-300))
    uv = _narrowest(uv, used)
    return Unwrapped(uv[used], used, np.full(2, np.inf), (False, False), tuple(loops))


def _tube(vertices: FloatArray, faces: IntArray, loops: list[IntArray], creases: Sequence[IntArray]) -> Unwrapped:
    """Return an angle around a surface and a length along it, both harmonic; the length follows the surface on the average."""
    first, last, *holes = sorted(loops, key=lambda own: -_length(vertices, own))
    if vertices[first, 2].mean() > vertices[last, 2].mean():
        first, last = last, first
    uv, used = _around_and_along(vertices, faces, first, last)
    turn = _turn(vertices, faces, uv, used)
    uv = _turned_as(faces, uv, used, np.array([1.0, np.inf]))
    uv[:, 0] = _started_beside(uv[:, 0], used, [*holes, *creases])
    return Unwrapped(uv * [turn, 1.0], used, np.array([turn, np.inf]), (False, False), tuple(holes))


def _sphere(vertices: FloatArray, faces: IntArray) -> Unwrapped:
    """Return the parameters of a closed surface: those of a tube between its lowest and its highest vertex."""
    used = np.unique(faces)
    heights = vertices[used, 2]
    ends = [int(used[np.argmin(heights)]), int(used[np.argmax(heights)])]
    return _to_poles(vertices, faces, [], ends, [])


def _cap(vertices: FloatArray, faces: IntArray, loops: list[IntArray]) -> Unwrapped:
    """Return the parameters of a surface that is nearly closed: those of a tube between its longest rim and the farthest vertex."""
    rim, *holes = sorted(loops, key=lambda own: -_length(vertices, own))
    edges = edge_faces(faces)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    graph = sparse.csr_matrix((lengths, (edges[:, 0], edges[:, 1])), shape=(len(vertices),) * 2)
    away = dijkstra(graph, directed=False, indices=rim, min_only=True)
    away[~np.isfinite(away)] = 0.0
    away[np.concatenate(loops)] = 0.0
    return _to_poles(vertices, faces, [rim], [int(np.argmax(away))], holes)


def _to_poles(vertices: FloatArray, faces: IntArray, rims: list[IntArray], ends: list[int], holes: list[IntArray]) -> Unwrapped:
    """Return the parameters of a surface between a rim and a pole, or two poles."""
    around = [(faces == end).any(axis=1) for end in ends]
    if np.count_nonzero(np.array(around), axis=0).max() > 1:
        raise MeshError(TOO_FEW)
    body = faces[~np.any(around, axis=0)]
    rings = [np.setdiff1d(faces[own], [end]) for own, end in zip(around, ends)]
    loops = boundary_loops(body)
    closing = [loop for ring in rings for loop in loops if np.isin(loop, ring).all()]
    if len(loops) != 2 + len(holes) or len(closing) != len(rings):
        raise MeshError(
            "a pole of the closed design, its lowest or highest vertex or the one farthest from its rim, has no ring of faces around it; "
            "repair or refine the mesh"
        )
    sides = [*rims, *closing]
    uv, own = _around_and_along(vertices, body, sides[0], sides[1])
    uv = _turned_as(body, uv, own, np.array([1.0, np.inf]))
    uv[:, 0] = _started_beside(uv[:, 0], own, holes)
    turn = _turn(vertices, body, uv, own)
    gaps = [float(np.linalg.norm(vertices[ring] - vertices[end], axis=1).mean()) for ring, end in zip(rings, ends)]
    top = float(uv[:, 1].max()) + gaps[-1]
    heights = [-gaps[0], top] if len(ends) == 2 else [top]
    u = np.concatenate([uv[:, 0], *(np.arange(BINS) / BINS for _ in ends)])
    v = np.concatenate([uv[:, 1], np.repeat(heights, BINS)])
    every = np.concatenate([own, np.repeat(ends, BINS)])
    return Unwrapped(np.column_stack([u * turn, v]), every, np.array([turn, np.inf]), (len(ends) == 2, True), tuple(holes))


def _scale(vertices: FloatArray, faces: IntArray, flat: Unwrapped) -> float:
    """Return how many times longer lengths are in one part of a map than in another, for nine tenths of the surface."""
    uv = np.zeros((len(vertices), 2))
    uv[flat.vertices] = flat.uv
    one, other = (uv[faces[:, k]] - uv[faces[:, 0]] for k in (1, 2))
    p, q = (vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2))
    area = np.linalg.norm(np.cross(p, q), axis=1)
    scale = np.sqrt(np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / np.maximum(area, 1e-300))
    order = np.argsort(scale)
    share = np.cumsum(area[order]) / area.sum()
    low, high = np.interp([0.05, 0.95], share, scale[order])
    return float(high / max(low, 1e-300))


def _torus(vertices: FloatArray, faces: IntArray) -> Unwrapped:
    """Return two harmonic angles of a ring, across two loops that cross once."""
    loops = _generators(vertices, faces)
    if len(loops) != 2:
        raise MeshError("no two loops cut the design open; give a NURBS surface")
    angles = [_angle(vertices, faces, np.append(loop, loop[0])) for loop in loops]
    area = _area(vertices, faces)
    # A parameter changes by its period across its loop, so it runs along the other one.
    ratio = _length(vertices, loops[1]) / _length(vertices, loops[0])
    period = np.sqrt(area * np.array([ratio, 1.0 / ratio]))
    used = np.unique(faces)
    uv = _turned_as(faces, np.column_stack(angles)[used], used, np.ones(2))
    return Unwrapped(uv * period, used, period, (False, False), ())


def _around_and_along(vertices: FloatArray, faces: IntArray, first: IntArray, last: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the angle around, in turns, and the length along a surface between two rims (k, 2), and its vertices (k,)."""
    used = np.unique(faces)
    stiffness = _stiffness(vertices, faces)
    v = np.zeros(len(vertices))
    v[last] = 1.0
    free = np.setdiff1d(used, np.concatenate([first, last]))
    if len(free):
        v[free] = factorise(stiffness[free][:, free].tocsr(), symmetric=True, points=vertices[free]).solve(-(stiffness[free] @ v))
    path = _path(vertices, faces, first, last)
    u = _angle(vertices, faces, path)
    return np.column_stack([u[used], _along(vertices, faces, v)[used]]), used


def _turn(vertices: FloatArray, faces: IntArray, uv: FloatArray, used: IntArray) -> float:
    """Return the length around a surface, on the average along it, from its area and that of its parameters (k, 2) [L]."""
    every = np.zeros((len(vertices), 2))
    every[used] = uv
    one, other = (every[faces[:, k]] - every[faces[:, 0]] for k in (1, 2))
    one[:, 0], other[:, 0] = (step[:, 0] - np.round(step[:, 0]) for step in (one, other))
    covered = float(np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum())
    if not covered > 0.0:
        raise MeshError(TOO_FEW)
    return 2.0 * _area(vertices, faces) / covered


def _started_beside(u: FloatArray, used: IntArray, holes: list[IntArray]) -> FloatArray:
    """Return angles (k,) in turns from 0 up to 1 that begin where the largest gap between holes and creases is, in its middle."""
    if not holes:
        return u - u.min()
    # The angles at which holes begin and end; a gap follows where no hole covers the turn up to the next beginning.
    spans = []
    for loop in holes:
        along = contiguous(u[np.searchsorted(used, loop)], 1.0)
        spans.append((float(along.min()) % 1.0, float(np.ptp(along))))
    spans.sort()
    starts = np.array([start for start, _ in spans] + [spans[0][0] + 1.0])
    ends = np.maximum.accumulate([start + length for start, length in spans])
    ends = np.maximum(ends, ends[-1] - 1.0)
    gaps = starts[1:] - ends
    widest = int(np.argmax(gaps))
    return np.mod(u - (ends[widest] + 0.5 * max(float(gaps[widest]), 0.0)), 1.0)


def contiguous(values: FloatArray, period: float) -> FloatArray:
    """Return the values (k,) of a parameter that closes, along a loop, without jumps by its period."""
    steps = np.diff(values)
    return values - np.concatenate([[0.0], np.cumsum(period * np.round(steps / period))])


def _turned_as(faces: IntArray, uv: FloatArray, used: IntArray, period: FloatArray) -> FloatArray:
    """Return parameters (k, 2) with the first one reversed where they run around faces the other way."""
    place = np.zeros(int(used.max()) + 1, np.int64)
    place[used] = np.arange(len(used))
    one, other = (uv[place[faces[:, k]]] - uv[place[faces[:, 0]]] for k in (1, 2))
    whole = np.where(np.isfinite(period), period, 1.0)
    one, other = (np.where(np.isfinite(period), step - whole * np.round(step / whole), step) for step in (one, other))
    return uv * [np.sign((one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum()), 1.0]


def _along(vertices: FloatArray, faces: IntArray, v: FloatArray) -> FloatArray:
    """Return a monotone function of v that grows by one per length along the surface, on the average around it [L]."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    double = np.linalg.norm(cross, axis=1)
    normal = cross / np.maximum(double, 1e-300)[:, None]
    corners = ((c - b, 0), (a - c, 1), (b - a, 2))
    slope = sum(v[faces[:, k], None] * np.cross(normal, edge) for edge, k in corners) / np.maximum(double, 1e-300)[:, None]
    steep = np.linalg.norm(slope, axis=1)
    # Faces count in all bins that they reach over, in equal parts.
    low, high = v[faces].min(axis=1), v[faces].max(axis=1)
    levels = np.unique(np.quantile(v[np.unique(faces)], np.linspace(0.0, 1.0, BINS + 1)))
    span = np.maximum(high - low, 1e-300)
    shares = np.clip(np.minimum(high[:, None], levels[1:]) - np.maximum(low[:, None], levels[:-1]), 0.0, None) / span[:, None]
    area, flow = (0.5 * double) @ shares, (0.5 * double * steep) @ shares
    steps = np.diff(levels) * area / np.maximum(flow, 1e-300)
    return np.interp(v, levels, np.concatenate([[0.0], np.cumsum(steps)]))


def _angle(vertices: FloatArray, faces: IntArray, path: IntArray) -> FloatArray:
    """Return the harmonic function (n,) that grows by one around a surface, from one side of a path to the other."""
    n, used = len(vertices), np.unique(faces)
    corner, right = _cut(faces, path, n)
    own = np.zeros(n + len(right), np.int64)
    own[:n], own[n:] = np.arange(n), right
    jump = np.zeros(len(own))
    jump[n:] = 1.0
    points = vertices[own]
    stiffness = _stiffness(points, corner)
    joined = sparse.csr_matrix((np.ones(len(own)), (np.arange(len(own)), own)), shape=(len(own), n))
    matrix = (joined.T @ stiffness @ joined).tocsr()
    right_side = -(joined.T @ (stiffness @ jump))
    free = np.setdiff1d(used, path[:1])
    u = np.zeros(n)
    u[free] = factorise(matrix[free][:, free].tocsr(), symmetric=True, points=vertices[free]).solve(right_side[free])
    return u


def _cut(faces: IntArray, path: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Return faces (m, 3) that use copies of the vertices of a path on its right side, and the vertices that are copied (c,)."""
    half = {(int(a), int(b)): f for f, face in enumerate(faces.tolist()) for a, b in zip(face, face[1:] + face[:1])}
    steps = list(zip(path[:-1].tolist(), path[1:].tolist()))
    barrier = {step for a, b in steps for step in ((a, b), (b, a))}
    copies: dict[int, int] = {}
    cut = faces.copy()
    for a, b in steps:
        for vertex in (a, b):
            # Walk around the vertex through the faces on the right, from this edge of the path to the next one or the rim.
            other = a if vertex == b else b
            start = half.get((b, a))
            if start is None:
                raise MeshError("a path across the design runs along its rim; refine the mesh")
            copy = copies.setdefault(vertex, n + len(copies))
            face, arm = start, other
            while True:
                cut[face][faces[face] == vertex] = copy
                arm = next(int(k) for k in faces[face] if k not in (vertex, arm))
                if (vertex, arm) in barrier:
                    break
                following = half.get((vertex, arm)) if half.get((arm, vertex)) == face else half.get((arm, vertex))
                if following is None or following == start:
                    break
                face = following
    return cut, np.array(list(copies), dtype=np.int64)


def _path(vertices: FloatArray, faces: IntArray, first: IntArray, last: IntArray) -> IntArray:
    """Return the vertices of the shortest path between two rims that touches the rims at its ends only (k,)."""
    edges = edge_faces(faces)
    inner = edges[edges[:, 3] >= 0]
    lengths = np.linalg.norm(vertices[inner[:, 0]] - vertices[inner[:, 1]], axis=1)
    on_rim = np.zeros(len(vertices), bool)
    on_rim[np.concatenate([edges[edges[:, 3] < 0, 0], edges[edges[:, 3] < 0, 1]])] = True
    # Paths through rims are dear.
    dear = lengths + lengths.sum() * on_rim[inner[:, :2]].sum(axis=1)
    graph = sparse.csr_matrix((dear, (inner[:, 0], inner[:, 1])), shape=(len(vertices),) * 2)
    distance, before, _ = dijkstra(graph, directed=False, indices=first, return_predecessors=True, min_only=True)
    at = int(last[np.argmin(distance[last])])
    path = [at]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return np.array(path[::-1])


def _generators(vertices: FloatArray, faces: IntArray) -> list[IntArray]:
    """Return the loops (k,) that cut a closed surface open, by a tree of edges and one of faces across the other edges.

    References
    ----------
    Erickson, Whittlesey, *Greedy optimal homotopy and homology generators*, 2005.
    """
    edges = edge_faces(faces)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    graph = sparse.csr_matrix((lengths, (edges[:, 0], edges[:, 1])), shape=(len(vertices),) * 2)
    root = int(faces[0, 0])
    distance, before = dijkstra(graph, directed=False, indices=root, return_predecessors=True)
    in_tree = (before[edges[:, 0]] == edges[:, 1]) | (before[edges[:, 1]] == edges[:, 0])
    rest = np.flatnonzero(~in_tree)
    # The longest loops go into the tree of faces, so that the short ones are left.
    around = distance[edges[rest, 0]] + distance[edges[rest, 1]] + lengths[rest]
    weights = 1.0 + around.max() - around
    left, right = edges[rest, 2], edges[rest, 3]
    faces_graph = sparse.csr_matrix((weights, (left, right)), shape=(len(faces),) * 2)
    tree = minimum_spanning_tree(faces_graph).tocoo()
    taken = {(min(a, b), max(a, b)) for a, b in zip(tree.row.tolist(), tree.col.tolist())}
    found = []
    for k in rest[np.argsort(around, kind="stable")].tolist():
        pair = (min(edges[k, 2:].tolist()), max(edges[k, 2:].tolist()))
        if pair in taken:
            continue
        one, other = ([int(end)] for end in edges[k, :2])
        for line in (one, other):
            while before[line[-1]] >= 0:
                line.append(int(before[line[-1]]))
        while len(one) > 1 and len(other) > 1 and one[-2] == other[-2]:
            one.pop()
            other.pop()
        found.append(np.array(one[::-1] + other[:-1]))
    return found


def _graph(edges: IntArray, n: int) -> sparse.csr_matrix:
    return sparse.csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n, n))


def _stiffness(vertices: FloatArray, faces: IntArray) -> sparse.csr_matrix:
    """Return the cotangent stiffness with all weights positive, for which harmonic maps are one to one (n, n)."""
    own = -cotangent_laplacian(vertices, faces)
    coupling = -(own - sparse.diags(own.diagonal())).tocsr()
    coupling.data = np.maximum(coupling.data, STIFFEST * np.abs(coupling.data).mean())
    return (sparse.diags(np.asarray(coupling.sum(axis=1)).ravel()) - coupling).tocsr()


def _area(vertices: FloatArray, faces: IntArray) -> float:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def _plane_area(uv: FloatArray, faces: IntArray) -> float:
    a, b, c = (uv[faces[:, k]] for k in range(3))
    (x, y), (p, q) = (b - a).T, (c - a).T
    return 0.5 * float((x * q - y * p).sum())


def _narrowest(uv: FloatArray, used: IntArray) -> FloatArray:
    """Return points turned so that the rectangle around those used is the smallest; one of its sides lies along their hull."""
    along, areas = rectangles(uv[used])
    # Of equal ones the first.
    x, y = along[np.argmax(areas <= (1.0 + 1e-9) * areas.min())]
    return uv @ np.array([[x, -y], [y, x]])
