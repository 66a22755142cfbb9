"""Surfaces near a design by mid-edge normals, which show K up to the seams, where exact equations leave strips of the mesh free."""

from __future__ import annotations

import math

from ..discrete.arrays import FloatArray
from ..linalg.work import until_spent
from ..model.problem import CGCProblem
from ..solvers.polish.optimiser import steps
from ..solvers.polish.polisher import places
from ..solvers.polish.posed import posed
from ..solvers.polish.starts import from_surface
from .assignment import Placed
from .assignment import finished
from .normal_moves import NormalMoves

__all__ = ["smoothed"]

FOLD_WIDTH = 0.5  # width of a strip that bends as easily as a seam folds, in widths of a panel; wider strips hardly change distances
STEPS = 30  # largest number of steps; what is left of the deviations from K then is removed by the exact equations


def smoothed(moves: NormalMoves, placed: Placed, problem: CGCProblem) -> Placed:
    r"""Return an assignment with the surface whose panels have its K up to their seams, by mid-edge normals, then by exact equations.

    Of these surfaces it is the one of least energy

    .. math:: \int |II - II_0|^2 + u^2 / d^4 \, dA + \frac1\ell \int (\vartheta - \vartheta_0)^2 \, ds

    with the moves u, the bending II and the folds ϑ at seams, the latter two less those of the design, the length d over which bending
    outweighs distance, and a length ℓ, half the width of a panel.

    Parameters
    ----------
    moves
        The design.
    placed
        The assignment, and the surface to start from.
    problem
        The design with the K and the seams of its panels.
    """
    local, frame = problem.local()
    size, waves = moves.size / frame.scale, moves.smoothing_length / frame.scale
    own = posed(local, FOLD_WIDTH * moves.panel_width / moves.size, moves.normals).near(waves, moves.importance)
    state = from_surface(own, frame.to_local(moves.shape(placed.moves)))
    for step in until_spent(steps(own, state, places(own), size)):
        state = step.state
        if step.settled or step.number == STEPS:
            break
    there: FloatArray = frame.scale * state.unknowns[moves.columns]
    return finished(moves, placed._replace(moves=there, norm=math.inf))
