"""Sliding: the last step to K < 0 on irregular meshes, along the surface instead of across it.

What the angles around a vertex add up to depends on how its star lies on the surface as much as on how that bends. Where a layout
asks a saddle for waves, vertices are slid along a fair one until their stars lie as K asks; so it stays as fair as it is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import sparse

from ...discrete import vertex_areas
from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...linalg import SingularMatrixError
from ...linalg import factorise
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .gauss_newton import line_search
from .iterate import Point
from .system import System

__all__ = ["can_slide", "slide"]

ACROSS = 0.5  # what a move across the surface costs, against one along it that changes the angles of a saddle as much
FARTHEST = 1.0  # of a mean edge, that a vertex is moved by in a step
PATIENCE, GAIN = 8, 0.5  # steps that must bring the rest down to this part
LAST = 3  # steps to rounding


def can_slide(system: System, equations: CurvatureEquations) -> bool:
    """Return whether K < 0 is asked for, and nothing else."""
    plain = system.places.trivial and not system.goals.equations and not system.goals.sides
    return plain and bool((equations.targets[system.rows] < 0.0).any())


def slide(system: System, equations: CurvatureEquations, start: Point) -> Iterator[Taken]:
    """Take the shortest steps to rounding by a measure for which moves along the surface are cheap, except on edges and creases."""
    here, rests, last = start, [start.merit], 0
    while last < LAST and here.merit > 0.0:
        step = _step(system, equations, here)
        found = line_search(system, equations, here, step) if np.isfinite(step).all() else None
        if found is None:
            return
        here, length, trials = found
        yield Taken(here.vertices, length, trials)
        rests.append(here.merit)
        last += system.missing(here, equations) <= FULFILLED
        if not last and len(rests) > PATIENCE and rests[-1] > GAIN * rests[-1 - PATIENCE]:
            return


def _step(system: System, equations: CurvatureEquations, point: Point) -> FloatArray:
    """Return the cheapest step (n, 3) that fulfils the equations to first order."""
    J = system.jacobian(point, equations)
    cheap = _ease(system, equations, point.vertices)
    try:
        multipliers = factorise((J @ cheap @ J.T).tocsr(), symmetric=True).solve(-point.residual)
    except SingularMatrixError:
        return np.full_like(point.vertices, np.nan)
    step = system.full(cheap @ (J.T @ multipliers))
    edge = float(np.sqrt(vertex_areas(point.vertices, system.faces).mean()))
    return step * min(1.0, FARTHEST * edge / max(float(np.linalg.norm(step, axis=1).max()), np.finfo(float).tiny))


def _ease(system: System, equations: CurvatureEquations, vertices: FloatArray) -> sparse.csr_matrix:
    """Return the inverse of the metric (3c, 3c).

    On a saddle of curvature K with edges of length h a move across it changes angles by ``sqrt(-K) / h`` for each length, one along it by
    ``-K``: so that has the weight one, and the first ``1 / (-K h²)``.
    """
    columns = system.columns
    K = np.zeros(len(vertices))
    K[system.rows] = np.abs(equations.targets[system.rows])
    asked = K > 0.0
    K[~asked] = K[asked].mean()
    across = np.minimum(1.0, K * vertex_areas(vertices, system.faces) / ACROSS)[columns]
    along = np.where(asked[columns], 1.0, across)
    normals = vertex_normals(vertices, system.faces)[columns]
    blocks = along[:, None, None] * np.eye(3) + (across - along)[:, None, None] * normals[:, :, None] * normals[:, None, :]
    places = np.arange(len(columns) + 1)
    return sparse.bsr_matrix((blocks, places[:-1], places), shape=(3 * len(columns),) * 2).tocsr()
