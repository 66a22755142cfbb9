"""A problem posed by mid-edge normals: directions of the moves, laws of the equations, and what is kept of the drawing."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Optional

import numpy as np

from ...discrete import face_areas
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.mid_edge import MidEdgeMesh
from ...discrete.smoothed_normals import smooth_normals
from ...model.laws import ConstantCurvature
from ...model.laws import Law
from ...model.laws import Piecewise
from ...model.problem import CGCProblem
from ...model.roles import FIXED
from ...model.visible import on_held_edges
from .conditions import Conditions
from .lagrangian import Lagrangian

__all__ = ["move_directions", "pair_laws", "pair_rates", "pair_targets", "posed", "takes_goals"]

# cosine between face normals and the mean normal above which a drawing has a plan; steeper than 72° vertical moves stretch faces
FACING = 0.3
SMOOTHINGS = 10  # averages of the normals of a drawing without a plan; over ten edges, so that moves of neighbours are nearly parallel


def posed(problem: CGCProblem, fold_length: float, directions: Optional[FloatArray] = None) -> Lagrangian:
    """Return energy and equations of a problem without dummies in its local frame.

    Parameters
    ----------
    problem
        Vertices, faces, roles, creases and targets.
    fold_length
        Width of a strip that bends as easily as a crease folds, relative to the square root of the area.
    directions
        ``(n, 3)`` unit vectors along which vertices move. Default: those of :func:`move_directions`.
    """
    V, F, regions = problem.vertices, problem.faces, problem.regions()
    directions = move_directions(problem) if directions is None else directions
    mesh = MidEdgeMesh(F, problem.creases, regions, directions)
    size = math.sqrt(float(face_areas(V, F).sum()))
    rows, law = pair_laws(problem, mesh)
    return Lagrangian(mesh, V, problem.movable, rows, law.normalised(), fold_length * size, Conditions(problem, directions))


def takes_goals(problem: CGCProblem) -> bool:
    """Return whether moves along fixed directions can meet the goals of a problem, whose K is given."""
    local = problem.without_dummies().local()[0]
    return Conditions(local, move_directions(local)).can_be_met


def move_directions(problem: CGCProblem) -> FloatArray:
    """Return the unit vectors (n, 3) along which vertices move: the mean normal over a plan, or the vertical that goals refer to.

    Without a plan they are smoothed normals.
    """
    V, F = problem.vertices, problem.faces
    crosses = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    mean = crosses.sum(axis=0)
    upright = any(not goal.admits(0.0) for goal in problem.goals)
    axis = np.sign(mean) * [0.0, 0.0, 1.0] if upright else mean
    length = float(np.linalg.norm(axis))
    # Supports that were lifted off a plan leave cliffs around them.
    between = (problem.roles != FIXED)[F].all(axis=1)
    if length > 0.0 and (crosses @ axis > FACING * between * length * np.linalg.norm(crosses, axis=1)).all():
        return np.tile(axis / length, (len(V), 1))
    return smooth_normals(V, F, SMOOTHINGS)


def pair_targets(problem: CGCProblem, mesh: MidEdgeMesh) -> FloatArray:
    """Return K̄ of every pair of vertex and region (p,) [1/L^2], NaN where no equation holds.

    Vertices where K is prescribed have their own target, others the mean of those of the region around them. Along held edges no
    equation holds: a straight one has no curvature of its own, so that K > 0 is not bounded there.
    """
    vertex, region = mesh.pairs.T
    known = problem.asked & np.isfinite(problem.targets)
    own = np.where(known, problem.targets, 0.0)[problem.faces].sum(axis=1)
    count = known[problem.faces].sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        around = (mesh.incidence @ own) / (mesh.incidence @ count)
        of_regions = np.bincount(problem.regions(), own) / np.bincount(problem.regions(), count)
    targets = np.where(known[vertex], problem.targets[vertex], np.where(np.isfinite(around), around, of_regions[region]))
    return np.where(on_held_edges(problem)[vertex], np.nan, targets)


def pair_laws(problem: CGCProblem, mesh: MidEdgeMesh) -> tuple[IntArray, Piecewise]:
    """Return the pairs of vertex and region where an equation holds (r,), and the laws of these.

    Along held edges no equation holds, whatever the law.
    """
    targets = pair_targets(problem, mesh)
    of, held = np.where(np.isfinite(targets), 0, -1), on_held_edges(problem)
    others = list(dict.fromkeys(problem.laws.values()))
    for region, law in problem.laws.items():
        of[(mesh.pairs[:, 1] == region) & ~held[mesh.pairs[:, 0]]] = 1 + others.index(law)
    rows = np.flatnonzero(of >= 0)
    laws: list[Law] = [ConstantCurvature(targets[of == 0]), *others]
    used, index = np.unique(of[rows], return_inverse=True)
    return rows, Piecewise([laws[number] for number in used] or laws[:1], index.ravel())


def pair_rates(problem: CGCProblem, mesh: MidEdgeMesh, rows: IntArray, region: int) -> FloatArray:
    """Return the derivatives (r,) of the constants of equations at pairs (r,) by the constant of a region, all in the same units."""
    of_law = mesh.pairs[rows, 1] == region
    if region in problem.laws:
        return of_law.astype(np.float64)
    rate = np.where(np.isfinite(problem.targets), 0.0, np.nan)
    rate[problem.region_vertices(region) & problem.asked] = 1.0
    rates = np.nan_to_num(pair_targets(replace(problem, targets=rate), mesh)[rows])
    return np.where(np.isin(mesh.pairs[rows, 1], list(problem.laws)), 0.0, rates)
