"""Coarse to fine: large problems are solved on a coarser mesh first, and closed on their own."""

from __future__ import annotations

from collections.abc import Generator
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import EXACT
from ...discrete.space_form import exact_equations
from ...linalg import SingularMatrixError
from ...model.problem import CGCProblem
from ..coarse import Coarse
from ..coarse import coarsened
from .closing import Closing
from .exact import closing_equations
from .exact import exactly
from .exact import may_slide
from .gauss_newton import FINISH
from .gauss_newton import Taken
from .gauss_newton import descend
from .iterate import Point
from .measure import renewed
from .measure import shows_layout
from .settings import AUTO
from .settings import ProjectionSettings
from .strategies import ways
from .strategies import ways_on
from .system import KeptDrawing
from .system import System

__all__ = ["MANY", "kept_on_coarse", "ways_from_coarse"]

MANY = 6000  # vertices that may move, from which the way over a coarser mesh is the shorter one
COARSE = 2000  # vertices of that mesh: bending on it, and so the result, is within 1e-3 of the size of that on finer ones
PART = 50  # or one for so many of the finer, where that is more
LARGE = 20_000  # vertices that may move, from which there is no other way
SHORT = 1.0  # part of a step across the surface below which that way does not lead there
ROUNDINGS = 4.0  # residuals of so many rounding errors are zero
LEVEL = 1e-24  # squared distances from a plane, against those along it, that are none
MEMORY = 3  # steps in which residuals may grow, of a large mesh: where K < 0 the last sway before they converge
MET = 1e-12  # error, against the targets, that is as good as none on a coarser mesh
ALMOST = 1e-5  # residual, against the curvature asked for, of a shape that has not strayed


def ways_from_coarse(
    problem: CGCProblem, system: System, equations: CurvatureEquations, start: Point, settings: ProjectionSettings
) -> Iterator[Taken]:
    """Take steps from the fairest shape on a coarser mesh of the same drawing, where it is large, and in other ways where there is none.

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
    coarse = _coarsened(problem) if system.keep != "shape" and len(system.columns) >= MANY else None
    if coarse is not None:
        asked = exact_equations(equations, settings.measure)
        found = _solved(
            coarse.problem, replace(settings, keep=system.keep, measure="defect" if settings.measure in EXACT else settings.measure)
        )
        here = system.at(system.settled(coarse.carried(found, anew=True)), equations)
        yield Taken(here.vertices, 1.0, 1, False)
        for last in _from(system, equations, here, settings):
            yield last
            here = system.at(last.vertices, last.equations or asked)
        if _is_met(system, equations, here, settings):
            return
    if len(system.columns) >= LARGE and system.keep != "shape":
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
    if len(problem.vertices) < LARGE or _is_flat(problem.vertices):
        return None
    coarse = _coarsened(problem)
    if coarse is None:
        return None
    keep, rest = System(coarse.problem, settings).kept
    return KeptDrawing(keep, problem.vertices if keep == "shape" else coarse.carried(rest, anew=True))


def _coarsened(problem: CGCProblem) -> Optional[Coarse]:
    return coarsened(problem, max(COARSE, len(problem.vertices) // PART))


def _is_flat(vertices: FloatArray) -> bool:
    """Return whether vertices (n, 3) lie in a plane, but for rounding."""
    away = vertices - vertices.mean(axis=0)
    least, _, largest = np.linalg.eigvalsh(away.T @ away)
    return bool(least <= LEVEL * largest)


def _from(system: System, equations: CurvatureEquations, carried: Point, settings: ProjectionSettings) -> Iterator[Taken]:
    """Take the nearest way to the equations that there is: across the surface or, where that is not enough, in all directions."""
    if not system.places.trivial:
        carried = yield from ways_on(system, equations, carried)
    near = Closing(system, carried.vertices) if system.places.trivial else system
    if settings.measure == "smooth" or (settings.measure == AUTO and shows_layout(system, equations, carried.vertices)):
        last = None
        for taken in renewed(near, equations, carried.vertices):
            last = taken
            yield taken
        if last is not None and last.equations is not None:
            here = system.at(last.vertices, last.equations)
            if _is_met(system, equations, here, settings) or settings.measure == "smooth":
                return
    if settings.measure in EXACT and may_slide(system, equations, settings.measure, carried.vertices):
        # What is carried over is smooth; angle defects would only put waves into it.
        yield from exactly(system, equations, settings.measure, carried.vertices)
        return
    exact = closing_equations(equations, settings.measure, carried.vertices)
    asked = equations if exact is None else exact
    here = start = system.at(carried.vertices, asked)
    if system.places.trivial:
        here = yield from _to_rounding(near, asked, start, settings, SHORT)
    if _is_met(system, asked, here, settings):
        return
    # The last digits are met from where moves across leave off, as that is as fair; what is farther away has strayed.
    rest = here if system.missing(here, asked) <= ALMOST else start
    if exact is None:
        yield from _to_rounding(system, equations, rest, settings)
    else:
        yield from exactly(system, equations, settings.measure, rest.vertices)


def _is_met(system: System, equations: CurvatureEquations, point: Point, settings: ProjectionSettings) -> bool:
    return point.fulfils(_goal(equations, system, settings), ROUNDINGS * system.rounding(point, equations))


def _goal(equations: CurvatureEquations, system: System, settings: ProjectionSettings) -> float:
    return settings.tolerance * float(np.abs(equations.targets[system.rows]).max(initial=0.0))


def _to_rounding(
    system: System, equations: CurvatureEquations, here: Point, settings: ProjectionSettings, short: float = 0.0
) -> Generator[Taken, None, Point]:
    """Take steps until one brings the residuals to what rounding the coordinates leaves of them, or one is too short."""
    goal = _goal(equations, system, settings)
    memory = MEMORY if len(system.columns) >= LARGE else 1
    for taken in _descended(system, equations, here, memory):
        there = system.at(taken.vertices, equations)
        if taken.length < short and not there.fulfils(goal, ROUNDINGS * system.rounding(there, equations)):
            break
        here = there
        yield taken
        if here.fulfils(goal, system.rounding(here, equations)):
            break
    return here


def _descended(system: System, equations: CurvatureEquations, here: Point, memory: int) -> Iterator[Taken]:
    try:
        yield from descend(system, equations, here, patience=FINISH, memory=memory)
    except SingularMatrixError:
        return


def _solved(problem: CGCProblem, settings: ProjectionSettings) -> FloatArray:
    """Return the fairest shape (n, 3) of a problem, or the best on the way to it."""
    system = System(problem, settings)
    equations = system.equations(problem.targets)
    best = start = system.at(problem.vertices, equations)
    for taken in islice(ways(system, equations, start, settings, False), settings.steps):
        here = system.at(taken.vertices, taken.equations or equations)
        best = min(best, here, key=lambda point: point.badness)
        if taken.settled and here.fulfils(MET * problem.target_scale, system.floor):
            break
    return best.vertices
