"""Closing: slide the vertices of a solved surface until its triangles close on the moulds, where edge forces balance."""

from __future__ import annotations

from dataclasses import replace
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete import boundary_vertices
from ..discrete import vertex_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..discrete.laplacian import cotangent_laplacian
from ..discrete.space_form import SpaceFormEquations
from ..discrete.space_form import sliding_ease
from ..linalg import SingularMatrixError
from ..linalg import factorise
from ..meshing.even_triangles import even_triangles
from ..model.problem import CGCProblem

__all__ = ["closed", "closed_anew", "closed_with_edges", "unrollable"]

STEPS, HALVINGS = 30, 6
REMESHING_ROUNDS = 4  # rounds with new triangles
CLOSING_TOLERANCE = 1e-12  # norm of the deviations of vertex angle sums from 2 pi [rad]
ROUNDING_FACTOR = 1e3  # factor on the tolerance that rounding requires on large meshes
SMOOTH = 0.1  # length relative to the size: shorter waves of a move are avoided
MAX_MOVE = 0.01  # smooth move to triangles that close, relative to the size, above which the surface was not solved for its targets
MAX_STEP = 0.5  # largest step of a vertex relative to the mean edge length


def closed(problem: CGCProblem) -> Optional[CGCProblem]:
    """Return the surface with its vertices slid until triangles close around each with a target, None if this fails.

    The metric favours displacements along the surface, so that its shape hardly changes; boundaries, creases and supports are
    fixed. This is the last step of a solve with the measure ``exact``, for surfaces solved with another measure.
    """
    slid, arrived = _slid(problem)
    return slid if arrived else None


def closed_anew(problem: CGCProblem) -> Optional[CGCProblem]:
    """Return the result of :func:`closed` on a remeshed surface with even triangles, None if it fails.

    Vertices cannot slide far on slender triangles. The new triangles lie on the surface to second order only, so remeshing is
    repeated while closing fails.
    """
    free = np.flatnonzero(problem.asked & ~boundary_vertices(problem.vertices, problem.faces))
    for _ in range(REMESHING_ROUNDS):
        vertices, faces = even_triangles(problem.vertices, problem.faces, free, problem.creases)
        problem, arrived = _slid(replace(problem, vertices=vertices, faces=faces))
        if arrived:
            return problem
    return None


def unrollable(problem: CGCProblem) -> CGCProblem:
    """Return the nearest surface on which triangles close around every vertex with target K = 0.

    Without the measure ``exact`` a solve meets K = 0 to second order in the edge length, and the surface moves by as much. It moves
    smoothly, by least second differences. Where it would move far, or where there is no such surface, it is returned as it is.
    """
    moved = _smoothly_moved(problem, problem.asked & (problem.targets == 0.0))
    return problem if moved is None else moved


def closed_with_edges(problem: CGCProblem) -> Optional[CGCProblem]:
    """Return the nearest surface whose triangles close, with free edges and creases moved too, None if there is none nearby.

    The surface moves smoothly, by least second differences. On regular meshes along asymptotic curves :func:`closed` fails: with fixed
    edges, moves of neighbouring vertices in opposite directions hardly change the angles around them.
    """
    return _smoothly_moved(problem, problem.asked & np.isfinite(problem.targets))


def _smoothly_moved(problem: CGCProblem, wanted: Mask) -> Optional[CGCProblem]:
    """Return the nearest surface on which triangles close around the vertices wanted (n,), None if that is far or not reached."""
    used = np.bincount(problem.faces.ravel(), minlength=len(problem.vertices)) > 0
    inner = wanted & used & ~boundary_vertices(problem.vertices, problem.faces)
    rows, columns = np.flatnonzero(inner), np.flatnonzero(problem.movable & used)
    equations = SpaceFormEquations(problem.faces, np.where(inner, problem.targets, 0.0), rows, columns)
    if not len(rows) or equations.too_large(problem.vertices) is not None:
        return None
    here, rest = problem.vertices, equations.residual(problem.vertices)
    size = float(np.linalg.norm(np.ptp(here, axis=0)))
    L, area = cotangent_laplacian(here, problem.faces), vertex_areas(here, problem.faces)
    second = L.T @ sparse.diags(1.0 / np.where(used, area, 1.0)) @ L + sparse.diags(area / (SMOOTH * size) ** 4)
    metric = sparse.kron(second[columns][:, columns], np.eye(3))
    for _ in range(STEPS):
        if float(np.linalg.norm(rest)) <= CLOSING_TOLERANCE:
            break
        J = equations.jacobian(here)
        saddle = sparse.bmat([[metric, J.T], [J, None]]).tocsr()
        try:
            solution = factorise(saddle).solve(np.concatenate([np.zeros(3 * len(columns)), -rest]))
        except SingularMatrixError:
            return None
        there = here.copy()
        there[columns] += solution[: 3 * len(columns)].reshape(-1, 3)
        left = equations.residual(there)
        if not float(np.linalg.norm(left)) < float(np.linalg.norm(rest)):
            break
        here, rest = there, left
    near = float(np.linalg.norm(here - problem.vertices, axis=1).max(initial=0.0)) <= MAX_MOVE * size
    return problem.with_vertices(here) if near and float(np.linalg.norm(rest)) <= ROUNDING_FACTOR * CLOSING_TOLERANCE else None


def _slid(problem: CGCProblem) -> tuple[CGCProblem, bool]:
    """Return the surface with its vertices slid as far as the closing error decreases, and whether it closes."""
    V, F = problem.vertices, problem.faces
    rows = np.flatnonzero(problem.asked & np.isfinite(problem.targets))
    equations = SpaceFormEquations(F, np.where(np.isfinite(problem.targets), problem.targets, 0.0), rows, rows)
    if equations.too_large(V) is not None:
        return problem, False
    edge = float(np.linalg.norm(V[np.roll(F, -1, axis=1)] - V[F], axis=2).mean())
    here, rest = V, equations.residual(V)
    for _ in range(STEPS):
        size = float(np.linalg.norm(rest))
        step = _step(equations, here, rest) if size > CLOSING_TOLERANCE else None
        if step is None:
            break
        length = min(1.0, MAX_STEP * edge / max(float(np.linalg.norm(step, axis=1).max()), np.finfo(float).tiny))
        for _ in range(HALVINGS):
            there = here + length * step
            left = equations.residual(there)
            if np.linalg.norm(left) < size:
                break
            length /= 2
        else:
            break
        here, rest = there, left
    return problem.with_vertices(here), bool(np.linalg.norm(rest) <= ROUNDING_FACTOR * CLOSING_TOLERANCE)


def _step(equations: SpaceFormEquations, vertices: Vertices, rest: FloatArray) -> Optional[Vertices]:
    """Return the displacements (n, 3) of least norm that close the triangles to first order, None if singular."""
    rows = equations.rows
    K = np.zeros(len(vertices))
    K[rows] = np.abs(equations.targets[rows])
    J, ease = equations.jacobian(vertices), sliding_ease(vertices, equations.faces, K, rows)
    try:
        multipliers = factorise((J @ ease @ J.T).tocsr(), symmetric=True, points=vertices[rows]).solve(-rest)
    except SingularMatrixError:
        return None
    step = np.zeros_like(vertices)
    step[rows] = (ease @ (J.T @ multipliers)).reshape(-1, 3)
    return step if np.isfinite(step).all() else None
