"""Which columns keep a surface of K > 0 from bulging to one side, before any is solved for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete import vertex_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.fit_operators import second_derivatives
from ..discrete.topology import closed_vertices
from ..linalg import factorise
from ..model.problem import CGCProblem
from ..model.roles import CREASE
from ..model.roles import FIXED
from .projection.metric import bending_matrix

__all__ = ["OneSided", "one_sided"]

ROUNDS = 60  # of fitting second derivatives and heights to each other
NEWTON = 12  # steps to the nearest point of a hyperbola, and the longest, and the farthest
LONGEST, FARTHEST = 1.0, 6.0
CONVEX = 0.3  # of the curvature of such a step, at least
STIFF = 1e-3  # weight of hinges beside second derivatives: these do not see every move
NEAR = 0.02  # what second derivatives are off, against those wanted: up to .005 where there is a surface, from .03 where there is none


class OneSided(NamedTuple):
    """Heights of a surface that bulges to one side, and the columns that had to be let go of for that, the worst first."""

    columns: list[int]
    heights: FloatArray  # (n,) [L]
    off: float  # as of the function that they are


class _Fitted(NamedTuple):
    """A function over the plan, as near to det D² = K with one sign as its supports let it come."""

    heights: FloatArray  # (n,) [L]
    off: float  # of its second derivatives, root mean square against those wanted
    gains: FloatArray  # (k,) how much of their squares letting go of a column would take away


def one_sided(problem: CGCProblem, columns: Sequence[int], most: int) -> Optional[OneSided]:
    r"""Return how a surface of K > 0 would bulge to one side, that where columns are less off, and without which; None if to none.

    .. math:: \min_{h, Z} \int |D^2 h - Z|^2, \quad \det Z = \bar K, \; Z < 0 \text{ or } Z > 0,

    over heights h that pass through the supports: what is left over says how far they are from a dome, or from a bowl, and the
    forces on the columns say which of them does it.

    Parameters
    ----------
    problem
        Of K > 0, over a plan.
    columns
        Supports that may be let go of.
    most
        So many of them at most.

    References
    ----------
    Caboussat, Glowinski, Sorensen, doi:10.1051/cocv/2012033 (least squares for the Monge-Ampère equation).
    """
    flat = problem.vertices * [1.0, 1.0, 0.0]
    rows = np.flatnonzero(problem.asked & closed_vertices(flat, problem.faces) & (problem.targets > 0.0))
    if not len(rows):
        return None
    plate = _Plate(problem, flat, rows)
    found = [_freed(plate, side, list(columns), most) for side in (1.0, -1.0)]
    good = [one for one in found if one.off <= NEAR]
    height = problem.vertices[:, 2]
    return min(good, key=lambda one: np.abs((one.heights - height)[one.columns]).max(initial=0.0)) if good else None


def _freed(plate: _Plate, side: float, columns: list[int], most: int) -> OneSided:
    freed: list[int] = []
    fitted = plate.fitted(side, freed, columns)
    while fitted.off > NEAR and len(freed) < most and len(columns) > len(freed):
        left = [column for column in columns if column not in freed]
        freed.append(left[int(np.argmax(fitted.gains))])
        fitted = plate.fitted(side, freed, [column for column in columns if column not in freed])
    return OneSided(freed, side * fitted.heights, fitted.off)


class _Plate:
    """Second derivatives of heights over a plan, and what they weigh."""

    def __init__(self, problem: CGCProblem, flat: FloatArray, rows: IntArray):
        F = problem.faces
        crease = problem.roles == CREASE
        self._second = second_derivatives(flat, F, rows, ~crease)
        self._areas, self._curvature = vertex_areas(flat, F)[rows], np.sqrt(problem.targets[rows])
        self._weights = sparse.diags(np.outer(self._areas, [1.0, 2.0, 1.0]).ravel())
        seen = self._second.T @ self._weights @ self._second
        hinges = bending_matrix(flat, F, crease, 0.0)
        self._stiffness = (seen + STIFF * seen.diagonal().sum() / hinges.diagonal().sum() * hinges).tocsr()
        self._heights, self._held = problem.vertices[:, 2], problem.roles == FIXED
        self._used = np.unique(F)

    def fitted(self, side: float, freed: Sequence[int], columns: Sequence[int]) -> _Fitted:
        held = self._held.copy()
        held[list(freed)] = False
        free, fixed = self._used[~held[self._used]], self._used[held[self._used]]
        Q = self._stiffness
        solve = factorise(Q[free][:, free], symmetric=True, refine=False).solve
        h = np.where(held, side * self._heights, 0.0)
        pull = Q[free][:, fixed] @ h[fixed]
        wanted = np.zeros((len(self._areas), 3))
        wanted[:, 0] = wanted[:, 2] = -self._curvature
        bent = wanted
        for _ in range(ROUNDS):
            load = self._second.T @ (self._weights @ wanted.ravel())
            h[free] = solve(load[free] - pull)
            bent = (self._second @ h).reshape(-1, 3)
            wanted = _nearest(bent, self._curvature)
        missed = float(self._areas @ ((bent - wanted) ** 2 @ [1.0, 2.0, 1.0])) / float(self._areas @ (2.0 * self._curvature**2))
        force = Q @ h - self._second.T @ (self._weights @ wanted.ravel())
        gains = [float(force[c]) ** 2 / _stiffness_at(Q, solve, free, c) for c in columns]
        return _Fitted(h, float(np.sqrt(missed)), np.array(gains))


def _stiffness_at(Q: sparse.csr_matrix, solve: object, free: IntArray, column: int) -> float:
    """Return the force for a unit move of a column that the rest of the plate gives way to."""
    beside = Q[free][:, [column]].toarray().ravel()
    return float(Q[column, column] - beside @ solve(beside))  # type: ignore[operator]


def _nearest(bent: FloatArray, curvature: FloatArray) -> FloatArray:
    """Return the negative definite matrices (k, 3) of determinants K that are nearest to others, as xx, xy, yy; of roots of K (k,)."""
    half, off = 0.5 * (bent[:, 0] - bent[:, 2]), bent[:, 1]
    mean, apart = 0.5 * (bent[:, 0] + bent[:, 2]), np.hypot(half, off)
    p, q, k = apart - mean, -apart - mean, curvature
    t = 0.5 * np.log(np.maximum(p, 1e-3 * k) / np.maximum(q, 1e-3 * k))
    for _ in range(NEWTON):
        a, b = k * np.exp(t), k * np.exp(-t)
        slope = a * (a - p) - b * (b - q)
        bend = np.maximum(a * (2.0 * a - p) + b * (2.0 * b - q), CONVEX * (a * a + b * b))
        t = np.clip(t - np.clip(slope / bend, -LONGEST, LONGEST), -FARTHEST, FARTHEST)
    a, b = -k * np.exp(t), -k * np.exp(-t)
    middle, spread = 0.5 * (a + b), 0.5 * (b - a)
    with np.errstate(invalid="ignore"):
        cos, sin = (np.where(apart > 0.0, one / np.where(apart > 0.0, apart, 1.0), 0.0) for one in (half, off))
    return np.column_stack([middle + spread * cos, spread * sin, middle - spread * cos])
