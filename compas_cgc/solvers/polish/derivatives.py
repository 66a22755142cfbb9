"""Derivatives of a surface of least bending by the curvature of its regions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.problem import CGCProblem
from .optimiser import regularisation
from .optimiser import steps
from .polisher import places
from .polisher import posed_as_set
from .posed import pair_targets
from .saddle import Saddle
from .settings import PolishSettings
from .starts import from_surface

__all__ = ["moves_by_curvature"]

STEPS = 20  # back to the angles of the edges, which a surface does not carry


def moves_by_curvature(
    problem: CGCProblem, settings: PolishSettings, vertices: FloatArray, groups: Mapping[int, IntArray]
) -> dict[int, FloatArray]:
    r"""Return the derivatives of the surface by the curvature of groups of vertices.

    .. math:: \begin{pmatrix} W & J^T \\ J & 0 \end{pmatrix} \begin{pmatrix} dx \\ d\lambda \end{pmatrix}
              = \begin{pmatrix} J_A^T \lambda \\ A \end{pmatrix} dK,

    with the second derivatives W of the Lagrangian, and the areas A of the cells whose derivatives are J_A.

    Parameters
    ----------
    problem
        The drawing, with supports and targets.
    settings
        Of the solve.
    vertices
        ``(n, 3)`` the surface that was found [L].
    groups
        Vertices by the number of their group.

    Returns
    -------
    dict
        ``(n, 3)`` dx/dK by group [L^3].
    """
    posed = posed_as_set(problem, settings)
    own, frame = posed.lagrangian, posed.frame
    here, multipliers = from_surface(own, frame.to_local(vertices)), np.zeros(len(own.rows))
    for step in steps(own, here, places(own), posed.size):
        here, multipliers = step.state, step.multipliers
        if step.settled or step.number == STEPS:
            break
    model, saddle = own.model(here, multipliers), Saddle(places(own))
    saddle.factorise(own.pattern.matrix(model, model.hessian, 0.0, regularisation(own)))
    averages = own.mesh.averages(here.operators)
    found = {}
    for number, group in groups.items():
        rate = np.where(np.isfinite(posed.problem.targets), 0.0, np.nan)
        rate[group] = 1.0
        chosen = np.nan_to_num(pair_targets(replace(posed.problem, targets=rate), own.mesh)[own.rows])
        pull = own.area_derivative(here, multipliers * chosen)
        solution = saddle.solve(np.concatenate([pull, chosen * averages.areas[own.rows]]))
        unknowns = np.zeros(own.mesh.unknowns)
        unknowns[own.free] = solution[: own.size]
        found[number] = unknowns[: len(vertices), None] * own.mesh.directions * frame.scale**3
    return found
