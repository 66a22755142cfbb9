"""Tasks of the workers: solve a request and report progress."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING
from typing import Union

import numpy as np

from ...analysis import analyse
from ...datastructures import SolveResult
from ...execution.worker import report
from ...execution.worker import stop_wanted
from ...fabrication.tasks import TASKS
from ...model.checks import check
from ...model.problem import CGCProblem
from ...model.result import FAILED
from ...model.result import SolveState
from ...solvers.registry import method_of
from ...solvers.run import solve
from ..errors import Gone
from ..errors import RequestError
from ..jobs.output import JobOutput
from ..limits import Limits
from .builds import SOLVE
from .builds import built
from .design_files import DESIGN_KINDS
from .design_files import read_design_file
from .last_surface import gone_on
from .remedies import remedies_in
from .remedies import remedies_of
from .requests import READERS
from .requests import SOLVED_READERS
from .requests import Reader
from .requests import SolveRequest
from .searches import SEARCHES
from .serialization import pack_result
from .wording import in_request_words

if TYPE_CHECKING:
    from ...rationalisation.design import GivenDesign

__all__ = ["Progress", "run_request", "solve_job"]

INTERVAL = 0.1  # time between two progress reports [s]
FIGURES = ("step", "steps", "energy", "error_norm", "max_error", "seconds")


class Progress:
    """Callback of a solve that reports progress at most ten times a second and stops on request.

    Parameters
    ----------
    live
        Whether to report the vertices too.
    """

    def __init__(self, live: bool = False):
        self.live = live
        # A solve shorter than the first interval reports once, at the end.
        self.last = time.monotonic()
        self.news: dict = {"step": 0}

    def __call__(self, state: SolveState) -> bool:
        """Report a state; return whether to stop."""
        now = time.monotonic()
        if now - self.last >= INTERVAL:
            self.last = now
            self.news = _finite({name: getattr(state, name) for name in FIGURES})
            report({**self.news, "surface": state.vertices.astype("<f4").tobytes()} if self.live else self.news)
        return stop_wanted()

    def arrived(self, vertices: np.ndarray) -> None:
        """Report the solved surface before its verdict is computed."""
        if self.live:
            report({**self.news, "arrived": vertices.astype("<f8").tobytes()})

    def judged(self, result: SolveResult) -> None:
        """Report the verdict before the surface is measured and packed."""
        if self.live and result.status not in FAILED:
            verdict = {"fair": result.verdict.fair, "reasons": list(result.verdict.reasons)}
            report({**_figures(result), "judged": {"status": result.status, "message": result.message, "ending": result.ending, **verdict}})


def run_request(request: SolveRequest) -> SolveResult:
    """Solve a request and report progress; methods that support it start from the last surface."""
    method = request.method if request.settings is None else method_of(request.settings)
    problem = gone_on(request.problem, request.last if method in ("auto", "bending", "projection") else None)
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
        Format of the body, one of the readers.
    options
        Options that a file cannot hold.
    body
        The checked request.
    limits
        Limits of the server.
    readers
        Functions by format that decode options, body and limits to a request.
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
        return _refused(error)
    return JobOutput(result.message, pack_result(result, _report(request, result)), result.status == "cancelled", _figures(result))


def _build_job(kind: str, options: dict, body: bytes, limits: Limits) -> JobOutput:
    """Run a task on a solved surface, or search for its limits."""
    task, rest = options["task"], {name: value for name, value in options.items() if name not in ("task", "settings")}
    report({"task": task, "stage": "read", "step": 0})
    try:
        subject, notes = _subject(task, kind, rest, body, limits)
        message, content = built(task, subject, options.get("settings") or {}, notes)
    except (RequestError, ValueError) as error:
        return _refused(error)
    return JobOutput(message, content)


def _subject(task: str, kind: str, options: dict, body: bytes, limits: Limits) -> tuple[Union[CGCProblem, GivenDesign], list[str]]:
    """Return the surface or design of a task, and notes on it."""
    if task in SEARCHES and SEARCHES[task].of_designs and kind in DESIGN_KINDS:
        return read_design_file(kind, body, options, limits), []
    readers: Mapping[str, Reader] = SOLVED_READERS if task in TASKS else READERS
    request = readers[kind](options, body, limits)
    return request.problem, list(request.notes)


def _refused(error: Exception) -> JobOutput:
    """Return the output of a task that was refused, with the remedies of the refusal."""
    said = in_request_words(error)
    return JobOutput(said, figures={"remedies": remedies_in([said])})


def _figures(result: SolveResult) -> dict:
    """Return the figures of the last step, as in a progress report."""
    history = result.history
    last = {"energy": history.energy, "error_norm": history.error_norm}
    figures = {name: float(values[-1]) for name, values in last.items() if len(values)}
    figures.update(step=result.iterations, max_error=result.max_error, seconds=result.seconds)
    return _finite(figures)


def _finite(figures: dict) -> dict:
    """Return figures with None for NaN and infinity, which JSON lacks."""
    return {name: value if math.isfinite(value) else None for name, value in figures.items()}


def _report(request: SolveRequest, result: SolveResult) -> dict:
    """Return the notes on a request and the analysis of its result; a cancelled job is not analysed."""
    notes = list(request.notes)
    if result.status == "cancelled":
        return {"notes": notes}
    if not result.converged:
        notes += [in_request_words(said) for said in check(request.problem)]
    # Live clients wait for the result: skip the other measures.
    report = analyse(result, request.problem, others=not request.live)
    if result.converged and not report.verdict.fair:
        notes.insert(0, f"the surface is {report.verdict}")
    if result.converged and report.verdict.fair:
        return {"notes": notes, **report.to_dict()}
    return {"notes": notes, "remedies": remedies_of(request.problem, result, check(request.problem)), **report.to_dict()}
