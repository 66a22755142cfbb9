"""What is fair: near to the input, and smooth."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import vertex_areas
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.constraints import Constraint
from ...model.constraints import Proximity
from ...model.constraints import indices
from ...model.problem import CGCProblem
from ...model.roles import CREASE
from .metric import Metric
from .metric import bending_matrix
from .placement import Freedoms
from .settings import ProjectionSettings

__all__ = ["Fairness"]

LEAST_MASS = 1e-6  # of a vertex, against the mean
SEED_MASS = 1e-4  # what holds a plate that nothing else holds


class Fairness:
    """The metric of a problem, for every set of free directions.

    ``W = nearness M + (smoothness sqrt(A))^4 Q``, with M the areas of the vertices, Q the
    bending energy and A the area of the mesh.

    Parameters
    ----------
    problem
        The problem in its local frame.
    faces
        ``(m, 3)`` its real faces.
    columns
        ``(c,)`` vertices that may move.
    size
        Square root of the area.
    settings
        Parameters.
    constraints
        Of which those that weigh vertices are taken.
    """

    def __init__(
        self,
        problem: CGCProblem,
        faces: IntArray,
        columns: IntArray,
        size: float,
        settings: ProjectionSettings,
        constraints: Sequence[Constraint],
    ):
        V = problem.vertices
        mass = vertex_areas(V, faces)
        mass = np.maximum(mass, LEAST_MASS * mass.mean())
        bending = size**4 * bending_matrix(V, faces, problem.roles == CREASE, settings.crease_stiffness)
        weights = np.full(len(V), settings.nearness)
        for constraint in constraints:
            if isinstance(constraint, Proximity):
                weights[indices(constraint.vertices, len(V))] *= constraint.weight
        self.plate = (SEED_MASS * sparse.diags(mass) + bending).tocsr()
        self._nearness = sparse.diags((weights * mass)[columns])
        self._bending = bending[columns][:, columns]
        self._set(settings.smoothness)

    def smoother(self, factor: float) -> Fairness:
        """Return the same with another smoothness."""
        other = copy.copy(self)
        other._set(factor * self._smoothness)
        return other

    def metric(self, freedoms: Freedoms) -> Metric:
        """Return the metric in the free directions; the last one while they are the same."""
        if self._last is None or not _same(self._last.basis, freedoms.basis):
            self._last = Metric(self.scalar, freedoms.basis)
        return self._last

    def fairest(self, freedoms: Freedoms) -> FloatArray:
        """Return the cheapest move onto the constraints (3c,)."""
        return self.metric(freedoms).fairest(freedoms.gap.ravel())

    def _set(self, smoothness: float) -> None:
        self._smoothness = smoothness
        self.scalar = (self._nearness + smoothness**4 * self._bending).tocsr()
        self._last: Optional[Metric] = None


def _same(one: Optional[sparse.csr_matrix], other: Optional[sparse.csr_matrix]) -> bool:
    if one is None or other is None:
        return one is other
    parts = ("indptr", "indices", "data")
    return one.shape == other.shape and all(np.array_equal(getattr(one, part), getattr(other, part)) for part in parts)
