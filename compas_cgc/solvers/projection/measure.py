"""The smooth measure of K: angle defects, less what the layout of the mesh puts into them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.local_fits import local_fits
from .gauss_newton import Taken
from .gauss_newton import descend
from .iterate import Point
from .sequential import Reached
from .system import System
from .trust_region import refine

__all__ = ["FINISH", "smooth_equations", "smoothed"]

DEGREE, RINGS = 4, 3  # of the polynomials
ROUNDS = 2  # of the search for the fairest shape
RENEWALS = 12  # of the equations after it
STEPS = 2  # to the equations between renewals
STILL = 1e-6  # change of their targets, against the largest, that is none
FINISH = 4  # steps to rounding without much gain after which it is reached


def smooth_equations(system: System, equations: CurvatureEquations, vertices: FloatArray) -> CurvatureEquations:
    """Return the equations by which a surface like a shape (n, 3) has its targets in the smooth measure.

    Their targets are ``K̄ + τ``, with τ the truncation error of angle defect over area on the shape, told by
    polynomials fitted around its vertices: a deferred correction (Stetter 1978). The equations themselves stay as
    compact as they are, so that short waves are held by them.

    References
    ----------
    Stetter, doi:10.1007/BF01432879.
    """
    asked = np.zeros(len(vertices), bool)
    asked[system.rows] = True
    fits = local_fits(vertices, equations.faces, asked, asked, DEGREE, RINGS)
    # No layout puts more into a defect than the curvatures that are there; beside edges a fit may claim so.
    most = fits.mean**2 + np.abs(fits.gaussian)
    error = np.where(np.isfinite(fits.truncation), np.clip(fits.truncation, -most, most), 0.0)
    return system.equations(equations.targets + error)


def smoothed(system: System, equations: CurvatureEquations, reached: Reached) -> Iterator[Taken]:
    """Take steps from a fair shape to the fairest one in the smooth measure, and on until its equations no longer change."""
    for _ in range(ROUNDS):
        before = reached
        asked = smooth_equations(system, equations, before.point.vertices)
        steps = refine(system, asked, Reached(system.at(before.point.vertices, asked), before.multipliers))
        reached = yield from _for(asked, steps)
        if _missing(system, equations, reached.point) > _missing(system, equations, before.point):
            # The fits took for layout what was a wrinkle: only the nearest surface is safe.
            reached = before
            break
    scale = float(np.abs(equations.targets[system.rows]).max(initial=0.0)) or 1.0 / system.size**2
    vertices, asked = reached.point.vertices, smooth_equations(system, equations, reached.point.vertices)
    for _ in range(RENEWALS):
        for taken in islice(descend(system, asked, system.at(vertices, asked)), STEPS):
            vertices = taken.vertices
            yield taken._replace(settled=False, equations=asked)
        before, asked = asked, smooth_equations(system, equations, vertices)
        if np.abs(asked.targets - before.targets)[system.rows].max(initial=0.0) <= STILL * scale:
            break
    for taken in descend(system, asked, system.at(vertices, asked), patience=FINISH):
        yield taken._replace(equations=asked)


def _missing(system: System, equations: CurvatureEquations, point: Point) -> float:
    """Return what a shape lacks in the smooth measure."""
    asked = smooth_equations(system, equations, point.vertices)
    return system.missing(system.at(point.vertices, asked), equations)


def _for(equations: CurvatureEquations, steps: Iterator[Taken]) -> Iterator[Taken]:
    """Pass on steps that are for other equations than those asked, and what they come to."""
    while True:
        try:
            taken = next(steps)
        except StopIteration as end:
            return end.value
        yield taken._replace(settled=False, equations=equations)
