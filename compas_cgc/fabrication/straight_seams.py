"""Straight seams of flat regions from boundary to boundary, cut through faces instead of along edges."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..meshing import lost_edges
from ..meshing import path_edges
from ..meshing.creases import crease_paths
from ..meshing.level_cuts import SNAP
from ..meshing.level_cuts import CutMesh
from ..meshing.level_cuts import uncut
from ..meshing.split_sides import split_sides
from ..meshing.split_sides import weighted
from .plane_layout import unfold

__all__ = ["straightened"]

RINGS = 4  # rings of faces beside a seam in which its straight line is sought
GAP_TOLERANCE = 1e-6  # gap relative to the length of a seam up to which these faces are developable


class _Line(NamedTuple):
    """A straight line between two vertices in the unfolded plane of some faces."""

    faces: IntArray  # (f,) indices of the faces
    along: FloatArray  # (f, 3) position of corners along the line, 0 to 1
    off: FloatArray  # (f, 3) distance of corners to its left, relative to its length


def straightened(vertices: Vertices, faces: Faces, seams: Edges) -> tuple[CutMesh, Edges]:
    """Return a mesh cut along straight lines that replace seams (s, 2) between boundaries, and the new seams.

    Seams that end inside the mesh, or whose straight line leaves it, are kept.
    """
    mesh, paths = uncut(vertices, faces), crease_paths(seams.tolist())
    rim = boundary_vertices(vertices, faces)
    for k, path in enumerate(paths):
        others = np.array(path_edges(paths[:k] + paths[k + 1 :]), dtype=np.int64).reshape(-1, 2)
        if len(path) > 2 and path[0] != path[-1] and rim[path[0]] and rim[path[-1]]:
            mesh, paths[k] = _straight(mesh, path, others)
    return mesh, np.array(path_edges(paths), dtype=np.int64).reshape(-1, 2)


def _straight(mesh: CutMesh, path: list[int], others: Edges) -> tuple[CutMesh, list[int]]:
    beside = np.isin(mesh.faces, path).any(axis=1)
    for _ in range(RINGS):
        line = _line(mesh, np.flatnonzero(beside), path[0], path[-1])
        if line is None:
            break
        found = _cut(mesh, line, path[0], path[-1])
        if found is not None:
            return (mesh, path) if len(others) and lost_edges(found[0].faces, others).any() else found
        beside = np.isin(mesh.faces, mesh.faces[beside]).any(axis=1)
    return mesh, path


def _line(mesh: CutMesh, chosen: IntArray, first: int, last: int) -> Optional[_Line]:
    """Return the line between two vertices in the unfolded faces, None if these are not developable."""
    laid = unfold(mesh.vertices, mesh.faces[chosen])
    ends = [np.flatnonzero(laid.origin == vertex) for vertex in (first, last)]
    if any(len(end) != 1 for end in ends):
        return None
    start, end = (laid.plane[own[0]] for own in ends)
    length = float(np.linalg.norm(end - start))
    if laid.gap > GAP_TOLERANCE * length:
        return None
    ahead = (end - start) / length**2
    away = laid.plane[laid.faces] - start
    return _Line(chosen, away @ ahead, away @ np.array([-ahead[1], ahead[0]]))


def _cut(mesh: CutMesh, line: _Line, first: int, last: int) -> Optional[tuple[CutMesh, list[int]]]:
    """Return the mesh cut along a line, and the vertices on it; None if the line leaves the faces."""
    off, along = np.zeros(mesh.faces.shape), np.full(mesh.faces.shape, -1.0)
    off[line.faces], along[line.faces] = line.off, line.along
    corners = mesh.faces[line.faces]
    reach = SNAP * float(np.median(np.hypot(line.off - np.roll(line.off, 1, axis=1), line.along - np.roll(line.along, 1, axis=1))))
    on = np.isin(corners, (first, last)) | ((np.abs(line.off) < reach) & (line.along > 0.0) & (line.along < 1.0))
    passed = {int(v): float(at) for v, at in zip(corners[on], line.along[on])}
    off[np.isin(mesh.faces, list(passed))] = 0.0
    end = np.roll(off, -1, axis=1)
    crossing = off * end < 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        place = along + off / (off - end) * (np.roll(along, -1, axis=1) - along)
    crossing &= (place > 0.0) & (place < 1.0)
    n = len(mesh.vertices)
    if crossing.any():
        split = split_sides(mesh.faces, crossing, off, end, n)
        sides = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2)[crossing], axis=1) @ [n, 1]
        order = np.argsort(sides, kind="stable")
        at = place[crossing][order][np.searchsorted(sides[order], split.ends @ [n, 1])]
        passed.update(zip(range(n, n + len(at)), at.tolist()))
        ends, share = mesh.vertices[split.ends], split.share[:, None]
        fresh = (1.0 - share) * ends[:, 0] + share * ends[:, 1]
        weights = weighted(split.weights, mesh.weights[split.parent])
        mesh = CutMesh(np.vstack([mesh.vertices, fresh]), split.faces, mesh.parent[split.parent], weights)
    path = sorted(passed, key=lambda vertex: passed[vertex])
    lost = lost_edges(mesh.faces, np.array(path_edges([path]), dtype=np.int64).reshape(-1, 2))
    return None if lost.any() or (path[0], path[-1]) != (first, last) else (mesh, path)
