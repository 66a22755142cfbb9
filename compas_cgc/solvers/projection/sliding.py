"""Sliding: the last step to K < 0 on irregular meshes, along the surface instead of across it.

What the angles around a vertex add up to depends on how its star lies on the surface as much as on how that bends. Where a layout
asks a saddle for waves, vertices are slid along a fair one until their stars lie as K asks; so it stays as fair as it is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...discrete import _kernels
from ...discrete import vertex_areas
from ...discrete.arrays import TINY
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import sliding_ease
from ...linalg import SingularMatrixError
from ...linalg import factorise
from ...model.laws import types_of
from ..constants import PATIENCE
from ..constants import WORTHWHILE
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .gauss_newton import line_search
from .iterate import Point
from .system import System

__all__ = ["can_slide", "slide", "turns_triangles_over"]

LAST = 3  # steps at rounding level [steps]; each reduces the rounding errors of the one before


def can_slide(system: System, equations: CurvatureEquations) -> bool:
    """Return whether K < 0 is asked for, and nothing else."""
    return system.asks_for_k_alone and bool((types_of(equations.targets[system.rows]) < 0).any())


def turns_triangles_over(system: System, equations: CurvatureEquations, vertices: FloatArray) -> bool:
    """Return whether the first step from a shape (n, 3) turns a triangle over: then its triangles leave no room to slide."""
    step = _step(system, equations, system.at(vertices, equations))
    before, after = (_kernels.cross_vectors(places, system.faces) for places in (vertices, vertices + step))
    return not bool((np.einsum("fx,fx->f", before, after) > 0.0).all())


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
        if not last and len(rests) > PATIENCE and rests[-1] > WORTHWHILE * rests[-1 - PATIENCE]:
            return


def _step(system: System, equations: CurvatureEquations, point: Point) -> FloatArray:
    """Return the cheapest step (n, 3) that fulfils the equations to first order."""
    J = system.jacobian(point, equations)
    K = np.zeros(len(point.vertices))
    K[system.rows] = np.abs(equations.targets[system.rows])
    cheap = sliding_ease(point.vertices, system.faces, K, system.columns)
    try:
        multipliers = factorise((J @ cheap @ J.T).tocsr(), symmetric=True, points=point.vertices[system.rows]).solve(-point.residual)
    except SingularMatrixError:
        return np.full_like(point.vertices, np.nan)
    step = system.full(cheap @ (J.T @ multipliers))
    edge = float(np.sqrt(vertex_areas(point.vertices, system.faces).mean()))
    return step * min(1.0, edge / max(float(np.linalg.norm(step, axis=1).max()), TINY))
