"""The shapes that a search begins at: the drawing, or plates that would bend by themselves to the curvature prescribed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...model.measures import is_held_all_round
from ...model.roles import DUMMY
from ...model.roles import FIXED
from ..newton import newton
from ..polish.polisher import plates
from .fairness import flat_share
from .iterate import Point
from .ruled import ruled
from .sequential import NEAR
from .system import System

__all__ = ["is_flat", "starts"]

NEARLY = 0.05  # residual relative to the prescribed curvature up to which a drawing is the start; half and twice it give the same surfaces
# share of the prescribed curvature in flat places above which a drawing is no start; half and twice it give the same surfaces
FLAT_SHARE = 0.1


def starts(system: System, equations: CurvatureEquations, drawing: Point) -> Iterator[Point]:
    """Return the drawing alone where it is near or its shape is kept; else bent plates, and then the drawing.

    Where K = 0 is asked for, what straight lines between two curves span comes first, if it is nearer to that than the drawing.
    """
    here = system.at(system.settled(drawing.vertices), equations)
    spanned = None if system.keep == "shape" else _spanned(system, equations, here)
    if spanned is not None:
        yield spanned
        yield here
        return
    if system.missing(here, equations) > NEARLY and (system.keep != "shape" or is_flat(system, equations, here)):
        for vertices in _bent(system, equations, drawing.vertices):
            yield system.at(system.settled(vertices), equations)
    yield here


def _spanned(system: System, equations: CurvatureEquations, drawing: Point) -> Optional[Point]:
    """Return the shape that straight lines between two curves span, where K = 0 is asked for and it is nearer to that than the drawing."""
    missing = system.missing(drawing, equations)
    if equations.targets[system.rows].any() or (missing <= NEARLY and not system.torn):
        return None
    shape = ruled(system, drawing.vertices)
    if shape is None:
        return None
    point = system.at(system.settled(shape), equations)
    return point if system.missing(point, equations) < min(NEAR, missing) else None


def _bent(system: System, equations: CurvatureEquations, drawing: FloatArray) -> list[FloatArray]:
    """Return the plates (n, 3) over a drawing that would bend by themselves to the curvature prescribed, the likeliest first.

    None where faces have no area: their edges have no normals. Within a held rim K > 0 needs steeper edges than a plate has, and
    Newton's method finds the only convex surface.
    """
    if not system.sound.all():
        return []
    problem = system.problem_at(drawing, equations.targets)
    held = problem.roles != DUMMY
    held[system.columns] = False
    problem = replace(problem, roles=np.where(held, FIXED, problem.roles), goals=())
    if is_held_all_round(problem):
        convex = newton(problem)
        if convex.status == "converged":
            return [convex.vertices]
    return plates(problem)


def is_flat(system: System, equations: CurvatureEquations, point: Point) -> bool:
    """Return whether a shape is flat where much of the curvature is asked for."""
    return flat_share(point.vertices, system.faces, system.wanted(point, equations)) > FLAT_SHARE
