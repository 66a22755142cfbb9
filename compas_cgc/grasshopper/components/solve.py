"""Solve: the surface that has the curvature asked for, without ever blocking the canvas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import field
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...errors import CGCError
from ...errors import ProblemError
from ...io.rhino.rhinocommon import mesh_from_arrays
from ..runtime.address import Address
from ..runtime.background import Work
from ..runtime.component_feedback import error
from ..runtime.component_feedback import items
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import run_again
from ..runtime.component_feedback import say
from ..runtime.component_feedback import warn
from ..runtime.local_solve import Question
from ..runtime.local_solve import Solved
from ..runtime.local_solve import local_job
from ..runtime.remote_solve import remote_job

__all__ = ["SolveOutputs", "solve"]

POLL = 200  # [ms]


class SolveOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    cgc_mesh: Any = None
    status: Optional[str] = None
    progress: Optional[float] = None
    report: Optional[str] = None
    result: Optional[Solved] = None


@dataclass
class Memory:
    """What a component on the canvas remembers from one run to the next."""

    question: Optional[Question] = None  # the latest one that was asked
    fingerprint: str = ""
    work: Optional[Work] = None
    answered: str = ""  # fingerprint of the question that `refusal` or `shown` answers
    refusal: Optional[Exception] = None
    shown: SolveOutputs = field(default_factory=SolveOutputs)

    def ask(self, question: Question) -> None:
        """Take note of a question; work on another one is cancelled."""
        known = self.question
        # On most runs nothing is new, and comparing objects costs nothing.
        if known is not None and known.is_same(question):
            return
        fingerprint = question.fingerprint()
        self.question = question
        if fingerprint != self.fingerprint:
            self.cancel()
            self.fingerprint = fingerprint

    def cancel(self) -> None:
        """Cancel what is being worked on."""
        if self.work is not None:
            self.work.cancel()
        self.work = None

    def collect(self) -> None:
        """Take over the outcome of work that has ended."""
        work, self.work = self.work, None
        self.answered, self.refusal = self.fingerprint, work.refusal
        if work.refusal is None:
            self.shown = _shown(work.outcome)


_MEMORIES: dict[str, Memory] = {}


@reporting(SolveOutputs)
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
        say(component, "reset")
        return SolveOutputs()
    if cgc_mesh is None:
        memory.cancel()
        warn(component, "connect a CGC mesh")
        return memory.shown
    memory.ask(Question(cgc_mesh, settings, tuple(items(constraints)), _address(server)))
    if memory.work is not None and not memory.work.running:
        memory.collect()
    if run and memory.work is None and memory.answered != memory.fingerprint:
        memory.work = Work(_job(memory.question))
    if memory.work is not None:
        return _wait(component, memory, forget)
    return _show(component, memory)


def _address(server: Any) -> Optional[Address]:
    """Return the server of a wire: an address of Server, or a text."""
    return Address(server.strip()) if isinstance(server, str) and server.strip() else server or None


def _job(question: Question) -> Callable:
    return local_job(question) if question.server is None else remote_job(question)


def _wait(component: Any, memory: Memory, forget: Callable[[], None]) -> SolveOutputs:
    progress = memory.work.progress
    reached = "" if progress.max_error is None else f", error {progress.max_error:.1e}"
    say(component, "waiting" if progress.note else f"step {progress.step}{reached}")
    if progress.note:
        warn(component, progress.note)
    run_again(component, POLL, forget)
    return memory.shown._replace(status="running", progress=progress.part)


def _show(component: Any, memory: Memory) -> SolveOutputs:
    """Put out what is known, with a balloon where it is not what was asked for."""
    if memory.answered != memory.fingerprint:
        say(component, "set run to true")
        return memory.shown._replace(status="waiting" if memory.shown.mesh is None else "out of date")
    if memory.refusal is not None:
        if not isinstance(memory.refusal, (CGCError, ValueError, OSError)):
            raise memory.refusal
        sentences = memory.refusal.problems if isinstance(memory.refusal, ProblemError) else [memory.refusal]
        for sentence in sentences:
            error(component, str(sentence))
        say(component, "refused")
        return SolveOutputs(status="refused", progress=0.0)
    solved = memory.shown.result
    say(component, solved.status.replace("_", " "))
    if solved.status in ("infeasible", "diverged"):
        error(component, solved.message)
    elif solved.status != "converged":
        warn(component, solved.message)
    return memory.shown


def _shown(solved: Solved) -> SolveOutputs:
    return SolveOutputs(mesh_from_arrays(*solved.mesh.arrays()), solved.mesh, solved.status, 1.0, solved.report, solved)
