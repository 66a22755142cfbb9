"""The smooth measure of K: angle defects, less what the layout of the mesh puts into them."""

from __future__ import annotations

from collections.abc import Generator
from collections.abc import Iterator
from itertools import islice
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import Mask
from ...discrete.jacobian import CurvatureEquations
from ...discrete.local_fits import local_fits
from ...discrete.smooth_measure import DEGREE
from ...discrete.smooth_measure import RINGS
from ...discrete.smooth_measure import is_irregular
from ...discrete.smooth_measure import layout_errors
from ..constants import CONVERGED
from ..constants import WITHIN_REACH
from ..constants import WORTHWHILE
from .gauss_newton import FINISH
from .gauss_newton import Taken
from .gauss_newton import descend
from .iterate import Point
from .sequential import Reached
from .smooth_equations import SmoothEquations
from .smooth_equations import SmoothFoundCurvature
from .smooth_equations import in_smooth_measure
from .system import System
from .trust_region import refine

__all__ = ["renewed", "shows_layout", "smooth_equations", "smoothed"]

ROUNDS = 2  # searches for the fairest shape as the layout error changes; half and twice as many move surfaces by 4e-4 of the size
# steps with a kept layout error [steps]; half and twice as many move a surface with K < 0 on an irregular mesh by 0.03 of the size
STEPS = 2


def smooth_equations(system: System, equations: CurvatureEquations, vertices: FloatArray) -> CurvatureEquations:
    """Return the equations by which a surface like a shape (n, 3) has its targets in the smooth measure.

    Their targets are ``K̄ + τ``, with τ the truncation error of angle defect over area on the shape, told by
    polynomials fitted around its vertices: a deferred correction (Stetter 1978). The equations themselves stay as
    compact as they are, so that short waves are held by them.

    References
    ----------
    Stetter, doi:10.1007/BF01432879.
    """
    asked = system.across_corners(equations.targets)
    asked.targets = asked.targets + layout_errors(vertices, asked.faces, _asked(system, vertices))
    return asked


def shows_layout(system: System, equations: CurvatureEquations, vertices: FloatArray) -> bool:
    """Return whether a fair shape (n, 3) that meets the equations would have wrinkles from the layout of its mesh."""
    return is_irregular(vertices, equations.faces, _asked(system, vertices), equations.targets)


def smoothed(system: System, equations: CurvatureEquations, reached: Reached) -> Iterator[Taken]:
    """Take steps from a fair shape to the fairest one in the smooth measure, and on until its equations no longer change."""
    for _ in range(ROUNDS):
        earlier = reached
        asked = smooth_equations(system, equations, earlier.point.vertices)
        steps = refine(system, asked, Reached(system.at(earlier.point.vertices, asked), earlier.multipliers))
        reached = yield from _for(asked, steps)
        if _off(system, equations, reached.point.vertices) > _off(system, equations, earlier.point.vertices):
            # The fits took for layout what was a wrinkle: only the nearest surface is safe.
            reached = earlier
            break
    yield from renewed(system, equations, reached.point.vertices)


def renewed(system: System, equations: CurvatureEquations, vertices: FloatArray) -> Iterator[Taken]:
    """Take steps from a fair shape (n, 3) to the nearest one in the smooth measure.

    Far from it the layout's part is kept for some of them.
    """
    smooth = in_smooth_measure(system.across_corners(equations.targets), _asked(system, vertices))
    here = system.at(vertices, smooth)
    if system.missing(here, smooth) > WITHIN_REACH:
        for taken in islice(_with_layout_of(system, smooth, here), STEPS):
            here = system.at(taken.vertices, smooth)
            yield taken._replace(settled=False)
    for taken in descend(system, smooth, here, WORTHWHILE, FINISH):
        here = system.at(taken.vertices, smooth)
        yield taken._replace(settled=False, equations=smooth)
        if system.missing(here, smooth) <= CONVERGED:
            break
    # The rest of the way is shorter than what it changes of the layout's part.
    yield from _with_layout_of(system, smooth, here)


def _with_layout_of(system: System, smooth: Union[SmoothEquations, SmoothFoundCurvature], here: Point) -> Iterator[Taken]:
    """Take steps to the equations with the layout's part as it is on a shape."""
    asked = smooth.told(here.vertices)
    for taken in descend(system, asked, system.at(here.vertices, asked), patience=FINISH):
        yield taken._replace(equations=asked)


def _off(system: System, equations: CurvatureEquations, vertices: FloatArray) -> float:
    """Return how far the fitted polynomials of a shape (n, 3) are from their targets, in the middle."""
    asked = _asked(system, vertices)
    fitted = local_fits(vertices, equations.faces, asked, asked, DEGREE, RINGS).gaussian
    away = np.abs(fitted - equations.targets)[system.rows]
    return float(np.median(away[np.isfinite(away)])) if np.isfinite(away).any() else 0.0


def _asked(system: System, vertices: FloatArray) -> Mask:
    asked = np.zeros(len(vertices), bool)
    asked[system.rows] = True
    return asked


def _for(equations: CurvatureEquations, steps: Generator[Taken, None, Reached]) -> Generator[Taken, None, Reached]:
    """Pass on steps that are for other equations than those asked, and what they come to."""
    while True:
        try:
            taken = next(steps)
        except StopIteration as end:
            return end.value
        yield taken._replace(settled=False, equations=equations)
