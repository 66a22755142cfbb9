"""The shapes that a search sets out from: the drawing, or the surfaces that bend least by mid-edge normals."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...model.roles import DUMMY
from ...model.roles import FIXED
from ..polish.polisher import surfaces
from .flatness import flat_share
from .iterate import Point
from .system import System

__all__ = ["bent", "is_flat", "starts"]

NEARLY = 0.05  # residual, against the curvature asked for, of a drawing that is taken as it is
FLAT_SHARE = 0.1  # part of the curvature asked for in flat places above which a drawing is no start


def starts(system: System, equations: CurvatureEquations, drawing: Point) -> Iterator[Point]:
    """Return the drawing alone where it is near or its shape is kept; else the surfaces that bend least, and then the drawing."""
    here = system.at(system.settled(drawing.vertices), equations)
    if system.missing(here, equations) > NEARLY and (system.keep != "shape" or is_flat(system, equations, here)):
        for vertices in bent(system, equations, drawing.vertices):
            yield system.at(system.settled(vertices), equations)
    yield here


def bent(system: System, equations: CurvatureEquations, drawing: FloatArray) -> list[FloatArray]:
    """Return the surfaces (n, 3) over a drawing that bend least, with the curvature asked for, the best first.

    None where faces have no area: their edges have no normals.
    """
    if not system.sound.all():
        return []
    problem = system.problem_at(drawing, equations.targets)
    held = problem.roles != DUMMY
    held[system.columns] = False
    return surfaces(replace(problem, roles=np.where(held, FIXED, problem.roles), goals=()))


def is_flat(system: System, equations: CurvatureEquations, point: Point) -> bool:
    """Return whether a shape is flat where much of the curvature is asked for."""
    return flat_share(point.vertices, system.faces, system.wanted(point, equations)) > FLAT_SHARE
