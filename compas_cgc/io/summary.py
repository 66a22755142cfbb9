"""Summary of a file, as printed by ``compas-cgc check``."""

from __future__ import annotations

import numpy as np

from ..errors import names_what_was_meant
from ..fabrication.figures import two_digits
from ..fabrication.flattening import LONG_ASPECT
from ..fabrication.flattening import STRAIN
from ..fabrication.flattening import widest_panel
from ..meshing import Diagnostic
from ..model.checks import check
from ..model.counts import counted
from ..model.lengths import place_text
from ..model.lengths import unit_suffix
from ..model.problem import CGCProblem
from .reading import ReadProblem

__all__ = ["describe"]


@names_what_was_meant()
def describe(read: ReadProblem) -> tuple[str, list[Diagnostic]]:
    """Return a summary of a file, and the problems that affect a solve.

    Parameters
    ----------
    read
        Problem from :func:`compas_cgc.io.read_problem`.

    Returns
    -------
    text, diagnostics
        Diagnostics of the file, then those of :func:`compas_cgc.check`; some of them are only
        warnings.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.io import read_problem
    >>> text, problems = describe(read_problem(compas_cgc.get("vault.3dm")))
    >>> problems
    []
    """
    problem = read.problem
    targets = problem.region_targets()
    lines = [_head(problem), *(f"- {note}" for note in read.notes), f"{counted(len(targets), 'region')}:"]
    label, size = problem.regions(), float(np.ptp(problem.vertices, axis=0).max(initial=0.0))
    for number, K in enumerate(targets):
        faces = problem.faces[label == number]
        place = place_text(problem.vertices[faces].mean(axis=(0, 1)), size)
        asked = str(problem.laws.get(number, "no target")) if K is None else f"K = {K:g}{_panels(K, unit_suffix(problem.drawing.units))}"
        lines.append(f"- region {number} around {place}: {len(faces)} faces, {asked}")
    return "\n".join(lines), [*read.diagnostics, *check(problem)]


def _panels(K: float, unit: str) -> str:
    """Return the largest flat sheets that a curvature allows, with the suffix of the unit of lengths."""
    if not K:
        return "; unrolls into flat sheets without strain"
    square, strip = (f"{two_digits(width)}{unit}" for width in (widest_panel(K, STRAIN), widest_panel(K, STRAIN, LONG_ASPECT)))
    return f"; the strain of flat sheets is at most {100 * STRAIN:g} % up to a width of {square} (square) or {strip} (long)"


def _head(problem: CGCProblem) -> str:
    name, units, tolerance = problem.drawing[:3]
    if units is not None and tolerance is not None:
        return f"{name}: {units}, tolerance {tolerance:g}{unit_suffix(units)}"
    return f"{name}: {len(problem.vertices)} vertices, {len(problem.faces)} faces, {len(problem.supports)} supports"
