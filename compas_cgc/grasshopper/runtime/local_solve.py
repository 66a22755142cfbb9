"""Local solve: in this process, with progress reports and intermediate surfaces."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import replace
from typing import Optional

from ...datastructures import CGCMesh
from ...datastructures import SolveResult
from ...discrete.arrays import FloatArray
from ...model.constraints import Constraint
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ...model.result import SolveState
from ...solvers import Settings
from ...solvers import solve
from ...solvers.continued import steps_towards
from ...solvers.registry import method_of
from .progress import ProgressMeter
from .progress import Report

__all__ = ["local_solve"]

FIRST_STEPS = 2  # steps from the last surface towards that of other targets, for the display


def local_solve(
    mesh: PosesProblem,
    settings: Optional[Settings] = None,
    goals: Sequence[Constraint] = (),
    last: Optional[CGCProblem] = None,
    show: Callable[[FloatArray], object] = lambda vertices: None,
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
    last
        Problem of a result for other targets. Some steps from its surface are displayed first; the result does not depend on it.
    show
        Returns intermediate outputs for the vertices (n, 3) [L] of an intermediate surface without dummies.
    """

    def run(report: Report) -> SolveResult:
        problem = mesh.to_problem()
        meter = ProgressMeter(problem.target_scale)

        def callback(state: SolveState) -> bool:
            return report(meter.at(state.step, state.max_error)._replace(preview=lambda: show(state.vertices)))

        if last is not None:
            steps_towards(problem.with_goals(goals), last, FIRST_STEPS, callback)
        method = "auto" if settings is None else method_of(settings)
        result = solve(problem, method=method, settings=settings, goals=goals, callback=callback)
        return replace(result, drawn=mesh) if isinstance(mesh, CGCMesh) else result

    return run
