"""Coarse to fine: large problems are solved on a coarser mesh first, and closed on their own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.smooth_measure import is_regular
from ...discrete.space_form import EXACT
from ...model.problem import CGCProblem
from ...model.tolerances import ROUNDING
from ...model.verdict import verdict
from ..coarse import coarsened
from ..coarse import laid_out_anew
from ..constants import COARSE_VERTICES
from ..constants import EVEN_VERTICES
from ..constants import LARGE_MESH
from .gauss_newton import Taken
from .iterate import Point
from .settings import AUTO
from .settings import ProjectionSettings
from .sliding import can_slide
from .strategies import smoothed_first
from .strategies import ways
from .strategies import ways_from_near
from .system import System

__all__ = ["ways_from_coarse"]


class _Found(NamedTuple):
    vertices: FloatArray  # (k, 3)
    solved: bool


def ways_from_coarse(
    problem: CGCProblem, system: System, equations: CurvatureEquations, start: Point, settings: ProjectionSettings
) -> Iterator[Taken]:
    """Take steps from the fairest shape on a coarser mesh of the same drawing, or a more even one, and in other ways where there is none.

    What is fair is settled on the coarser mesh. The shape is carried over by local polynomials, and the nearest one that
    fulfils the equations is found by moves across it, with the one or two matrices that this takes factorised.

    Parameters
    ----------
    problem
        The problem in its local frame.
    system, equations, start
        The same, ready to be solved, and its drawing.
    settings
        Parameters.
    """
    # Of a drawing whose shape is kept the nearest surface is the one, and that is near already.
    coarse, free = None, system.keep != "shape"
    irregular = free and settings.measure in (AUTO, "smooth", *EXACT) and _is_irregular_saddle(system, equations)
    if irregular and settings.measure in EXACT:
        # Triangles too slender to slide are laid out anew.
        coarse = laid_out_anew(problem, min(COARSE_VERTICES, max(EVEN_VERTICES, len(problem.vertices))))
    elif irregular:
        last: Optional[Taken] = None
        for last in _from_even(problem, system, equations, settings):
            yield last._replace(settled=False)
        # The plain way may be gone as well, and lead to a surface that is fair where this one is not.
        if last is not None and last.settled and _is_fair(problem, last.vertices):
            yield last
    elif free and len(system.columns) >= LARGE_MESH:
        coarse = coarsened(problem, COARSE_VERTICES)
    if coarse is None:
        yield from ways(system, equations, start, settings, False)
        return
    # It keeps the same of the drawing, and needs no exact measure.
    measure = "defect" if settings.measure in EXACT else settings.measure
    found = _solved(coarse.problem, replace(settings, keep=system.keep, measure=measure))
    here = system.at(system.settled(coarse.carried(found.vertices, anew=True)), equations)
    yield Taken(here.vertices, 1.0, 1, False)
    if found.solved and system.missing(here, equations) <= 1.0:  # at least as near as a flat mesh
        yield from ways_from_near(system, equations, here, settings)


def _is_irregular_saddle(system: System, equations: CurvatureEquations) -> bool:
    """Return whether K < 0 on an irregular mesh is all that is asked for: steps by angle defects lead to waves there."""
    if not system.can_be_laid_out_anew or not can_slide(system, equations):
        return False
    return not is_regular(system.faces, np.isin(np.arange(len(system.places.start)), system.rows))


def _from_even(problem: CGCProblem, system: System, equations: CurvatureEquations, settings: ProjectionSettings) -> Iterator[Taken]:
    """Take steps from the fairest shape on even triangles to the nearest that is smooth, and on to the nearest that is exact.

    Exact at once, it would have waves for what the meshes differ by.
    """
    even = laid_out_anew(problem, EVEN_VERTICES)
    found = None if even is None else _solved(even.problem, replace(settings, keep=system.keep, retry=False))
    if even is None or found is None or not (found.solved and _is_fair(even.problem, found.vertices)):
        return
    near = system.on(system.settled(even.carried(found.vertices, anew=True)), system.faces)
    yield Taken(near.places.start, 1.0, 1, False)
    yield from smoothed_first(near, equations, near.places.start, settings)


def _is_fair(problem: CGCProblem, vertices: FloatArray) -> bool:
    return verdict(problem.with_vertices(vertices), problem.vertices).fair


def _solved(problem: CGCProblem, settings: ProjectionSettings) -> _Found:
    """Return the fairest shape of a problem, or the best on the way to it."""
    system = System(problem, settings)
    equations = system.equations(problem.targets)
    here = best = system.at(problem.vertices, equations)
    goal = ROUNDING * problem.target_scale
    for count, taken in enumerate(ways(system, equations, here, settings, False)):
        here = system.at(taken.vertices, taken.equations or equations)
        best = min(best, here, key=lambda point: point.badness)
        if taken.settled and here.fulfils(goal, system.floor):
            return _Found(here.vertices, True)
        if count + 1 == settings.steps:
            break
    return _Found(best.vertices, best.fulfils(goal, system.rounding(best, equations)))
