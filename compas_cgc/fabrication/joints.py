"""Joints: cuts of regions into panels, through faces, along a grid or along curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..errors import MeshError
from ..meshing import path_edges
from ..meshing.cleanup import mean_edge
from ..meshing.closest_on_mesh import nearest_on_mesh
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
from .grid_lines import GridLines
from .patchwork import weights_in

__all__ = ["Joints", "curve_joints", "grid_joints"]


class Joints(NamedTuple):
    """A mesh cut along joints."""

    mesh: CutMesh
    cell: IntArray  # (m',) grid cell of every face within its region
    edges: Edges  # (e, 2) further edges along joints
    share: FloatArray  # (r,) area of a grid cell by region, 0 without a grid [L^2]


def grid_joints(problem: CGCProblem, region: IntArray, areas: FloatArray, grid: GridLines) -> Joints:
    """Cut every region along the lines of a grid."""
    levels = grid.levels
    mesh, values = cut_along_levels(problem.vertices, problem.faces, region, grid.values, levels)
    middle, part = values.mean(axis=1), region[mesh.parent]
    cell = np.zeros(len(part), np.int64)
    for number in range(len(levels[0])):
        own = part == number
        first, second = (np.searchsorted(levels[axis][number], middle[own, axis]) for axis in (0, 1))
        cell[own] = first * (len(levels[1][number]) + 1) + second
    return Joints(mesh, cell, np.empty((0, 2), np.int64), np.bincount(region, areas, len(levels[0])) / grid.cells)


def curve_joints(problem: CGCProblem, curves: Sequence[ArrayLike]) -> Joints:
    """Cut along curves of points (k, 3) [L] and paths of vertex indices; curves shorter than an edge cut off nothing."""
    mesh, paths = uncut(problem.vertices, problem.faces), []
    edge = mean_edge(problem.vertices, problem.faces)
    tolerance = problem.drawing.tolerance or 1e-6 * float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    for number, curve in enumerate(curves):
        points = np.asarray(curve)
        if points.ndim == 1 and points.dtype.kind in "iu":
            inserted: dict[tuple[int, int], list[int]] = {}
            paths.append(points.tolist())
            continue
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
            raise CGCError(f"curve {number} must be a path of vertices or points (k, 3), not an array of shape {points.shape}")
        if _cuts_off_nothing(problem, points, edge):
            continue
        mesh, found, inserted = _cut_along(problem, mesh, points.astype(np.float64), tolerance)
        if not found:
            raise CGCError(f"curve {number} is not near any edge of the mesh; draw it on the mesh")
        paths = [split_path(path, inserted) for path in paths] + found
    edges = np.array(path_edges(paths), dtype=np.int64).reshape(-1, 2)
    return Joints(mesh, np.zeros(len(mesh.faces), np.int64), edges, np.zeros(int(problem.regions().max(initial=-1)) + 1))


def _cuts_off_nothing(problem: CGCProblem, curve: FloatArray, edge: float) -> bool:
    """Return whether a curve on the mesh is shorter than an edge, as curves of nets at corners may be."""
    if float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()) >= edge:
        return False
    return bool((np.linalg.norm(nearest_on_mesh(curve, problem.vertices, problem.faces)[0] - curve, axis=1) < edge).all())


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
