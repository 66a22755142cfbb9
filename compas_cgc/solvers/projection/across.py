"""The last digits of K, by moves across the surface: a third of what moves in space take, and as good where they are tiny."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...discrete.jacobian import CurvatureEquations
from .found_curvature import FoundCurvature
from .iterate import Point
from .least_norm import LeastNorm
from .linearised import Kept
from .linearised import Linearised
from .metric import MetricAcross
from .system import System

__all__ = ["Across", "along", "can_be_closed_across"]

NEAR = 1e-3  # residual, against the curvature asked for, from which the moves are tiny


class Across(System):
    """A system near a solution, whose linear equations are met by moves along the normals of one shape.

    Parameters
    ----------
    system
        One that nothing but K binds.
    vertices
        ``(n, 3)`` the shape.
    """

    def __init__(self, system: System, vertices: Vertices):
        self.__dict__.update(system.__dict__)
        self._normals = vertex_normals(vertices, system.faces)[system.columns]
        self._metric = MetricAcross(system.fairness.metric(system.places.freedoms(vertices)), self._normals)

    def linearised(self, point: Point, equations: CurvatureEquations, kept: Optional[Kept] = None) -> Linearised:
        """Return the equations about a shape."""
        J = along(self._normals, self.jacobian(point, equations))
        preconditioner = kept.preconditioner if kept is not None and kept.metric is self._metric else None
        solver = LeastNorm(J, self._metric, lambda: sparse.identity(len(self._normals), format="csr"), preconditioner)
        return Linearised(solver, None, -point.residual)


def can_be_closed_across(system: System, equations: CurvatureEquations, point: Point) -> bool:
    """Return whether nothing but K, which a shape nearly has, is asked of a system."""
    free = system.places.trivial and not (system.goals.equations or system.goals.sides or isinstance(equations, FoundCurvature))
    return free and system.missing(point, equations) <= NEAR


def along(directions: FloatArray, J: sparse.csr_matrix) -> sparse.csr_matrix:
    """Return derivatives by moves along one direction (c, 3) per vertex (k, c), of those by coordinates (k, 3c)."""
    # The three coordinates of a vertex stand beside each other.
    vertex = J.indices[::3] // 3
    values = np.einsum("ij,ij->i", J.data.reshape(-1, 3), directions[vertex])
    return sparse.csr_matrix((values, vertex, J.indptr // 3), shape=(J.shape[0], len(directions)))
