"""STEP files: the regions of a result as trimmed NURBS faces of one shell, through OpenCASCADE."""

from __future__ import annotations

from ..fabrication.shell.regions import region_surfaces
from ..model.counts import counted
from ..model.problem import CGCProblem
from ..model.units import METRES
from .occt import SHELL
from .occt import opencascade
from .opencascade import shell_of
from .opencascade import step_content

__all__ = ["step_bytes"]


def step_bytes(problem: CGCProblem) -> tuple[bytes, list[str]]:
    """Return a STEP file in millimetres with one shell of all regions, and notes on its accuracy.

    Parameters
    ----------
    problem
        A solved problem; its units are metres by default.

    Raises
    ------
    MeshError
        If the surfaces do not meet their tolerances, see :func:`compas_cgc.fabrication.shell.regions.region_surfaces`, or if the faces do
        not make one valid shell.
    FileError
        If the package that writes STEP files is not installed.
    """
    occt = opencascade()
    fit = region_surfaces(problem)
    factor = 1e3 * METRES.get(problem.drawing.units or "Meters", 1.0)
    shell, order = shell_of(occt, fit, lambda points: factor * fit.scale * points)
    content = step_content(shell, problem.drawing.name or "compas_cgc", [f"region {number}" for number in order], factor * fit.centre)
    shells = len(occt.shape_explore(shell, SHELL))
    faces = f"{counted(len(fit.pieces), 'face')} in {'one shell' if shells == 1 else f'{shells} shells'}, "
    return content, [fit.note(fit.percentiles(), factor, " mm", faces)]
