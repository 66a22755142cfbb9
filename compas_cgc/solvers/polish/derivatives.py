"""Derivatives of a surface of least bending by the constants of its regions: their K, or those of their laws."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...discrete.arrays import FloatArray
from ...model.laws import ConstantCurvature
from ...model.problem import CGCProblem
from .optimiser import regularisation
from .optimiser import steps
from .polisher import places
from .polisher import posed_as_set
from .posed import pair_rates
from .saddle import Saddle
from .settings import PolishSettings
from .starts import from_surface

__all__ = ["moves_by_constants"]

STEPS = 20  # back to the angles of the edges, which a surface does not carry


def moves_by_constants(
    problem: CGCProblem, settings: PolishSettings, vertices: FloatArray, regions: Iterable[int]
) -> dict[int, FloatArray]:
    r"""Return the derivatives of the surface by the constants of regions.

    .. math:: \begin{pmatrix} W & J^T \\ J & 0 \end{pmatrix} \begin{pmatrix} dx \\ d\lambda \end{pmatrix}
              = \begin{pmatrix} J_A^T \lambda \\ A \end{pmatrix} dc,

    with the second derivatives W of the Lagrangian, and the areas A of the cells, whose derivatives are J_A: residuals are
    :math:`A (g(H, K) - c)`.

    Parameters
    ----------
    problem
        The drawing, with supports, targets and laws.
    settings
        Of the solve.
    vertices
        ``(n, 3)`` the surface that was found [L].
    regions
        Numbers of regions.

    Returns
    -------
    dict
        ``(n, 3)`` dx/dc by region [L per unit of the constant: L^3 for K, L^2 for H].
    """
    posed = posed_as_set(problem, settings)
    own, frame = posed.lagrangian, posed.frame
    here, multipliers = from_surface(own, frame.to_local(vertices)), np.zeros(len(own.rows))
    for step in steps(own, here, places(own), posed.size):
        here, multipliers = step.state, step.multipliers
        if step.settled or step.number == STEPS:
            break
    model, saddle = own.model(here, multipliers), Saddle(places(own), own.border)
    saddle.factorise(own.pattern.matrix(model, model.hessian, 0.0, regularisation(own)))
    averages = own.mesh.averages(here.operators)
    found = {}
    for region in regions:
        rates = pair_rates(posed.problem, own.mesh, own.rows, region)
        pull = own.area_derivative(here, multipliers * rates)
        solution = saddle.solve(np.concatenate([pull, rates * averages.areas[own.rows]]))
        unknowns = np.zeros(own.mesh.unknowns)
        unknowns[own.free] = solution[: own.size]
        law = problem.laws.get(region, ConstantCurvature(1.0))
        # Similarities and normalisation multiply the constant, by the factor that 1 gets.
        unit = law.with_constant(1.0).scaled(1.0 / frame.scale).normalised().constant
        assert unit is not None
        found[region] = unknowns[: len(vertices), None] * own.mesh.directions * frame.scale * unit
    return found
