"""A start for a roof that is held all round and may fold: the dome over its edge that does not."""

from __future__ import annotations

from dataclasses import replace
from typing import Optional

import numpy as np

from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import Solution
from ..model.roles import CREASE
from ..model.roles import INTERNAL
from .newton import NewtonSettings
from .newton import newton
from .projection.coarse_to_fine import MANY
from .projection.projector import ready
from .projection.settings import ProjectionSettings
from .projection.symmetry import tears_faces

__all__ = ["solved_from_dome"]

PART = 0.5  # of the curvature asked for: folded, a roof is lower
STEPS = 50  # most steps to the dome


def solved_from_dome(problem: CGCProblem, settings: ProjectionSettings, callback: Callback = None) -> Optional[Solution]:
    """Return the fairest surface that the dome without folds leads to.

    Across creases a flat sheet folds more easily than it bends, and the gentlest ways to bend it put bays beside each other that
    bulge up and down. A dome bulges to one side, and there is one that Newton's method finds.

    Parameters
    ----------
    problem
        Held all round, with creases, and with K > 0 everywhere.
    settings
        Of the projection.
    callback
        Called after every step of the projection.

    Returns
    -------
    Solution or None
        None where there is no such dome, where the shape of the drawing is to be kept, or where other starts are as good or cheaper.
    """
    if settings.keep == "shape" or len(problem.vertices) > MANY or tears_faces(problem):
        return None
    asked = problem.targets[problem.asked]
    roles = np.where(problem.roles == CREASE, INTERNAL, problem.roles)
    smooth = replace(
        problem, roles=roles, creases=problem.creases[:0], targets=PART * np.where(problem.asked, problem.targets, asked.mean())
    )
    dome = newton(smooth, settings=NewtonSettings(steps=STEPS))
    if dome.status != "converged":
        return None
    return ready(problem, settings).solve(problem.targets, dome.vertices, callback=callback)._replace(method="projection")
