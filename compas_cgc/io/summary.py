"""What ``compas-cgc check`` says about a file."""

from __future__ import annotations

from ..errors import names_what_was_meant
from ..fabrication.flattening import LONG_ASPECT
from ..fabrication.flattening import STRAIN
from ..fabrication.flattening import widest_panel
from ..meshing import Diagnostic
from ..model.checks import check
from ..model.problem import CGCProblem
from .reading import ReadProblem
from .rhino.units import unit_suffix

__all__ = ["describe"]


@names_what_was_meant()
def describe(read: ReadProblem) -> tuple[str, list[Diagnostic]]:
    """Return what was found in a file and what would be done, and what keeps it from being solved.

    Parameters
    ----------
    read
        What :func:`compas_cgc.io.read_problem` gave.

    Returns
    -------
    text, diagnostics
        Those of the file, then those of :func:`compas_cgc.check`, of which some do not keep
        it from being solved.

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
    lines = [_head(problem), *(f"- {note}" for note in read.notes), f"{len(targets)} region{'s' if len(targets) > 1 else ''}:"]
    label = problem.regions()
    for number, K in enumerate(targets):
        faces = problem.faces[label == number]
        place = ", ".join(f"{x:.4g}" for x in problem.vertices[faces].mean(axis=(0, 1)))
        lines.append(f"- region {number} around ({place}): {len(faces)} faces, {'no target' if K is None else f'K = {K:g}{_panels(K)}'}")
    return "\n".join(lines), [*read.diagnostics, *check(problem)]


def _panels(K: float) -> str:
    """Return what a curvature means for flat sheets."""
    if not K:
        return "; unrolls into flat sheets without strain"
    square, strip = widest_panel(K, STRAIN), widest_panel(K, STRAIN, LONG_ASPECT)
    return f"; square flat sheets up to {square:.2g} wide are strained by {100 * STRAIN:g} % at most, long ones up to {strip:.2g}"


def _head(problem: CGCProblem) -> str:
    name, units, tolerance = problem.drawing[:3]
    if units is not None and tolerance is not None:
        return f"{name}: {units}, tolerance {tolerance:g}{unit_suffix(units)}"
    return f"{name}: {len(problem.vertices)} vertices, {len(problem.faces)} faces, {len(problem.supports)} supports"
