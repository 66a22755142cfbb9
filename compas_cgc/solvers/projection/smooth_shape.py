"""A smooth surface that nearly has its targets, whatever the layout of its mesh."""

from __future__ import annotations

from collections.abc import Generator
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import vertex_areas
from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.fit_operators import fit_operators
from ...discrete.jacobian import CurvatureEquations
from ...discrete.smoothed_normals import smooth_normals
from ...linalg import factorise
from ...linalg.work import count
from ...linalg.work import rights
from ..constants import FACTORS
from ..polish.posed import SMOOTHINGS
from .gauss_newton import Taken
from .smooth_equations import SLOPES
from .system import System
from .vectors import dot

__all__ = ["DRAWN", "LOOSE", "smooth_shape"]

WEIGHTS = (0.1, 1.0, 10.0, 100.0, 1000.0)  # successive weights of K relative to waves and bending; decades, each from the shape before
ROUNDS = 2  # steps for each weight [steps]; the next weight follows from a shape that need not be exact
FARTHEST = 0.1  # longest move relative to the size; half of it moves a surface with K < 0 on an irregular mesh by 0.02, twice it by nothing
HALVINGS = 5  # halvings of a step; half as many lead to another fair surface, twice as many to the same
# move relative to the size below which the next weight follows; ten times it leads to another fair surface, a tenth moves by 2e-4
STILL = 3e-4
STEEPEST = 0.5  # smallest cosine between these directions and the normals; limits moves to twice the distance


class _Weights(NamedTuple):
    """What counts besides K."""

    waves: float
    bending: float
    hinges: float  # as they bend in the search for the fairest shape
    near: float  # the way from the drawing


DRAWN = _Weights(30.0, 1e-5, 1e-3, 1.0)  # weights beside a kept drawing; found by trial on drawings with K <= 0
LOOSE = _Weights(3.0, 1e-3, 0.03, 1e-2)  # weights beside a start that nobody drew; found by trial, keeps it a hundredth as much


def smooth_shape(
    system: System,
    equations: CurvatureEquations,
    vertices: FloatArray,
    weights: Sequence[float] = WEIGHTS,
    rounds: int = ROUNDS,
    beside: _Weights = LOOSE,
    smoothed_normals: bool = False,
) -> Generator[Taken, None, FloatArray]:
    r"""Take steps from a shape (n, 3) to one nearby that is smooth and nearly has the curvature asked for, and return that.

    .. math:: \min_u \; \tfrac{w}{2} \sum_i A_i (K_i - \bar K_i)^2 + \tfrac{a}{2} \text{waves} + \tfrac{b}{2} \text{bending}

    over moves u along the normals, or smoothed ones, with K, waves (distances of vertices from polynomials around them) and bending all
    told by fitted polynomials, and w growing: a Gauss-Newton method. Angle defects hold an irregular mesh so tightly where
    K < 0 that the exact equations leave no smooth surface to choose, if they are asked before the surface is smooth.
    """
    here = _State(system, equations, vertices, vertices, beside, smoothed_normals)
    for weight in weights:
        for _ in range(rounds):
            there = here.next(weight)
            if there is None:
                break
            still = float(np.abs(there.vertices - here.vertices).max(initial=0.0)) <= STILL * system.size
            here = there
            yield Taken(here.vertices, here.length, here.trials, False)
            if still:
                break
    return here.vertices


class _State:
    """A shape, and what polynomials say of it."""

    def __init__(
        self, system: System, equations: CurvatureEquations, vertices: FloatArray, drawn: FloatArray, own: _Weights, smoothed_normals: bool
    ):
        self._system, self._equations, self.vertices, self._drawn, self._own = system, equations, vertices, drawn, own
        self._smoothed_normals = smoothed_normals
        self.length, self.trials = 1.0, 1
        asked = np.zeros(len(vertices), bool)
        asked[system.rows] = True
        mass, targets = vertex_areas(drawn, system.faces), equations.targets[system.rows]
        count(rights(SLOPES, 3 * len(vertices)))
        self._fits = fit_operators(vertices, system.faces, system.rows, asked, mass[system.rows])
        told = np.isfinite(self._fits.gaussian)
        self._lacking = np.where(told, self._fits.gaussian - targets, 0.0)
        self._exact = system.size**4 * mass[system.rows] * told
        # Hinges hold corners that no polynomial reaches.
        told_by_fits = system.size**2 * (own.waves * self._fits.waves + own.bending * self._fits.bending)
        self._smooth = told_by_fits + own.hinges * system.fairness.bending
        self._pull = own.near * mass / system.size**2

    def merit(self, weight: float) -> float:
        """Return what is to become small."""
        away = self.vertices - self._drawn
        smooth = dot(self.vertices.ravel(), (self._smooth @ self.vertices).ravel()) + dot(self._pull, (away**2).sum(axis=1))
        return 0.5 * (smooth + weight * dot(self._exact, self._lacking**2))

    def next(self, weight: float) -> Optional[_State]:
        """Return the shape after a round, None where no move across the surface makes anything better."""
        directions = self._directions()
        move = self._move(directions, weight)
        farthest = float(np.abs(move).max(initial=0.0)) / self._system.size
        if not np.isfinite(farthest):
            return None
        length, before = min(1.0, FARTHEST / max(farthest, STILL)), self.merit(weight)
        for trials in range(1, HALVINGS + 1):
            vertices = self.vertices + length * move[:, None] * directions
            there = _State(self._system, self._equations, vertices, self._drawn, self._own, self._smoothed_normals)
            if there.merit(weight) < before:
                there.length, there.trials = length, trials
                return there
            length /= 2
        return None

    def _directions(self) -> FloatArray:
        """Return the directions of moves (n, 3): normals, or smoothed ones, as those of waves would lead vertices into each other.

        They are as long as it takes to move by one along the normal, which is what K depends on.
        """
        normals = vertex_normals(self.vertices, self._system.faces)
        if not self._smoothed_normals:
            return normals
        directions = smooth_normals(self.vertices, self._system.faces, SMOOTHINGS)
        return directions / np.maximum(np.einsum("nx,nx->n", directions, normals), STEEPEST)[:, None]

    def _move(self, directions: FloatArray, weight: float) -> FloatArray:
        """Return the moves along directions (n, 3) across the surface (n,) of Gauss and Newton."""
        columns, J = self._system.columns, self._fits.jacobian
        away = self._pull[:, None] * (self.vertices - self._drawn)
        exact = weight * self._exact
        gradient = np.einsum("nx,nx->n", directions, self._smooth @ self.vertices + away) + J.T @ (exact * self._lacking)
        pull = self._pull * np.einsum("nx,nx->n", directions, directions)
        matrix = _along(self._smooth, directions) + J.T @ sparse.diags(exact) @ J + sparse.diags(pull)
        move = np.zeros(len(directions))
        count(rights(FACTORS, 3 * len(directions)))
        own = matrix.tocsr()[columns][:, columns]
        move[columns] = -factorise(own, symmetric=True, points=self.vertices[columns], refine=False).solve(gradient[columns])
        return move


def _along(matrix: sparse.csr_matrix, normals: FloatArray) -> sparse.csr_matrix:
    """Return a form of one coordinate (n, n) as one of moves along the normals (n, n)."""
    first, second, third = (sparse.diags(axis) @ matrix @ sparse.diags(axis) for axis in normals.T)
    return first + second + third
