"""Panels as parts of the fitted surfaces of their regions, with shared edges."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import MeshError
from ...model.problem import CGCProblem
from ..panelling import Panel
from .edges import RegionEdge
from .edges import region_edges
from .fit import Fit
from .fit import samples

__all__ = ["panel_pieces"]

JOINT_SPACING = 0.5  # least distance of the points of a smooth joint, in mesh edges
DENSITY = 64  # points on the curve of a region's edge per given point, among which the nearest one is sought


def panel_pieces(problem: CGCProblem, fit: Fit, panels: list[Panel]) -> Fit:
    """Return the fit of the regions divided into panels: their surfaces, and the edges and curves between them.

    Raises
    ------
    MeshError
        If the panels do not cover the surface.
    """
    cut = panels[0].cut
    vertices, faces = (problem.vertices, problem.faces) if cut is None else (cut.vertices, cut.faces)
    owner = np.full(len(faces), -1)
    for number, panel in enumerate(panels):
        owner[panel.faces] = number
    if (owner < 0).any():
        raise MeshError("panels in place are not written, because they do not cover the whole surface; use panels of all regions")
    region = np.array([panel.region for panel in panels])
    points = (vertices - fit.centre) / fit.scale
    # A closed rim has two edges; no edge of a panel passes their ends.
    edges = region_edges(points, faces, owner, [end for edge in fit.edges for end in edge.path[[0, -1]].tolist()])
    lines = [_dense(curve) for curve in fit.curves]
    beside = [_region_edge(edge, region, points, fit, lines) for edge in edges]
    # Vertices of cut faces lie on chords of creases and rims, not on their curves.
    for edge, k in zip(edges, beside):
        if k >= 0:
            points[edge.path] = lines[k][cKDTree(lines[k]).query(points[edge.path])[1]]
    curves = []
    spacing = 0.0 if cut is None else JOINT_SPACING * _mean_edge(problem) / fit.scale
    for edge, k in zip(edges, beside):
        piece = fit.pieces[region[edge.regions[0]]] if k < 0 else fit.pieces[fit.edges[k].regions[0]]
        line = samples(_spaced(points[edge.path], spacing)) if k < 0 else _between(lines[k], points[edge.path])
        curves.append(piece.lifted(piece.local(line)[:, :2]))
    return fit._replace(pieces=[fit.pieces[number] for number in region], edges=edges, curves=curves)


def _mean_edge(problem: CGCProblem) -> float:
    """Return the mean length of the sides of the mesh faces [L]."""
    corners = problem.vertices[problem.faces]
    return float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).mean())


def _spaced(points: FloatArray, spacing: float) -> FloatArray:
    """Return points (k, 3) of a joint without those nearer than a spacing to the one before or to the last.

    Joints cross mesh edges at any distances, and their ends move to the curves of rims and creases: points that are close together would
    give a smooth curve sharp bends.
    """
    kept = [0]
    for k in range(1, len(points) - 1):
        if min(np.linalg.norm(points[k] - points[kept[-1]]), np.linalg.norm(points[-1] - points[k])) >= spacing:
            kept.append(k)
    return points[[*kept, len(points) - 1]]


def _dense(curve: FloatArray) -> FloatArray:
    """Return many points on the smooth curve through points (k, 3)."""
    return CubicSpline(np.arange(len(curve)), curve)(np.linspace(0.0, len(curve) - 1.0, DENSITY * (len(curve) - 1) + 1))


def _region_edge(edge: RegionEdge, region: IntArray, points: FloatArray, fit: Fit, lines: list[FloatArray]) -> int:
    """Return the edge of a region on which an edge of a panel lies, -1 if it lies inside a region."""
    beside = tuple(sorted(region[list(edge.regions)].tolist()))
    if len(beside) == 2 and beside[0] == beside[1]:
        return -1
    own = [k for k, other in enumerate(fit.edges) if other.regions == beside]
    if not own:
        raise MeshError("panels in place are not written, because their regions differ from those of the surface; divide it again")
    return min(own, key=lambda k: float(cKDTree(lines[k]).query(points[edge.path])[0].max()))


def _between(line: FloatArray, path: FloatArray) -> FloatArray:
    """Return points on a dense line (n, 3) between the first and the last of some points (k, 3) on it."""
    first, last = cKDTree(line).query(path[[0, -1]])[1].tolist()
    count = 4 * (len(path) - 1) + 1
    return line[np.round(np.linspace(first, last, max(count, 4))).astype(int)]
