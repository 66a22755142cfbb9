"""What the workers do: solve a request, and tell how far it is."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import RequestProblem
from ..jobs.worker import report
from ..jobs.worker import stop_wanted
from ..limits import Limits
from .decoding import check_size
from .decoding import read_json
from .options import Asked
from .options import read_asked
from .requests import Given
from .requests import given_mesh
from .requests import read_accepted
from .serialization import Outcome
from .serialization import pack

if TYPE_CHECKING:
    from ...model.result import SolveState

__all__ = ["Progress", "solve_job", "warm_up"]

INTERVAL = 0.1  # seconds between two reports


class Progress:
    """A callback for solves that reports at most ten times a second and stops when that is wanted.

    Parameters
    ----------
    live
        Report the moving vertices too.
    """

    def __init__(self, live: bool = False):
        self.live = live
        self.last = 0.0

    def __call__(self, state: SolveState) -> bool:
        """Report a state; tell whether to stop."""
        now = time.monotonic()
        if now - self.last >= INTERVAL:
            self.last = now
            figures = {name: getattr(state, name) for name in ("step", "steps", "energy", "error_norm", "max_error", "seconds")}
            news: dict = {name: value if math.isfinite(value) else None for name, value in figures.items()}
            if self.live:
                news["surface"] = state.vertices.astype("<f4").tobytes()
            report(news)
        return stop_wanted()


def solve_job(kind: str, options: dict, body: bytes, limits: Limits) -> Outcome:
    """Solve a request.

    Parameters
    ----------
    kind
        ``"arrays"``, ``"compas"``, ``"hops"``, ``"3dm"`` or ``"obj"``.
    options
        What a file cannot say.
    body
        The request, accepted.
    limits
        Those of the server.
    """
    from ...analysis import analyse_problem
    from ...model.checks import check
    from ...solvers.solve import solve_problem

    report({"step": 0})
    try:
        given, asked = _read(kind, options, body, limits)
        problem = asked.put_on(given.problem, given.names)
        constraints = (*given.constraints, *asked.constraints)
        solution = solve_problem(problem, asked.method, asked.method_settings(), Progress(asked.live), constraints, given.names)
    except (RequestProblem, ValueError) as error:
        return Outcome(str(error), None)
    if not np.isfinite(solution.vertices).all():
        return Outcome("the solve ended with coordinates that are no numbers; check the scale of the mesh and its targets", None)
    findings: dict = {"notes": list(given.notes)}
    # Who cancels does not want to wait for an analysis.
    if solution.status != "cancelled":
        if solution.status != "converged":
            findings["notes"] += [str(said) for said in check(problem, given.names)]
        findings.update(analyse_problem(replace(problem, vertices=solution.vertices), problem.without_dummies().vertices).to_dict())
    content = pack(problem, given.names, given.name, solution, findings)
    return Outcome(solution.message, content, solution.status == "cancelled")


def _read(kind: str, options: dict, body: bytes, limits: Limits) -> tuple[Given, Asked]:
    if kind in ("arrays", "compas"):
        return read_accepted(kind, body, limits)
    if kind == "hops":
        from ..hops.data_tree import read_values
        from ..hops.endpoints import ENDPOINTS
        from ..hops.inputs import given_with_targets

        request = read_json(body, limits)
        return given_with_targets(read_values(ENDPOINTS["cgc/solve"], request["values"]), {**request["context"], "limits": limits})
    from .mesh_files import read_upload

    mesh, notes = read_upload(kind, body)
    check_size(mesh.number_of_vertices(), mesh.number_of_faces(), limits)
    return given_mesh(mesh, notes), read_asked(options, mesh.number_of_vertices(), limits)


def warm_up() -> None:
    """Compile the kernels of all methods on a small mesh, so that the first job does not wait for them."""
    from ...analysis import analyse
    from ...datastructures import CGCMesh
    from ...solvers.registry import METHODS
    from ...solvers.solve import solve

    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    for method in METHODS:
        analyse(solve(mesh, method).mesh)
