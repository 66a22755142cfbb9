"""Local solve: in this process, with progress reports."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import replace
from typing import Optional

from ..._compiled import watch_compilation
from ...datastructures import CGCMesh
from ...datastructures import SolveResult
from ...model.constraints import Constraint
from ...model.problem import PosesProblem
from ...model.result import SolveState
from ...solvers import Settings
from ...solvers import solve
from ...solvers.registry import method_of
from .progress import Progress
from .progress import ProgressMeter
from .progress import Report

__all__ = ["local_solve"]


def local_solve(
    mesh: PosesProblem, settings: Optional[Settings] = None, goals: Sequence[Constraint] = ()
) -> Callable[[Report], SolveResult]:
    """Return a function that solves in this process, for a background task.

    Parameters
    ----------
    mesh
        A mesh with targets and goals; it must not be changed during the solve.
    settings
        Settings of :func:`compas_cgc.solve`.
    goals
        Constraints in addition to those of the mesh.
    """

    def run(report: Report) -> SolveResult:
        problem = mesh.to_problem()
        meter = ProgressMeter(problem.target_scale)

        def callback(state: SolveState) -> bool:
            return report(meter.at(state.step, state.max_error))

        method = "auto" if settings is None else method_of(settings)
        with watch_compilation(lambda state: report(Progress(compiling=state.part))):
            result = solve(problem, method=method, settings=settings, goals=goals, callback=callback)
        return replace(result, drawn=mesh) if isinstance(mesh, CGCMesh) else result

    return run
