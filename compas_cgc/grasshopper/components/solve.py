"""Solve: the surface that has the curvature asked for, without ever blocking the canvas."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import field
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...analysis import analyse
from ...datastructures import CGCMesh
from ...datastructures import SolveResult
from ...errors import CGCError
from ...errors import ProblemError
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...model.constraint_data import as_constraints
from ...model.constraint_data import constraint_data
from ...model.constraints import Constraint
from ...solvers import Settings
from ..runtime.address import Address
from ..runtime.background import BackgroundTask
from ..runtime.component_feedback import add_error
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import poll
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.local_solve import local_solve
from ..runtime.progress import Progress
from ..runtime.progress import Report
from ..runtime.remote_solve import remote_solve

__all__ = ["SolveOutputs", "solve"]

POLL_INTERVAL = 200  # [ms]
BAR = 10  # characters


class SolveOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    cgc_mesh: Optional[CGCMesh] = None
    status: Optional[str] = None
    progress: Optional[float] = None
    report: Optional[str] = None
    result: Optional[SolveResult] = None


def fingerprint(mesh: CGCMesh, settings: Optional[Settings], server: Optional[Address], *constraints: Constraint) -> str:
    """Return the same text for equal inputs, whatever objects they are made of."""
    held = [[constraint_data(one) for one in own] for own in (mesh.constraints(), constraints)]
    parts = (mesh.default_vertex_attributes, mesh.vertex, mesh.face, mesh.crease_edges(), held, settings, server)
    return hashlib.sha1(repr(parts).encode("utf-8")).hexdigest()


@dataclass
class Memory:
    """What a component on the canvas remembers from one run to the next."""

    inputs: tuple = ()  # the latest ones: mesh, settings, server, constraints
    fingerprint: str = ""  # theirs
    task: Optional[BackgroundTask[SolveOutputs]] = None
    answered: str = ""  # fingerprint of the inputs that `error` or `shown` answers
    error: Optional[Exception] = None
    shown: SolveOutputs = field(default_factory=SolveOutputs)

    def take(self, inputs: tuple) -> None:
        """Take note of inputs; a solve of other ones is cancelled."""
        # On most runs nothing is new, and comparing objects costs nothing.
        if len(inputs) == len(self.inputs) and all(map(_same, inputs, self.inputs)):
            return
        self.inputs, known = inputs, self.fingerprint
        self.fingerprint = fingerprint(*inputs)
        if self.fingerprint != known:
            self.cancel()

    def cancel(self) -> None:
        """Cancel the solve that runs."""
        if self.task is not None:
            self.task.cancel()
        self.task = None

    def collect(self, task: BackgroundTask[SolveOutputs]) -> None:
        """Take over the result of a solve that has ended."""
        self.task = None
        self.answered, self.error = self.fingerprint, task.error
        if task.result is not None and task.result.cgc_mesh is not None:
            # Only here, as Rhino's meshes are made in its own thread.
            self.shown = task.result._replace(mesh=mesh_from_arrays(*task.result.cgc_mesh.arrays()))


_MEMORIES: dict[str, Memory] = {}


@reports_errors(SolveOutputs)
def solve(
    component: Any, cgc_mesh: Any, settings: Any, constraints: Any, run: Optional[bool], reset: Optional[bool], server: Any
) -> SolveOutputs:
    """Solve in the background when `run` is set and the inputs are new; the last result stays until the next one is there."""
    # Several meshes on one wire make several runs in one solution, each with a memory of its own.
    name = f"{component.InstanceGuid}/{getattr(component, 'RunCount', 1)}"
    memory = _MEMORIES.setdefault(name, Memory())

    def forget() -> None:
        memory.cancel()
        _MEMORIES.pop(name, None)

    if reset:
        forget()
        set_message(component, "reset")
        return SolveOutputs()
    if cgc_mesh is None:
        memory.cancel()
        add_warning(component, "connect a CGC mesh")
        return memory.shown
    inputs = (cgc_mesh, settings, _address(server), *as_constraints(as_list(constraints)))
    memory.take(inputs)
    if memory.task is not None and not memory.task.running:
        memory.collect(memory.task)
    if not run:
        memory.cancel()
    if run and memory.task is None and memory.answered != memory.fingerprint:
        memory.task = BackgroundTask(_solving(*inputs))
    if memory.task is not None:
        return _wait(component, memory, memory.task, forget)
    return _show(component, memory)


def _same(one: object, other: object) -> bool:
    return one is other or (isinstance(one, Address) and one == other)


def _address(server: Any) -> Optional[Address]:
    """Return the server of a wire: an address of Server, or a text."""
    if isinstance(server, str):
        url = server.strip()
        return Address(url if "://" in url else f"http://{url}") if url else None
    return server


def _solving(
    mesh: CGCMesh, settings: Optional[Settings], server: Optional[Address], *constraints: Constraint
) -> Callable[[Report], SolveOutputs]:
    """Return a function that solves and measures the surface, for a background task."""
    run = local_solve(mesh, settings, constraints) if server is None else remote_solve(mesh, settings, constraints, server)

    def solved(report: Report) -> SolveOutputs:
        result = run(report)
        told, figures = str(analyse(result, mesh)).split("\n", 1)
        return SolveOutputs(None, result.mesh, result.status, 1.0, f"{told}\n{result.message}\n{figures}", result)

    return solved


def _wait(component: Any, memory: Memory, task: BackgroundTask[SolveOutputs], forget: Callable[[], None]) -> SolveOutputs:
    progress = task.progress
    set_message(component, _reached(progress))
    if progress.note:
        add_warning(component, progress.note)

    def is_over() -> bool:
        set_message(component, _reached(task.progress))
        # A balloon comes and goes with a run of the component.
        return not task.running or task.progress.note != progress.note

    poll(component, POLL_INTERVAL, is_over, forget)
    return memory.shown._replace(status="running", progress=progress.part)


def _reached(progress: Progress) -> str:
    if progress.note:
        return "waiting"
    if progress.compiling is not None:
        filled = round(BAR * progress.compiling)
        return f"compiling, once [{'#' * filled}{'.' * (BAR - filled)}]"
    return f"step {progress.step}" + ("" if progress.max_error is None else f", error {progress.max_error:.1e}")


def _show(component: Any, memory: Memory) -> SolveOutputs:
    """Put out what is known, with a balloon where it does not answer the inputs."""
    if memory.answered != memory.fingerprint:
        set_message(component, "set run to true")
        return memory.shown._replace(status="waiting" if memory.shown.mesh is None else "out of date")
    if memory.error is not None:
        return _refused(component, memory.error)
    result = memory.shown.result
    if result is not None:
        set_message(component, result.status.replace("_", " "))
        if result.status in ("infeasible", "diverged"):
            add_error(component, result.message)
        elif not result.converged:
            add_warning(component, result.message)
        elif result.verdict is not None and not result.verdict.fair:
            set_message(component, "rough")
            add_warning(component, f"K is as asked, but the surface is {result.verdict}")
    return memory.shown


def _refused(component: Any, error: Exception) -> SolveOutputs:
    """Show what is wrong with the inputs; a fault of the program is not hidden."""
    if not isinstance(error, (CGCError, ValueError, OSError)):
        raise error
    for sentence in error.problems if isinstance(error, ProblemError) else [error]:
        add_error(component, str(sentence))
    set_message(component, "refused")
    return SolveOutputs(status="refused", progress=0.0)
