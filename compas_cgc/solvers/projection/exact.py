"""The exact finish: from a fair surface to the nearest that consists of the triangles of its moulds."""

from __future__ import annotations

from collections.abc import Generator
from collections.abc import Iterator
from typing import Optional
from typing import TypeVar

from ...discrete.arrays import Vertices
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import SpaceFormEquations
from ...discrete.space_form import exact_equations
from ...meshing.even_triangles import even_triangles
from ...model.laws import types_of
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .gauss_newton import descend_to_rounding
from .measure import shows_layout
from .sliding import can_slide
from .sliding import slide
from .sliding import turns_triangles_over
from .smooth_shape import smooth_shape
from .system import System

__all__ = ["closing_equations", "exactly", "may_slide"]

Result = TypeVar("Result")
_Search = Generator[Taken, None, bool]

NEAR = (10.0, 1000.0)  # weights of K relative to waves for a shape that nearly has it; the third and the last of WEIGHTS


def may_slide(system: System, equations: CurvatureEquations, measure: str, vertices: Vertices) -> bool:
    """Return whether a fair shape (n, 3) is brought to an exact measure by sliding: angles of its stars hold it to waves."""
    exact = closing_equations(equations, measure, vertices)
    return exact is not None and can_slide(system, exact) and shows_layout(system, equations, vertices)


def closing_equations(equations: CurvatureEquations, measure: str, vertices: Vertices) -> Optional[SpaceFormEquations]:
    """Return what closes space-form triangles around vertices (n, 3), None in other measures or where a face is too large."""
    exact = exact_equations(equations, measure)
    return exact if isinstance(exact, SpaceFormEquations) and exact.too_large(vertices) is None else None


def exactly(system: System, equations: CurvatureEquations, measure: str, vertices: Vertices) -> Iterator[Taken]:
    """Take least-norm steps from a fair shape (n, 3) until space-form triangles close around its vertices.

    From anywhere else they would lead to another of the many surfaces that do. None are taken where a face is too large.
    """
    exact = closing_equations(equations, measure, vertices)
    if exact is None:
        return
    if may_slide(system, equations, measure, vertices):
        smooth = yield from smooth_shape(system, equations, vertices, NEAR)
        on_these, on_others = _slid(system, exact, smooth), _on_even_triangles(system, equations, measure, vertices)
        if not system.can_be_laid_out_anew:
            tried = [on_these]
        else:
            tried = [on_others, on_these] if turns_triangles_over(system, exact, smooth) else [on_these, on_others]
        for steps in tried:
            if (yield from steps):
                return
    for taken in descend_to_rounding(system, exact, system.at(vertices, exact)):
        yield taken._replace(equations=exact)


def _on_even_triangles(system: System, equations: CurvatureEquations, measure: str, fair: Vertices) -> _Search:
    """Slide on a mesh of the same fair surface (n, 3) whose triangles leave room for it; return whether that arrives."""
    negative = system.rows[types_of(equations.targets[system.rows]) < 0]
    vertices, faces = even_triangles(fair, system.faces, negative, system.creases)
    anew = system.on(vertices, faces)
    own = anew.equations(equations.targets)
    exact = exact_equations(own, measure)
    vertices = yield from _of(anew, exact, smooth_shape(anew, own, vertices, NEAR, 1))
    return (yield from _of(anew, exact, _slid(anew, exact, vertices)))


def _slid(system: System, exact: CurvatureEquations, vertices: Vertices) -> _Search:
    """Slide from a smooth shape (n, 3); return whether that arrives."""
    for taken in slide(system, exact, system.at(vertices, exact)):
        yield taken._replace(equations=exact)
        vertices = taken.vertices
    return system.missing(system.at(vertices, exact), exact) <= FULFILLED


def _of(system: System, exact: CurvatureEquations, steps: Generator[Taken, None, Result]) -> Generator[Taken, None, Result]:
    """Pass on steps that are taken on another mesh, and what they come to."""
    while True:
        try:
            taken = next(steps)
        except StopIteration as end:
            return end.value
        yield taken._replace(equations=exact, system=system)
