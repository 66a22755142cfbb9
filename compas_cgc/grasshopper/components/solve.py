"""Solve: the surface with the target curvature, without blocking the canvas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import field
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._compiled import watch_compilation
from ...analysis import analyse
from ...datastructures import SolveResult
from ...errors import CGCError
from ...errors import ProblemError
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...model.constraint_data import as_goals
from ...model.constraint_data import constraint_data
from ...model.constraints import Constraint
from ...model.problem import PosesProblem
from ...model.result import FAILED
from ...scene.figures import FIGURES
from ...solvers import Settings
from ..runtime.address import Address
from ..runtime.background import BackgroundTask
from ..runtime.colour_legend import check_figure
from ..runtime.colour_legend import figure_colours
from ..runtime.component_feedback import add_error
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import poll
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.headless import is_headless
from ..runtime.local_solve import local_solve
from ..runtime.measured import Measured
from ..runtime.measured import measure
from ..runtime.memories import Memories
from ..runtime.progress import Progress
from ..runtime.progress import Report
from ..runtime.remote_solve import remote_solve
from ..runtime.widgets import offer_values
from ..runtime.wire_mesh import WireMesh
from ..runtime.wire_mesh import problem_fingerprint

__all__ = ["SolveOutputs", "solve"]

POLL_INTERVAL = 200  # [ms]


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


class Measurement(NamedTuple):
    """Measurement of a displayed surface."""

    report: str
    measured: Measured


def fingerprint(mesh: PosesProblem, settings: Optional[Settings], server: Optional[Address], *goals: Constraint) -> str:
    """Return a text that is equal for equal inputs, also of different objects."""
    return repr((problem_fingerprint(mesh), [constraint_data(goal) for goal in goals], settings, server))


@dataclass
class Memory:
    """State of a component between two runs."""

    inputs: tuple = ()  # latest inputs: mesh, settings, server, goals
    fingerprint: str = ""  # of the inputs
    task: Optional[BackgroundTask[SolveResult]] = None
    answered: str = ""  # fingerprint of the inputs of `error` or `shown`
    error: Optional[Exception] = None
    shown: SolveOutputs = field(default_factory=SolveOutputs)
    measuring: Optional[BackgroundTask[Measurement]] = None  # measures the surface that is shown
    measurement: Optional[Measurement] = None
    coloured: str = ""  # quantity shown by the colours

    def take(self, inputs: tuple) -> None:
        """Store the inputs; cancel a solve of other inputs."""
        # Fast path: on most runs the objects are identical.
        if len(inputs) == len(self.inputs) and all(map(_same, inputs, self.inputs)):
            return
        self.inputs, known = inputs, self.fingerprint
        self.fingerprint = fingerprint(*inputs)
        if self.fingerprint != known:
            self.cancel()

    def cancel(self) -> None:
        """Cancel the running solve."""
        if self.task is not None:
            self.task.cancel()
        self.task = None

    def collect(self, task: BackgroundTask[SolveResult], mesh: PosesProblem) -> None:
        """Store the result of a finished solve; its surface is displayed before it is measured."""
        self.task = None
        self.answered, self.error = self.fingerprint, task.error
        result = task.result
        if result is not None:
            # Rhino meshes must be created in Rhino's thread.
            surface = mesh_from_arrays(result.vertices, result.faces)
            self.shown = SolveOutputs(surface, WireMesh(result.problem), result.status, 1.0, None, result)
            self.measurement, self.coloured = None, ""
            self.measuring = BackgroundTask(_measuring(result, mesh))

    def show_measurement(self, show: str) -> None:
        """Store the measurement, and colour the surface by a quantity."""
        if self.measuring is not None and not self.measuring.running:
            ended, self.measuring = self.measuring, None
            if ended.error is not None:
                raise ended.error
            self.measurement = ended.result
        if self.measurement is not None and self.shown.cgc_mesh is not None and self.coloured != show:
            found = figure_colours(self.measurement.measured.figures, show)
            surface = mesh_from_arrays(self.shown.cgc_mesh.problem.vertices, self.shown.cgc_mesh.problem.faces, found.vertices)
            self.shown = self.shown._replace(mesh=surface, report=self.measurement.report, colours=found.colours, legend=found.legend)
            self.coloured = show


_MEMORIES: Memories[Memory] = Memories(Memory.cancel)


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
    headless = is_headless(component)
    offer_values(component, "show", FIGURES)
    if reset:
        _MEMORIES.drop(component)
        set_message(component, "reset")
        return SolveOutputs()
    memory = _MEMORIES.of(component) or _MEMORIES.keep(component, Memory())
    if cgc_mesh is None:
        memory.cancel()
        add_warning(component, "connect a CGC mesh")
        return memory.shown
    figure = show.strip() if show else FIGURES[0]
    check_figure(figure)
    inputs = (cgc_mesh, settings, _address(server), *as_goals(as_list(goals)))
    memory.take(inputs)
    if memory.task is not None and not memory.task.running:
        memory.collect(memory.task, cgc_mesh)
    memory.show_measurement(figure)
    if not run:
        memory.cancel()
    if run and memory.task is None and memory.answered != memory.fingerprint:
        memory.task = BackgroundTask(_solving(*inputs), lambda: component.OnPingDocument() is not None)
    if wait or headless:
        _complete(memory, cgc_mesh, figure)
    if headless and memory.shown.mesh is None and not run:
        add_error(component, "run is False, so that there is no surface; set run to True")
    if memory.task is not None:
        return _wait(component, memory, memory.task)
    if memory.measuring is not None:
        return _wait(component, memory, memory.measuring)
    return _show(component, memory)


def _same(one: object, other: object) -> bool:
    return one is other or (isinstance(one, Address) and one == other)


def _address(server: Any) -> Optional[Address]:
    """Return the server from a wire: an address of Server, or a text."""
    if isinstance(server, str):
        return Address.from_text(server) if server.strip() else None
    return server


def _solving(
    mesh: PosesProblem, settings: Optional[Settings], server: Optional[Address], *goals: Constraint
) -> Callable[[Report], SolveResult]:
    """Return a function that solves, for a background task."""
    return local_solve(mesh, settings, goals) if server is None else remote_solve(mesh, settings, goals, server)


def _measuring(result: SolveResult, mesh: PosesProblem) -> Callable[[Report], Measurement]:
    """Return a function that measures a surface, for a background task."""

    def measured(report: Report) -> Measurement:
        with watch_compilation(lambda state: report(Progress(compiling=state.part))):
            figures = str(analyse(result, mesh)).split("\n", 1)[1]
        return Measurement(f"{result.summary}\n{result.ending}\n{figures}", measure(result.problem)(report))

    return measured


def _complete(memory: Memory, mesh: PosesProblem, show: str) -> None:
    """Wait until the surface is solved and measured."""
    if memory.task is not None:
        memory.task.wait(None)
        memory.collect(memory.task, mesh)
    if memory.measuring is not None:
        memory.measuring.wait(None)
    memory.show_measurement(show)


def _wait(component: Any, memory: Memory, task: BackgroundTask) -> SolveOutputs:
    solving, progress = task is memory.task, task.progress
    reached = Progress.text if solving else Progress.measuring
    set_message(component, reached(progress))
    if progress.note:
        add_warning(component, progress.note)

    def is_over() -> bool:
        set_message(component, reached(task.progress))
        # Balloons are cleared at every run of the component.
        return not task.running or task.progress.note != progress.note

    poll(component, POLL_INTERVAL, is_over, lambda: _MEMORIES.drop_all(component))
    return memory.shown._replace(status="running", progress=progress.part if solving else 1.0)


def _show(component: Any, memory: Memory) -> SolveOutputs:
    """Return the current outputs, with a balloon if they do not belong to the inputs."""
    if memory.answered != memory.fingerprint:
        set_message(component, "set run to true")
        return memory.shown._replace(status="waiting" if memory.shown.mesh is None else "out of date")
    if memory.error is not None:
        return _refused(component, memory.error)
    result = memory.shown.result
    if result is not None:
        set_message(component, result.status.replace("_", " "))
        if result.status in FAILED:
            add_error(component, result.message)
        elif not result.converged:
            add_warning(component, result.message)
        elif not result.verdict.fair:
            set_message(component, "rough")
            add_warning(component, f"K equals its target, but the surface is {result.verdict}")
    return memory.shown


def _refused(component: Any, error: Exception) -> SolveOutputs:
    """Show errors in the inputs as balloons; other errors are raised."""
    if not isinstance(error, (CGCError, ValueError, OSError)):
        raise error
    for sentence in error.problems if isinstance(error, ProblemError) else [error]:
        add_error(component, str(sentence))
    set_message(component, "refused")
    return SolveOutputs(status="refused", progress=0.0)
