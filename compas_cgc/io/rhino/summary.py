"""What ``compas-cgc check`` says about a .3dm file."""

from __future__ import annotations

from ...meshing import Diagnostic
from ...model.checks import check
from ..reading import ReadProblem
from .units import unit_suffix

__all__ = ["describe"]


def describe(read: ReadProblem) -> tuple[str, list[Diagnostic]]:
    """Return what was found in a file and what would be done, and what keeps it from being solved.

    Parameters
    ----------
    read
        What :func:`compas_cgc.io.rhino.read_3dm` gave.

    Returns
    -------
    text, diagnostics
        Those of the file, then those of :func:`compas_cgc.check`, of which some do not keep
        it from being solved.
    """
    problem = read.problem
    name, units, tolerance = problem.drawing
    lines = [f"{name}: {units}, tolerance {tolerance:g}{unit_suffix(units or '')}"]
    lines += [f"- {note}" for note in read.notes]
    targets = problem.region_targets()
    lines.append(f"{len(targets)} region{'s' if len(targets) > 1 else ''}:")
    label = problem.regions()
    for number, K in enumerate(targets):
        faces = problem.faces[label == number]
        place = ", ".join(f"{x:.4g}" for x in problem.vertices[faces].mean(axis=(0, 1)))
        lines.append(f"- region {number} around ({place}): {len(faces)} faces, {'no target' if K is None else f'K = {K:g}'}")
    return "\n".join(lines), [*read.diagnostics, *check(problem)]
