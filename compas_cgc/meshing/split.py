"""Cutting of meshes along curves."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from .curve_intersections import Crossings
from .curve_intersections import curve_crossings
from .optimal_triangulation import best_triangles
from .point_location import closest_in_triangles
from .polyline import nearest_on_polyline
from .polyline import point_at

__all__ = ["Split", "split_along", "split_path"]

SNAP_DISTANCE = 0.2  # in edge lengths; crossings nearer to a vertex are moved to it


class Split(NamedTuple):
    """A mesh cut along a curve."""

    vertices: FloatArray  # (n + k, 3) [L], old ones first, some of them moved onto the curve
    faces: IntArray  # (m', 3)
    parent: IntArray  # (m',) old face that contains each face
    paths: list[list[int]]  # the curve as vertex paths along edges
    inserted: dict[tuple[int, int], list[int]]  # from old edges (u < v) to their new vertices from u to v


def split_along(
    vertices: FloatArray, faces: IntArray, curve: FloatArray, tolerance: float, keep: Mask, snap: float = SNAP_DISTANCE
) -> Optional[Split]:
    """Return a mesh cut along a curve, so that the curve follows edges.

    A vertex near a crossing moves onto the curve, which avoids slivers; an end of the curve
    inside a face is moved to the nearest corner.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    curve
        ``(k, 3)`` points along the curve [L], first and last equal if it is closed.
    tolerance
        Distance below which two points coincide [L].
    keep
        ``(n,)`` bool: fixed vertices.
    snap
        In edge lengths; crossings nearer to a vertex are moved to it.

    Returns
    -------
    Split or None
        None if the curve is far off the mesh or crosses itself inside a face.
    """
    edges = edge_faces(faces)
    crossings = curve_crossings(vertices, faces, edges, curve, snap)
    runs = _runs(vertices, faces, edges, crossings, curve, tolerance)
    if not runs:
        return None
    # One new vertex per crossing off vertices, in order along each edge.
    name = crossings.vertex.copy()
    fresh = np.flatnonzero(name < 0)
    name[fresh] = len(vertices) + np.arange(len(fresh))
    inserted: dict[tuple[int, int], list[int]] = {}
    for i in fresh[np.lexsort((crossings.t[fresh], crossings.edge[fresh]))].tolist():
        a, b = edges[crossings.edge[i], :2].tolist()
        inserted.setdefault((a, b), []).append(int(name[i]))
    old = np.concatenate([vertices, crossings.point[fresh]])
    paths = [[int(name[k]) if k >= 0 else -k - 1 for k in run] for run in runs]
    normals = face_normals(vertices, faces)
    points = _moved(old, np.unique(crossings.vertex[crossings.vertex >= 0]), curve, keep)
    cut = _cut_faces(points, faces, inserted, paths)
    if cut is not None and not (np.einsum("ij,ij->i", face_normals(points, cut[0]), normals[cut[1]]) > 0).all():
        # If moving vertices would invert a face, none is moved.
        points, cut = old, _cut_faces(old, faces, inserted, paths)
    if cut is None:
        return None
    inserted = {(min(a, b), max(a, b)): new if a < b else new[::-1] for (a, b), new in inserted.items()}
    return Split(points, cut[0], cut[1], paths, inserted)


def _moved(points: FloatArray, corners: IntArray, curve: FloatArray, keep: Mask) -> FloatArray:
    """Return the points with movable corners moved onto the curve."""
    corners = corners[~keep[corners]]
    moved = points.copy()
    if len(corners):
        _, position = nearest_on_polyline(points[corners], curve)
        moved[corners] = point_at(curve, position)
    return moved


def split_path(path: list[int], inserted: dict[tuple[int, int], list[int]]) -> list[int]:
    """Return a vertex path with the new vertices on its edges inserted."""
    result = path[:1]
    for u, v in zip(path[:-1], path[1:]):
        new = inserted.get((min(u, v), max(u, v)), [])
        result += (new if u < v else new[::-1]) + [v]
    return result


def _runs(
    V: FloatArray, F: IntArray, edges: IntArray, crossings: Crossings, curve: FloatArray, tolerance: float
) -> Optional[list[list[int]]]:
    """Return runs of crossings that follow each other in faces; -1 - v stands for the end vertex v."""
    count = len(crossings.edge)
    if not count:
        return None
    fans: dict[int, set[int]] = {}
    for f, corners in enumerate(F.tolist()):
        for v in corners:
            fans.setdefault(v, set()).add(f)
    around = [
        fans[v] if v >= 0 else {f for f in edges[e, 2:].tolist() if f >= 0}
        for v, e in zip(crossings.vertex.tolist(), crossings.edge.tolist())
    ]
    rim = set(edges[edges[:, 3] < 0, :2].ravel().tolist())
    outer = [v in rim if v >= 0 else edges[e, 3] < 0 for v, e in zip(crossings.vertex.tolist(), crossings.edge.tolist())]
    runs = [[0]]
    for i in range(1, count):
        if around[i] & around[i - 1]:
            runs[-1].append(i)
        elif outer[i] and outer[i - 1]:
            runs.append([i])
        else:
            return None
    closed = np.linalg.norm(curve[0] - curve[-1]) <= tolerance
    if closed and around[0] & around[count - 1]:
        if len(runs) == 1:
            runs[0].append(0)
        else:
            runs[0] = runs.pop() + runs[0]
    elif not closed:
        for end, first in ((curve[0], True), (curve[-1], False)):
            i = 0 if first else count - 1
            corner = _end_corner(V, F, sorted(around[i]), end, crossings.point[i], tolerance)
            if corner is not None and corner != crossings.vertex[i]:
                runs[0 if first else -1].insert(0 if first else len(runs[-1]), -1 - corner)
    return [run for run in runs if len(run) > 1] or None


def _end_corner(V: FloatArray, F: IntArray, around: list[int], end: FloatArray, last: FloatArray, tolerance: float) -> Optional[int]:
    """Return the corner to which the end of a curve inside a face is moved, if it is nearer than the last crossing."""
    away = float(np.linalg.norm(end - last))
    if away <= tolerance:
        return None
    P = V[F[around]]
    distance = np.linalg.norm(closest_in_triangles(end, P) - end, axis=1)
    face = int(np.argmin(distance))
    if distance[face] > 0.25 * np.linalg.norm(P[face] - np.roll(P[face], 1, axis=0), axis=1).max():
        return None
    to_corner = np.linalg.norm(P[face] - end, axis=1)
    best = int(np.argmin(to_corner))
    return int(F[around[face], best]) if to_corner[best] < away else None


def _cut_faces(
    points: FloatArray, faces: IntArray, inserted: dict[tuple[int, int], list[int]], paths: list[list[int]]
) -> Optional[tuple[IntArray, IntArray]]:
    """Return the faces cut along paths, and the old face of each."""
    on_edge = {**inserted, **{(b, a): new[::-1] for (a, b), new in inserted.items()}}
    polygons = {}
    at: dict[int, set[int]] = {}
    on_path = {v for path in paths for v in path}
    for f, corners in enumerate(faces.tolist()):
        ring: list[int] = []
        for a, b in zip(corners, corners[1:] + corners[:1]):
            ring += [a, *on_edge.get((a, b), [])]
        if len(ring) > 3 or len(on_path.intersection(ring)) > 1:
            polygons[f] = [ring]
            for v in ring:
                at.setdefault(v, set()).add(f)
    for path in paths:
        for u, v in zip(path[:-1], path[1:]):
            if not any(_chord(polygons[f], u, v) for f in sorted(at.get(u, set()) & at.get(v, set()))):
                return None
    result, parent = [], []
    for f, corners in enumerate(faces.tolist()):
        triangles = [corners] if f not in polygons else [t for ring in polygons[f] for t in best_triangles(points, ring)]
        result += triangles
        parent += [f] * len(triangles)
    return np.array(result, dtype=np.int64), np.array(parent, dtype=np.int64)


def _chord(rings: list[list[int]], u: int, v: int) -> bool:
    """Split a ring by the chord u-v unless it is an edge; return whether a ring has both vertices."""
    for k, ring in enumerate(rings):
        if u in ring and v in ring:
            i, j = sorted((ring.index(u), ring.index(v)))
            if j - i > 1 and (i, j) != (0, len(ring) - 1):
                rings[k : k + 1] = [ring[i : j + 1], ring[j:] + ring[: i + 1]]
            return True
    return False
