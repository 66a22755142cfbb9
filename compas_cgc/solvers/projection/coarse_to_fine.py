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
from ...discrete.space_form import exact_equations
from ...model.problem import CGCProblem
from ...model.tolerances import ROUNDING
from ...model.verdict import verdict
from ..coarse import Coarse
from ..coarse import coarsened
from ..coarse import laid_out_anew
from ..constants import COARSE_VERTICES
from ..constants import HUGE_MESH
from ..constants import LARGE_MESH
from ..constants import ROUNDINGS
from .gauss_newton import Taken
from .iterate import Point
from .settings import ProjectionSettings
from .sliding import can_slide
from .strategies import smoothed_first
from .strategies import ways
from .strategies import ways_from_near
from .system import KeptDrawing
from .system import System

__all__ = ["kept_on_coarse", "ways_from_coarse"]

FEWEST = 450  # vertices of even triangles [vertices]; fewer lose the shape of a plan with corners
# movable vertices from which an irregular mesh with K < 0 is first solved on even triangles [vertices]; smaller ones take few steps
DETOUR = 100
# vertices of a mesh per vertex of its coarser one, if that has more than COARSE_VERTICES; limits the distance that is interpolated
PART = 50


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
    many, irregular = len(system.columns) >= LARGE_MESH, _is_detour(system, equations, settings)
    # Of a drawing whose shape is kept the nearest surface is the one, and that is near already.
    if system.keep != "shape" and irregular and settings.measure not in EXACT and len(system.columns) < HUGE_MESH:
        last: Optional[Taken] = None
        for last in _from_even(problem, system, equations, settings):
            yield last._replace(settled=False)
        # The plain way may be gone as well, and lead to a surface that is fair where this one is not.
        if last is not None and last.settled and _is_fair(problem, last.vertices):
            yield last
    elif system.keep != "shape" and (many or irregular):
        count = len(problem.vertices)
        coarse = _coarsened(problem) if count >= LARGE_MESH else laid_out_anew(problem, min(COARSE_VERTICES, max(FEWEST, count)))
        found = None if coarse is None else _carried(coarse, _on_coarser(settings, system))
        if found is not None:
            here = system.at(system.settled(found.vertices), equations)
            yield Taken(here.vertices, 1.0, 1, False)
            if found.solved and system.missing(here, equations) <= 1.0:  # at least as near as a flat mesh
                for taken in ways_from_near(system, equations, here, settings):
                    yield taken
                    asked = taken.equations or exact_equations(equations, settings.measure)
                    here = system.at(taken.vertices, asked)
                    if here.fulfils(0.0, ROUNDINGS * system.rounding(here, asked)):
                        return
        if len(system.columns) >= HUGE_MESH and found is not None:
            # What does not end on a coarser mesh would take its time not to end on this one.
            return
    yield from ways(system, equations, start, settings, False)


def kept_on_coarse(problem: CGCProblem, settings: ProjectionSettings) -> Optional[KeptDrawing]:
    """Return what is kept of a large drawing that bends, as a coarser mesh of it tells; None where there is no such mesh, or no need.

    On the mesh itself to let its heights go takes as long as to solve it.

    Parameters
    ----------
    problem
        The problem in its local frame.
    settings
        Parameters.
    """
    if settings.keep == "shape" or len(problem.vertices) < HUGE_MESH or _is_flat(problem.vertices):
        return None
    coarse = _coarsened(problem)
    if coarse is None:
        return None
    keep, rest = System(coarse.problem, settings).kept
    return KeptDrawing(keep, problem.vertices if keep == "shape" else coarse.carried(rest, anew=True))


def _coarsened(problem: CGCProblem) -> Optional[Coarse]:
    return coarsened(problem, max(COARSE_VERTICES, len(problem.vertices) // PART))


def _is_flat(vertices: FloatArray) -> bool:
    """Return whether vertices (n, 3) lie in a plane, but for rounding."""
    away = vertices - vertices.mean(axis=0)
    least, _, largest = np.linalg.eigvalsh(away.T @ away)
    return bool(least <= ROUNDING**2 * largest)


def _on_coarser(settings: ProjectionSettings, system: System) -> ProjectionSettings:
    """Return the settings of a coarser mesh: it keeps the same of the drawing, and needs no exact measure."""
    return replace(settings, keep=system.keep, measure="defect" if settings.measure in EXACT else settings.measure)


def _is_fair(problem: CGCProblem, vertices: FloatArray) -> bool:
    return verdict(problem.with_vertices(vertices), problem.vertices).fair


def _is_detour(system: System, equations: CurvatureEquations, settings: ProjectionSettings) -> bool:
    """Return whether an irregular mesh ends in another measure where K < 0, for which angle defects on it are a detour, and a long one."""
    elsewhere = settings.measure in EXACT or (settings.measure != "defect" and len(system.columns) >= DETOUR)
    if not elsewhere or not system.can_be_laid_out_anew or not can_slide(system, equations):
        return False
    return not is_regular(system.faces, np.isin(np.arange(len(system.places.start)), system.rows))


def _from_even(problem: CGCProblem, system: System, equations: CurvatureEquations, settings: ProjectionSettings) -> Iterator[Taken]:
    """Take steps from the fairest shape on even triangles to the nearest that is smooth, and on to the nearest that is exact.

    Exact at once, it would have waves for what the meshes differ by.
    """
    even = laid_out_anew(problem, min(COARSE_VERTICES, max(FEWEST, len(problem.vertices) // 2)))
    found = None if even is None else _solved(even.problem, replace(_on_coarser(settings, system), retry=False))
    if even is None or found is None or not (found.solved and _is_fair(even.problem, found.vertices)):
        return
    near = system.on(system.settled(even.carried(found.vertices, anew=True)), system.faces)
    yield Taken(near.places.start, 1.0, 1, False)
    yield from smoothed_first(near, equations, near.places.start, settings)


def _carried(coarse: Coarse, settings: ProjectionSettings) -> _Found:
    """Return the fairest shape of a coarser mesh, carried over."""
    found = _solved(coarse.problem, settings)
    return found._replace(vertices=coarse.carried(found.vertices, anew=True))


def _solved(problem: CGCProblem, settings: ProjectionSettings) -> _Found:
    """Return the fairest shape of a problem, or the best on the way to it."""
    system = System(problem, settings)
    equations = system.equations(problem.targets)
    here = best = system.at(problem.vertices, equations)
    goal = ROUNDING * problem.target_scale
    steps = ways(system, equations, here, settings, False)
    if len(system.columns) >= LARGE_MESH:
        # Even triangles are not always regular ones: a mesh that is not large has no coarser one.
        steps = ways_from_coarse(problem, system, equations, here, settings)
    for count, taken in enumerate(steps):
        here = system.at(taken.vertices, taken.equations or equations)
        best = min(best, here, key=lambda point: point.badness)
        if taken.settled and here.fulfils(goal, system.floor):
            return _Found(here.vertices, True)
        if count + 1 == settings.steps:
            break
    return _Found(best.vertices, best.fulfils(goal, system.rounding(best, equations)))
