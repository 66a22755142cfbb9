"""The exact finish: from a fair surface to the nearest that consists of the triangles of its moulds."""

from __future__ import annotations

from collections.abc import Generator
from collections.abc import Iterator

from ...discrete.arrays import Vertices
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import SpaceFormEquations
from ...discrete.space_form import exact_equations
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .measure import shows_layout
from .saddles import descend_over_saddles
from .sliding import can_slide
from .sliding import slide
from .system import System

__all__ = ["exactly", "unsettled"]


def exactly(system: System, equations: CurvatureEquations, measure: str, vertices: Vertices) -> Iterator[Taken]:
    """Take least-norm steps from a fair shape (n, 3) until space-form triangles close around its vertices.

    From anywhere else they would lead to another of the many surfaces that do. None are taken where a face is too large.
    """
    exact = exact_equations(equations, measure)
    if isinstance(exact, SpaceFormEquations) and exact.too_large(vertices) is None:
        if can_slide(system, exact) and shows_layout(system, equations, vertices):
            for taken in slide(system, exact, system.at(vertices, exact)):
                yield taken._replace(equations=exact)
                vertices = taken.vertices
            if system.missing(system.at(vertices, exact), exact) <= FULFILLED:
                return
        for taken in descend_over_saddles(system, exact, system.at(vertices, exact)):
            yield taken._replace(equations=exact)


def unsettled(steps: Iterator[Taken], vertices: Vertices) -> Generator[Taken, None, Vertices]:
    """Pass on steps on the way to a start for the exact finish, and the shape (n, 3) that they come to from one.

    The last ones, to rounding in a measure that is given up, are left out.
    """
    for taken in steps:
        vertices = taken.vertices
        yield taken._replace(settled=False, equations=None)
        if taken.settled:
            break
    return vertices
