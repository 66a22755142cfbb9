"""Derivatives of a surface of least bending by the constants of its regions: their K, or those of their laws."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator

from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...linalg import nearly_solved
from ...model.laws import ConstantCurvature
from ...model.problem import CGCProblem
from ..constants import CONVERGED
from ..constants import KRYLOV
from ..constants import MAX_STEPS
from .lagrangian import Lagrangian
from .lagrangian import State
from .optimiser import regularisation
from .optimiser import steps
from .polisher import begun_from
from .polisher import places
from .polisher import posed_as_set
from .posed import pair_rates
from .saddle import Saddle
from .settings import PolishSettings

__all__ = ["Rate", "moves_by_constants", "rates_by_constants"]


class Rate(NamedTuple):
    """The derivatives of a surface by a constant."""

    moves: FloatArray  # (n, 3) of its vertices [L per unit of the constant: L^3 for K, L^2 for H]
    unknowns: FloatArray  # (u,) of its moves and angles in the frame, per unit of the constant

    def times(self, factor: float) -> Rate:
        """Return the derivatives by another unit of the constant."""
        return Rate(factor * self.moves, factor * self.unknowns)


def moves_by_constants(
    problem: CGCProblem, settings: PolishSettings, vertices: FloatArray, regions: Iterable[int]
) -> dict[int, FloatArray]:
    """Return the moves (n, 3) of :func:`rates_by_constants` by region."""
    return {region: rate.moves for region, rate in rates_by_constants(problem, settings, vertices, regions).items()}


def rates_by_constants(problem: CGCProblem, settings: PolishSettings, surface: FloatArray, regions: Iterable[int]) -> dict[int, Rate]:
    r"""Return the derivatives of the surface by the constants of regions.

    .. math:: \begin{pmatrix} W & J^T \\ J & 0 \end{pmatrix} \begin{pmatrix} dx \\ d\lambda \end{pmatrix}
              = \begin{pmatrix} J_A^T \lambda \\ A \end{pmatrix} dc,

    with the second derivatives W of the Lagrangian, and the areas A of the cells, whose derivatives are J_A: residuals are
    :math:`A (g(H, K) - c)`. Goals for vertices, and sides that they touch, are held; quantities of the whole surface go on pushing as
    they do, but their numbers are let go.

    Parameters
    ----------
    problem
        The drawing, with supports, targets and laws.
    settings
        Of the solve.
    surface
        ``(n, 3)`` vertices of the surface that was found [L], or its moves and angles ``(u,)``.
    regions
        Numbers of regions.

    Returns
    -------
    dict
        dx/dc by region.
    """
    posed = posed_as_set(problem, settings)
    own, frame = posed.lagrangian, posed.frame
    here, multipliers = begun_from(own, frame, surface), np.zeros(own.count)
    forces = np.zeros(len(here.met.values))
    for step in steps(own, here, places(own), posed.size):
        here, multipliers, forces = step.state, step.multipliers, step.forces
        if step.settled or step.number == MAX_STEPS:
            break
    model, saddle = own.model(here, multipliers), Saddle(places(own))
    touching = here.met.one_sided & (forces != 0.0)
    saddle.factorise(own.pattern.matrix(model, model.hessian, 0.0, regularisation(own)), own.border(here.met, touching))
    averages = own.mesh.averages(here.operators)
    found = {}
    for region in regions:
        rates = pair_rates(posed.problem, own.mesh, own.rows, region)
        pull = own.area_derivative(here, multipliers[: len(rates)] * rates)
        right = np.concatenate([pull, rates * averages.areas[own.rows], np.zeros(own.count - len(rates))])
        solution = _solved(own, here, saddle, forces, right)
        unknowns = np.zeros(own.mesh.unknowns)
        unknowns[own.free] = solution[: own.size]
        law = problem.laws.get(region, ConstantCurvature(1.0))
        # Similarities and normalisation multiply the constant, by the factor that 1 gets.
        unit = law.with_constant(1.0).scaled(1.0 / frame.scale).normalised().constant
        assert unit is not None
        unknowns *= unit
        found[region] = Rate(unknowns[: len(own.drawing), None] * own.mesh.directions * frame.scale, unknowns)
    return found


def _solved(own: Lagrangian, here: State, saddle: Saddle, forces: FloatArray, right: FloatArray) -> FloatArray:
    """Return the solution for a right side (q + r + k,), with the second derivatives of quantities, which the factors are without."""
    nothing = np.zeros(saddle.conditions)
    first = saddle.solve(right, nothing)[0]
    vertices, moved = own.vertices(here.unknowns), own.free[: own.moves]

    def applied(solution: FloatArray) -> FloatArray:
        pushes = np.zeros_like(solution)
        pushes[: own.moves] = own.conditions.pushes_along(vertices, forces, own.moves_of(solution))[moved]
        return solution + saddle.solve(pushes, nothing)[0] if pushes.any() else solution.copy()

    operator = LinearOperator((len(first), len(first)), matvec=applied, dtype=np.float64)
    solution = nearly_solved(operator, lambda own: own, first, CONVERGED, KRYLOV)
    if solution is None:
        raise ProblemError(
            ["the constraint forces of the goals change too abruptly for derivatives by K; leave out goals for areas and lengths"]
        )
    return solution
