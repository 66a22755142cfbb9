"""Runner: the computation of a component in the background, with its latest outputs on the canvas meanwhile."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from typing import Generic
from typing import NamedTuple
from typing import Optional
from typing import TypeVar

from ..._compiled import Compilation
from ..._compiled import is_compiling
from ..._compiled import watch_compilation
from ...errors import CGCError
from .background import BackgroundTask
from .component_feedback import add_balloon
from .component_feedback import add_warning
from .component_feedback import run_later
from .component_feedback import set_message
from .fingerprint import fingerprint
from .headless import is_headless
from .memories import Memories
from .presence import is_present
from .progress import Progress
from .progress import Report
from .saved import Saved
from .saved import delete
from .saved import load
from .saved import save

__all__ = ["Finished", "Last", "Runner", "Shown"]

POLL_INTERVAL = 100  # [ms]
MISSED_POLLS = 2.0  # time without a poll after which polling begins again, as Grasshopper can drop what is scheduled [s]
BRIEF = 0.02  # time for which the canvas waits, so that outputs of short computations do not come a solution later [s]
ESCAPE_INTERVAL = 0.1  # time between two checks of the Escape key while the canvas waits [s]

Outputs = TypeVar("Outputs", bound=tuple)


class Finished(NamedTuple):
    """What a computation returns."""

    outputs: Any
    message: str = ""  # text below the component
    balloons: tuple[tuple[str, str], ...] = ()  # level and text
    value: Any = None  # kept for the next computation
    saved: str = ""  # kept in the file of the definition, if any


class Last(NamedTuple):
    """What was computed last."""

    value: Any = None
    current: bool = False  # whether only inputs for the display have changed since


class Shown(NamedTuple):
    """What a component puts out."""

    outputs: Any
    state: str  # finished, running, or waiting until `run` is true
    progress: Progress


Work = Callable[[Report, Last], Finished]


@dataclass
class _Run:
    """State of one run of a component between two solutions."""

    empty: Any
    shown: Any
    inputs: tuple = ()
    parts: tuple[str, ...] = ()  # fingerprints of the inputs
    task: Optional[BackgroundTask[Finished]] = None
    computed: tuple = ()  # inputs of the task
    answered: tuple = ()  # inputs of `answer` or `error`
    answer: Optional[Finished] = None
    error: Optional[Exception] = None
    last: Any = None
    written: Optional[Finished] = None  # what is in the file

    def take(self, inputs: tuple) -> None:
        """Store the inputs. On most runs the objects are identical, and need no new fingerprint."""
        known = list(zip(self.inputs, self.parts))
        known += [(None, "")] * (len(inputs) - len(known))
        self.parts = tuple(part if part and one is other else fingerprint(one) for one, (other, part) in zip(inputs, known))
        self.inputs = inputs

    def restore(self, answer: Finished, saved: Saved) -> None:
        """Continue with what the file of the definition contains; it is drawn anew where the inputs are the same."""
        self.answer = self.written = answer
        self.shown, self.last = answer.outputs, answer.value
        if saved.is_for(self.parts):
            self.answered = self.parts, None

    def start(self, work: Work, display: tuple, doing: str, wanted: Callable[[], bool]) -> None:
        """Start a computation; one of other inputs is cancelled once it has shown an intermediate result."""
        same = bool(self.answered) and self.answered[0] == self.parts
        before, last = self.task, Last(self.last, same and self.error is None)
        if before is not None:
            before.cancel(replaced=True)
        self.computed = self.parts, display
        self.task = BackgroundTask(lambda report: _computed(work, report, last, doing), wanted, before)

    def cancel(self) -> None:
        """Cancel the computation, and show the last outputs that were computed to the end."""
        if self.task is not None:
            self.task.cancel()
            self.task, self.shown = None, self.empty if self.answer is None else self.answer.outputs

    def collect(self) -> None:
        """Store intermediate outputs, and the outputs of a computation that has ended."""
        task = self.task
        if task is None:
            return
        ended, fields = not task.running, task.take_preview()
        if fields is not None:
            self.shown = self.shown._replace(**fields)
        if ended and task.cancelled:
            self.cancel()
        elif ended:
            self.task, self.answered, self.answer, self.error = None, self.computed, task.result, task.error
            self.shown = self.empty if task.result is None else task.result.outputs
            if task.result is not None:
                self.last = task.result.value


class Runner(Generic[Outputs]):
    """Computations of a kind of component, one at a time for each of its branches.

    New inputs cancel the computation of older ones. It also ends if its branch is deleted, its component is deleted or disabled, its
    cluster is deleted, or its document is closed.

    Parameters
    ----------
    empty
        Outputs until the first ones are computed, and after errors.
    doing
        Text below the component during computations without steps.
    restore
        Returns the outputs and the value of a text that :attr:`Finished.saved` has put into the file of the definition.
    """

    def __init__(self, empty: Outputs, doing: str, restore: Optional[Callable[[str], Finished]] = None):
        self._empty = empty
        self._doing = doing
        self._restore = restore
        self._runs: Memories[_Run] = Memories(_Run.cancel)
        self._polls: list[list[Any]] = []  # components that are polled, and the time of the latest poll [s]

    def outputs(
        self, component: Any, inputs: tuple, work: Work, display: tuple = (), run: bool = True, wait: bool = False, brief: bool = True
    ) -> Shown:
        """Return the latest outputs of a component, and start the computation of newer ones in the background.

        Parameters
        ----------
        component
            The component; it runs again when newer outputs are available.
        inputs
            Values on the wires.
        work
            Computation; its arguments are a callback for progress, and what was computed last. It makes the Rhino geometry, too.
        display
            Further inputs, for the display only.
        run
            Whether to compute new inputs; those for the display are always used.
        wait
            Whether to complete the computation first, as in headless documents.
        brief
            Whether to wait for a short computation.

        Raises
        ------
        Exception
            The error of the computation.
        """
        self._runs.visit(component)
        own = self._runs.of(component)
        if own is None:
            own = self._runs.keep(component, _Run(self._empty, self._empty))
            own.take(inputs)
            saved = None if self._restore is None else load(component)
            if self._restore is not None and saved is not None:
                own.restore(self._restore(saved.text), saved)
        own.take(inputs)
        own.collect()
        key = own.parts, display
        if not (run or (own.answered and own.answered[0] == own.parts)):
            own.cancel()
        elif own.answered != key and (own.task is None or own.computed != key):
            own.start(work, display, self._doing, lambda: is_present(component))
        elif own.answered == key and own.task is not None:
            own.cancel()
        if own.task is not None and (wait or is_headless(component)):
            _wait(own.task)
        elif own.task is not None and brief:
            own.task.wait(BRIEF)
        own.collect()
        if own.answer is not None and own.answer.saved and own.answer is not own.written:
            own.written = own.answer
            save(component, own.answered[0], own.answer.saved)
        if own.task is not None or self._runs.has_unvisited(component):
            self._poll(component)
        if own.task is not None:
            progress = own.task.progress
            set_message(component, progress.text())
            if progress.note:
                add_warning(component, progress.note)
            return Shown(own.shown, "running", progress)
        if own.answered != key:
            set_message(component, "set run to true")
            return Shown(own.shown, "waiting", Progress())
        if own.answer is None:
            raise own.error or RuntimeError("the computation ended without a result")
        set_message(component, own.answer.message)
        for level, text in own.answer.balloons:
            add_balloon(component, level, text)
        return Shown(own.answer.outputs, "finished", Progress(part=1.0))

    def pause(self, component: Any) -> Any:
        """Cancel the computation of a run, and return its last outputs."""
        self._runs.visit(component)
        own = self._runs.of(component)
        if own is None:
            return self._empty
        own.cancel()
        return own.shown

    def reset(self, component: Any) -> None:
        """Cancel the computation of a run, and delete its outputs, also from the file of the definition."""
        self._runs.drop(component)
        if self._restore is not None:
            delete(component)

    def tasks(self, component: Any) -> list[BackgroundTask]:
        """Return the running tasks of a component."""
        return [own.task for own in self._runs.all_of(component) if own.task is not None]

    def _poll(self, component: Any) -> None:
        """Run a component again when one of its runs has news."""
        now = time.monotonic()
        self._polls = [poll for poll in self._polls if now - poll[1] < MISSED_POLLS]
        if any(poll[0] == component for poll in self._polls):
            return
        notes = [task.progress.note for task in self.tasks(component)]
        poll = [component, now]
        self._polls.append(poll)

        def check() -> None:
            if not any(other is poll for other in self._polls):
                return
            self._runs.drop_unvisited(component)
            tasks = self.tasks(component)
            poll[1] = time.monotonic()
            if component.OnPingDocument() is None:
                self._runs.drop_all(component)
                self._polls.remove(poll)
            elif all(task.running and not task.has_preview for task in tasks) and notes == [task.progress.note for task in tasks] and tasks:
                set_message(component, tasks[-1].progress.text())
                redraw = getattr(component, "OnDisplayExpired", None)
                if redraw is not None:
                    redraw(True)
                run_later(component, POLL_INTERVAL, check)
            else:
                self._polls.remove(poll)
                if tasks and is_present(component):
                    component.ExpireSolution(False)

        run_later(component, POLL_INTERVAL, check)


def _computed(work: Work, report: Report, last: Last, doing: str) -> Finished:
    """Run a computation, and report compilation."""
    latest, thread = Progress(task=doing), threading.get_ident()

    def noted(progress: Progress) -> bool:
        nonlocal latest
        latest = progress if progress.step or progress.note or progress.task else progress._replace(task=doing)
        return report(latest)

    def compiling(state: Compilation) -> None:
        if threading.get_ident() == thread:
            report(latest._replace(compiling=state.part if is_compiling(thread) else None, preview=None))

    noted(latest)
    with watch_compilation(compiling):
        return work(noted, last)


def _wait(task: BackgroundTask) -> None:
    """Wait for a task; the Escape key cancels it."""
    from Grasshopper.Kernel import GH_Document

    is_pressed = getattr(GH_Document, "IsEscapeKeyDown", lambda: False)
    while not task.wait(ESCAPE_INTERVAL):
        if is_pressed():
            task.cancel()
            raise CGCError("the computation was cancelled with the Escape key; recompute to start it again")
