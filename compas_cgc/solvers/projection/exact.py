"""The exact finish: from a fair surface to the nearest that consists of the triangles of its moulds."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...discrete.arrays import Vertices
from ...discrete.corners import corner_angles
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import SpaceFormEquations
from ...discrete.space_form import exact_equations
from .evened import evened
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .measure import shows_layout
from .saddles import descend_over_saddles
from .sliding import can_slide
from .sliding import slide
from .smooth_shape import smooth_shape
from .system import System

__all__ = ["exactly"]

SLENDER = math.radians(6.2)  # angle of a triangle, below which vertices are evened out before they slide
NEAR = (10.0, 1000.0)  # weights of K against waves, for a shape that nearly has it


def exactly(system: System, equations: CurvatureEquations, measure: str, vertices: Vertices) -> Iterator[Taken]:
    """Take least-norm steps from a fair shape (n, 3) until space-form triangles close around its vertices.

    From anywhere else they would lead to another of the many surfaces that do. None are taken where a face is too large.
    """
    exact = exact_equations(equations, measure)
    if isinstance(exact, SpaceFormEquations) and exact.too_large(vertices) is None:
        if can_slide(system, exact) and shows_layout(system, equations, vertices):
            # Angles hold the fair shape to waves, which only those who slide along it can do without.
            slid = yield from smooth_shape(system, equations, vertices, NEAR)
            if corner_angles(slid, system.faces).min() < SLENDER:
                slid = yield from smooth_shape(system, equations, evened(slid, system.faces, system.rows), NEAR[1:], 1)
            for taken in slide(system, exact, system.at(slid, exact)):
                yield taken._replace(equations=exact)
                slid = taken.vertices
            if system.missing(system.at(slid, exact), exact) <= FULFILLED:
                return
        for taken in descend_over_saddles(system, exact, system.at(vertices, exact)):
            yield taken._replace(equations=exact)
