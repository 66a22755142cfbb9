"""Solve: the surface with the target curvature, without blocking the canvas."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...analysis import analyse
from ...datastructures import SolveResult
from ...discrete.arrays import FloatArray
from ...errors import CGCError
from ...errors import ProblemError
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...model.constraint_data import as_goals
from ...model.constraints import Constraint
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ...model.result import FAILED
from ...scene.figures import FIGURES
from ...solvers import Settings
from ..runtime.address import Address
from ..runtime.colour_legend import check_figure
from ..runtime.colour_legend import figure_colours
from ..runtime.component_feedback import add_error
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.headless import is_headless
from ..runtime.local_solve import local_solve
from ..runtime.measured import measure
from ..runtime.progress import Progress
from ..runtime.progress import Report
from ..runtime.remote_solve import remote_solve
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner
from ..runtime.saved import problem_from_text
from ..runtime.saved import problem_to_text
from ..runtime.widgets import offer_values
from ..runtime.wire_mesh import WireMesh

__all__ = ["SolveOutputs", "solve"]


class SolveOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    cgc_mesh: Optional[WireMesh] = None
    status: Optional[str] = None
    progress: Optional[float] = None
    report: Optional[str] = None
    result: Optional[SolveResult] = None
    colours: Optional[list] = None
    legend: Optional[list[str]] = None


class _Found(NamedTuple):
    """What a solve has found."""

    problem: CGCProblem
    status: str
    report: str
    message: str  # text below the component
    balloons: tuple[tuple[str, str], ...]
    result: Optional[SolveResult] = None  # None for what comes from the file of the definition

    def to_text(self) -> str:
        """Return the text for the file of the definition."""
        return json.dumps({**self._asdict(), "problem": problem_to_text(self.problem), "result": None})

    @classmethod
    def from_text(cls, text: str) -> _Found:
        """Return what is in the file of the definition."""
        data = json.loads(text)
        balloons = tuple((level, sentence) for level, sentence in data["balloons"])
        return cls(**{**data, "problem": problem_from_text(data["problem"]), "balloons": balloons})

    def plain(self) -> SolveOutputs:
        """Return the outputs without colours."""
        mesh = mesh_from_arrays(self.problem.vertices, self.problem.faces)
        return SolveOutputs(mesh, WireMesh(self.problem), self.status, 1.0, self.report or None, self.result)


def _restored(text: str) -> Finished:
    found = _Found.from_text(text)
    return Finished(found.plain(), found.message, found.balloons, found)


_RUNNER = Runner(SolveOutputs(), "solving", _restored)


@reports_errors(SolveOutputs)
def solve(
    component: Any,
    cgc_mesh: Any,
    settings: Any,
    goals: Any,
    run: Optional[bool],
    reset: Optional[bool],
    server: Any,
    show: Optional[str] = None,
    wait: Optional[bool] = None,
) -> SolveOutputs:
    """Solve in the background if `run` is true and the inputs are new; the last result is shown until the next one is available.

    If `wait` is true, and in headless documents, the component returns when the surface has been solved and measured.
    """
    offer_values(component, "show", FIGURES)
    if reset:
        _RUNNER.reset(component)
        set_message(component, "reset")
        return SolveOutputs()
    if cgc_mesh is None:
        ask_for(component, "a CGC mesh")
        return _RUNNER.pause(component)
    figure = show.strip() if show else FIGURES[0]
    check_figure(figure)
    inputs = (cgc_mesh, settings, _address(server), *as_goals(as_list(goals)))

    def work(report: Report, last: Last) -> Finished:
        return _solved(report, last, cgc_mesh, inputs[1], inputs[2], inputs[3:], figure)

    try:
        shown = _RUNNER.outputs(component, inputs, work, (figure,), run=bool(run), wait=bool(wait), brief=False)
    except (CGCError, ValueError, OSError) as error:
        for sentence in error.problems if isinstance(error, ProblemError) else [error]:
            add_error(component, str(sentence))
        set_message(component, "refused")
        return SolveOutputs(status="refused", progress=0.0)
    out = shown.outputs
    if not run and out.mesh is None and is_headless(component):
        add_error(component, "run is False, so that there is no surface; set run to True")
    if shown.state == "running":
        return out._replace(status="running", progress=shown.progress.part)
    if shown.state == "waiting":
        return out._replace(status="waiting" if out.mesh is None else "out of date")
    return out


def _address(server: Any) -> Optional[Address]:
    """Return the server from a wire: an address of Server, or a text."""
    if isinstance(server, str):
        return Address.from_text(server) if server.strip() else None
    return server


def _solved(
    report: Report,
    last: Last,
    mesh: PosesProblem,
    settings: Optional[Settings],
    server: Optional[Address],
    goals: Sequence[Constraint],
    figure: str,
) -> Finished:
    """Solve and measure; the surface is shown before it is measured."""
    if last.current:
        found = last.value
    else:
        faces = mesh.to_problem().without_dummies().faces

        def show(vertices: FloatArray) -> dict[str, Any]:
            return {"mesh": mesh_from_arrays(vertices, faces)}

        drawn = None if last.value is None else last.value.problem
        run = remote_solve(mesh, settings, goals, server) if server else local_solve(mesh, settings, goals, drawn, show)
        result = run(report)
        found = _Found(result.problem, result.status, "", *_verdict(result), result)
        plain = found.plain()._asdict()
        report(Progress(part=1.0, task="measuring", preview=lambda: plain))
        figures = str(analyse(result, mesh)).split("\n", 1)[1]
        found = found._replace(report=f"{result.summary}\n{result.ending}\n{figures}")
    colours = figure_colours(measure(found.problem).figures, figure)
    surface = mesh_from_arrays(found.problem.vertices, found.problem.faces, colours.vertices)
    out = found.plain()._replace(mesh=surface, colours=colours.colours, legend=colours.legend)
    return Finished(out, found.message, found.balloons, found, "" if last.current else found.to_text())


def _verdict(result: SolveResult) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Return the message and the balloons of a result."""
    message = result.status.replace("_", " ")
    if result.status in FAILED:
        return message, (("Error", result.message),)
    if not result.converged:
        return message, (("Warning", result.message),)
    if not result.verdict.fair:
        return "rough", (("Warning", f"K equals its target, but the surface is {result.verdict}"),)
    return message, ()
