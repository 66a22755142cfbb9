"""What the workers do: solve a request, and tell how far it is."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from ..errors import CGCError
from .arrays import read_json
from .limits import Limits
from .outcome import Outcome
from .outcome import pack
from .problems import RequestProblem
from .request import Asked
from .request import read_asked
from .request import read_request
from .worker import report
from .worker import stop_wanted

if TYPE_CHECKING:
    from ..datastructures import CGCMesh
    from ..result import SolveState

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


def solve_job(kind: str, options: dict, body: bytes) -> Outcome:
    """Solve a request.

    Parameters
    ----------
    kind
        ``"json"``, ``"hops"``, ``"3dm"`` or ``"obj"``.
    options
        What a file cannot say.
    body
        The request.
    """
    from ..analysis import analyse
    from ..solver import solve

    report({"step": 0})
    try:
        mesh, asked, notes = _read(kind, options, body)
        asked.put_on(mesh)
        result = solve(mesh, asked.method, asked.method_settings(), callback=Progress(asked.live))
    except (CGCError, RequestProblem, ValueError) as error:
        return Outcome(str(error), None)
    if not np.isfinite(result.mesh.arrays()[0]).all():
        return Outcome("the solve ended with coordinates that are no numbers; check the scale of the mesh and its targets", None)
    if result.status == "cancelled":
        # Who cancels does not want to wait for an analysis.
        return Outcome(result.message, pack(result, {"notes": notes}))
    remarks = [] if result.converged else [str(problem) for problem in mesh.check()]
    findings = {"notes": [*notes, *remarks], **analyse(result.mesh, mesh).to_dict()}
    return Outcome(result.message, pack(result, findings))


def _read(kind: str, options: dict, body: bytes) -> tuple[CGCMesh, Asked, list[str]]:
    limits = Limits()
    if kind == "json":
        return (*read_request(read_json(body, limits), limits), [])
    if kind == "hops":
        from .hops.catalogue import ENDPOINTS
        from .hops.problem import solve_problem
        from .hops.values import read_values

        request = read_json(body, limits)
        return solve_problem(read_values(ENDPOINTS["cgc/solve"], request["values"]), request["context"])
    from .uploads import read_upload

    mesh, notes = read_upload(kind, body)
    return mesh, read_asked(options, mesh.number_of_vertices(), limits), notes


def warm_up() -> None:
    """Compile the kernels of all methods on a small mesh, so that the first job does not wait for them."""
    from ..analysis import analyse
    from ..datastructures import CGCMesh
    from ..methods import METHODS
    from ..solver import solve

    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    for method in METHODS:
        analyse(solve(mesh, method).mesh)
