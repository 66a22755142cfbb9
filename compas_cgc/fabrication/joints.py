"""Joints: cuts of regions into panels, through faces, along a grid or along curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..errors import MeshError
from ..meshing import path_edges
from ..meshing.level_cuts import SNAP
from ..meshing.level_cuts import CutMesh
from ..meshing.level_cuts import cut_along_levels
from ..meshing.level_cuts import uncut
from ..meshing.map_matching import edge_net
from ..meshing.split import split_along
from ..meshing.split import split_path
from ..meshing.trace import follow_edges
from ..meshing.trace import trace_curve
from ..model.problem import CGCProblem
from .grids import curvature_coordinates
from .grids import plan_coordinates
from .grids import square_coordinates
from .patchwork import weights_in

__all__ = ["Joints", "curve_joints", "grid_joints"]

MAX_SHIFT = 0.15  # largest shift of a grid line onto mesh edges, relative to the width of a face
FOLLOW_RATIO = 0.1  # remaining cut into faces, relative to the unshifted line, up to which it counts as following edges
SHIFT_TOLERANCE = 1e-6  # relative tolerance of the shift


class Joints(NamedTuple):
    """A mesh cut along joints."""

    mesh: CutMesh
    cell: IntArray  # (m',) grid cell of every face within its region
    edges: Edges  # (e, 2) further edges along joints
    share: FloatArray  # (r,) area of a grid cell by region, 0 without a grid [L^2]


def grid_joints(
    problem: CGCProblem, region: IntArray, areas: FloatArray, size: Optional[float], count: Optional[int], along: str
) -> Joints:
    """Cut every region along a grid, with a whole number of cells of about `size` [L], or about `count` cells."""
    regions = int(region.max(initial=-1)) + 1
    values = np.zeros((len(region), 3, 2))
    levels: list[list[FloatArray]] = [[], []]
    share = np.zeros(regions)
    for number in range(regions):
        own = np.flatnonzero(region == number)
        used, corners = np.unique(problem.faces[own], return_inverse=True)
        F = corners.reshape(-1, 3)
        at = _coordinates(problem.vertices[used], F, along)
        cells = _cells(at, len(own), size, count)
        values[own] = at[F]
        share[number] = areas[own].sum() / math.prod(cells)
        for axis in (0, 1):
            low, extent = float(at[:, axis].min()), float(np.ptp(at[:, axis]))
            lines = low + extent * np.arange(1, cells[axis]) / cells[axis]
            levels[axis].append(np.unique([_shifted(line, at[F][:, :, axis]) for line in lines.tolist()]))
    mesh, values = cut_along_levels(problem.vertices, problem.faces, region, values, levels)
    middle, part = values.mean(axis=1), region[mesh.parent]
    cell = np.zeros(len(part), np.int64)
    for number in range(regions):
        own = part == number
        first, second = (np.searchsorted(levels[axis][number], middle[own, axis]) for axis in (0, 1))
        cell[own] = first * (len(levels[1][number]) + 1) + second
    return Joints(mesh, cell, np.empty((0, 2), np.int64), share)


def _coordinates(vertices: Vertices, faces: Faces, along: str) -> FloatArray:
    if along == "curvature":
        return curvature_coordinates(vertices, faces)
    square = square_coordinates(vertices, faces)
    return plan_coordinates(vertices, faces) if square is None else square


def _cells(at: FloatArray, faces: int, size: Optional[float], count: Optional[int]) -> list[int]:
    """Return the numbers of cells of a region in both directions."""
    extent = np.maximum(np.ptp(at, axis=0), np.finfo(float).tiny)
    if size is not None:
        numbers = [max(1, round(min(wide / size, 1e9))) for wide in extent.tolist()]
    else:
        first = max(1, round(math.sqrt((count or 1) * extent[0] / extent[1])))
        numbers = [first, max(1, round((count or 1) / first))]
    if math.prod(numbers) > faces:
        raise CGCError(f"a region of {faces} triangles cannot be divided into {count or math.prod(numbers)} panels; use larger panels")
    return numbers


def _shifted(line: float, at: FloatArray) -> float:
    """Return a nearby position at which a grid line follows edges, given corner coordinates (m, 3); else the line itself."""
    low, high = at.min(axis=1), at.max(axis=1)
    reach = MAX_SHIFT * float(np.median(high - low))
    near = (low <= line + 2 * reach) & (high >= line - 2 * reach)
    if not near.any():
        return line
    tries = np.unique(np.append(at[near][np.abs(at[near] - line) <= reach * (1 + SHIFT_TOLERANCE)], line))
    low, high = low[near], high[near]
    cut = [np.maximum(np.minimum(high - one, one - low), 0.0).sum() + 1e-3 * abs(one - line) for one in tries.tolist()]
    best = int(np.argmin(cut))
    return float(tries[best]) if cut[best] < FOLLOW_RATIO * cut[int(np.searchsorted(tries, line))] else line


def curve_joints(problem: CGCProblem, curves: Sequence[ArrayLike]) -> Joints:
    """Cut along curves of points (k, 3) [L] and paths of vertex indices."""
    mesh, paths = uncut(problem.vertices, problem.faces), []
    tolerance = problem.drawing.tolerance or 1e-6 * float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    for number, curve in enumerate(curves):
        points = np.asarray(curve)
        if points.ndim == 1 and points.dtype.kind in "iu":
            inserted: dict[tuple[int, int], list[int]] = {}
            paths.append(points.tolist())
            continue
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
            raise CGCError(f"curve {number} must be a path of vertices or points (k, 3), not an array of shape {points.shape}")
        mesh, found, inserted = _cut_along(problem, mesh, points.astype(np.float64), tolerance)
        if not found:
            raise CGCError(f"curve {number} is not near any edge of the mesh; draw it on the mesh")
        paths = [split_path(path, inserted) for path in paths] + found
    edges = np.array(path_edges(paths), dtype=np.int64).reshape(-1, 2)
    return Joints(mesh, np.zeros(len(mesh.faces), np.int64), edges, np.zeros(int(problem.regions().max(initial=-1)) + 1))


def _cut_along(
    problem: CGCProblem, mesh: CutMesh, curve: FloatArray, tolerance: float
) -> tuple[CutMesh, list[list[int]], dict[tuple[int, int], list[int]]]:
    """Return a mesh cut along a curve, the paths of vertices along the curve, and the new vertices by edge.

    A curve that crosses itself within a face is approximated by mesh edges.
    """
    net = edge_net(mesh.vertices, mesh.faces)
    exact = follow_edges(net, curve, tolerance)
    if exact is not None:
        return mesh, [exact], {}
    try:
        split = split_along(mesh.vertices, mesh.faces, curve, tolerance, np.ones(len(mesh.vertices), bool), SNAP)
    except MeshError:
        split = None
    if split is None:
        return mesh, trace_curve(net, curve, tolerance).paths, {}
    parent = mesh.parent[split.parent]
    whole = np.repeat(problem.vertices[problem.faces[parent]], 3, axis=0)
    weights = weights_in(whole, split.vertices[split.faces].reshape(-1, 3)).reshape(-1, 3, 3)
    return CutMesh(split.vertices, split.faces, parent, weights), split.paths, split.inserted
