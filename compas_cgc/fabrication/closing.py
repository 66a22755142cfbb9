"""Closing: a solved surface whose vertices are slid until its triangles close on its moulds, for what is balanced only there."""

from __future__ import annotations

from dataclasses import replace
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..discrete.space_form import SpaceFormEquations
from ..discrete.space_form import sliding_ease
from ..linalg import SingularMatrixError
from ..linalg import factorise
from ..meshing.even_triangles import even_triangles
from ..model.problem import CGCProblem

__all__ = ["closed", "closed_anew"]

STEPS, HALVINGS = 30, 6
ROUNDS = 4  # of laying triangles out anew
CLOSED = 1e-12  # of angles around vertices, each squared and summed up, that are off 2 pi [rad]
ROUNDING = 1e3  # times that, which is as near as it comes on large meshes
FARTHEST = 0.5  # of a mean edge, that vertices move by in a step


def closed(problem: CGCProblem) -> Optional[CGCProblem]:
    """Return the surface with its vertices where triangles close around each that has a target; None where that is not near.

    Moves along the surface are cheap, so that its shape stays; edges, creases and supports stay too. This is the last part of the
    measure ``exact`` of a solve, for surfaces that were solved with another.
    """
    slid, arrived = _slid(problem)
    return slid if arrived else None


def closed_anew(problem: CGCProblem) -> Optional[CGCProblem]:
    """Return what :func:`closed` does on even triangles of the same surface: vertices in the middle of their neighbours, edges turned.

    Triangles that are slender leave vertices no room to slide. Those laid out anew are on the surface to second order only, so
    they are laid out once more where vertices have slid as far as they go.
    """
    free = np.flatnonzero(problem.asked & ~boundary_vertices(problem.vertices, problem.faces))
    for _ in range(ROUNDS):
        vertices, faces = even_triangles(problem.vertices, problem.faces, free, problem.creases)
        problem, arrived = _slid(replace(problem, vertices=vertices, faces=faces))
        if arrived:
            return problem
    return None


def _slid(problem: CGCProblem) -> tuple[CGCProblem, bool]:
    """Return the surface with its vertices slid as far as triangles close the better for it, and whether they do."""
    V, F = problem.vertices, problem.faces
    rows = np.flatnonzero(problem.asked & np.isfinite(problem.targets))
    equations = SpaceFormEquations(F, np.where(np.isfinite(problem.targets), problem.targets, 0.0), rows, rows)
    if equations.too_large(V) is not None:
        return problem, False
    edge = float(np.linalg.norm(V[np.roll(F, -1, axis=1)] - V[F], axis=2).mean())
    here, rest = V, equations.residual(V)
    for _ in range(STEPS):
        size = float(np.linalg.norm(rest))
        step = _step(equations, here, rest) if size > CLOSED else None
        if step is None:
            break
        length = min(1.0, FARTHEST * edge / max(float(np.linalg.norm(step, axis=1).max()), np.finfo(float).tiny))
        for _ in range(HALVINGS):
            there = here + length * step
            left = equations.residual(there)
            if np.linalg.norm(left) < size:
                break
            length /= 2
        else:
            break
        here, rest = there, left
    return problem.with_vertices(here), bool(np.linalg.norm(rest) <= ROUNDING * CLOSED)


def _step(equations: SpaceFormEquations, vertices: Vertices, rest: FloatArray) -> Optional[Vertices]:
    """Return the cheapest moves (n, 3) that close the triangles to first order."""
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
