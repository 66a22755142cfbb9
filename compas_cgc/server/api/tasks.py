"""Tasks of the workers: solve a request, and tell how far it is."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

import numpy as np

from ...analysis import analyse
from ...datastructures import SolveResult
from ...execution.worker import report
from ...execution.worker import stop_wanted
from ...fabrication.tasks import TASKS
from ...model.checks import check
from ...model.result import SolveState
from ...solvers.registry import method_of
from ...solvers.run import solve
from ..errors import Gone
from ..errors import RequestError
from ..jobs.output import JobOutput
from ..limits import Limits
from .builds import SOLVE
from .builds import built
from .last_surface import gone_on
from .requests import READERS
from .requests import SOLVED_READERS
from .requests import Reader
from .requests import SolveRequest
from .serialization import pack_result
from .wording import in_request_words

__all__ = ["Progress", "run_request", "solve_job"]

INTERVAL = 0.1  # seconds between two reports
FIGURES = ("step", "steps", "energy", "error_norm", "max_error", "seconds")


class Progress:
    """A callback for solves that reports at most ten times a second and stops when that is wanted.

    Parameters
    ----------
    live
        Report the moving vertices too.
    """

    def __init__(self, live: bool = False):
        self.live = live
        # What is over within the first interval is told once, in the end.
        self.last = time.monotonic()
        self.news: dict = {"step": 0}

    def __call__(self, state: SolveState) -> bool:
        """Report a state; tell whether to stop."""
        now = time.monotonic()
        if now - self.last >= INTERVAL:
            self.last = now
            self.news = _finite({name: getattr(state, name) for name in FIGURES})
            report({**self.news, "surface": state.vertices.astype("<f4").tobytes()} if self.live else self.news)
        return stop_wanted()

    def arrived(self, vertices: np.ndarray) -> None:
        """Report a surface that meets its targets: who watches sees it while it is judged."""
        if self.live:
            report({**self.news, "arrived": vertices.astype("<f8").tobytes()})

    def judged(self, result: SolveResult) -> None:
        """Report what is said of a surface: who watches reads it while it is measured and packed."""
        if self.live and result.verdict is not None:
            verdict = {"fair": result.verdict.fair, "reasons": list(result.verdict.reasons)}
            report({**_figures(result), "judged": {"status": result.status, "message": result.message, "ending": result.ending, **verdict}})


def run_request(request: SolveRequest) -> SolveResult:
    """Solve a request and report on the way; on from the last surface with the methods that go on from one."""
    method = request.method if request.settings is None else method_of(request.settings)
    problem = gone_on(request.problem, request.last if method in ("auto", "projection") else None)
    progress = Progress(request.live)
    result = solve(problem, method=request.method, settings=request.settings, callback=progress)
    if result.converged:
        progress.judged(result)
    return result


def solve_job(kind: str, options: dict, body: bytes, limits: Limits, readers: Mapping[str, Reader] = READERS) -> JobOutput:
    """Solve a request.

    Parameters
    ----------
    kind
        What the body is, one of the readers.
    options
        What a file cannot say.
    body
        The request, accepted.
    limits
        Those of the server.
    readers
        Make a request of options, body and limits, by kind.
    """
    if options.get("task", SOLVE) != SOLVE:
        return _build_job(kind, options, body, limits)
    report({"step": 0})
    try:
        if kind not in readers:
            raise Gone("the request was stored by another version of the server; submit the job again")
        request = readers[kind](options, body, limits)
        result = run_request(request)
    except (RequestError, ValueError) as error:
        return JobOutput(in_request_words(error))
    return JobOutput(result.message, pack_result(result, _report(request, result)), result.status == "cancelled", _figures(result))


def _build_job(kind: str, options: dict, body: bytes, limits: Limits) -> JobOutput:
    """Make something of a solved surface, or look for its limits."""
    task, rest = options["task"], {name: value for name, value in options.items() if name not in ("task", "settings")}
    report({"task": task, "stage": "read", "step": 0})
    readers: Mapping[str, Reader] = SOLVED_READERS if task in TASKS else READERS
    try:
        request = readers[kind](rest, body, limits)
        message, content = built(task, request.problem, options.get("settings") or {}, list(request.notes))
    except (RequestError, ValueError) as error:
        return JobOutput(in_request_words(error))
    return JobOutput(message, content)


def _figures(result: SolveResult) -> dict:
    """Return what a report would tell of the last step."""
    history = result.history
    last = {"energy": history.energy, "error_norm": history.error_norm}
    figures = {name: float(values[-1]) for name, values in last.items() if len(values)}
    figures.update(step=result.iterations, max_error=result.max_error, seconds=result.seconds)
    return _finite(figures)


def _finite(figures: dict) -> dict:
    """Return figures with None for those that are no number of JSON."""
    return {name: value if math.isfinite(value) else None for name, value in figures.items()}


def _report(request: SolveRequest, result: SolveResult) -> dict:
    """Return the notes on a request and the analysis of its result; who cancels does not want to wait for one."""
    notes = list(request.notes)
    if result.status == "cancelled":
        return {"notes": notes}
    if not result.converged:
        notes += [in_request_words(said) for said in check(request.problem)]
    # Whoever watches a surface move waits for it.
    report = analyse(result, request.problem, others=not request.live)
    if result.converged and not report.verdict.fair:
        notes.insert(0, f"the surface is {report.verdict}")
    return {"notes": notes, **report.to_dict()}
