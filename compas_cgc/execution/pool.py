"""Process pool: preloaded workers with the interface of :class:`concurrent.futures.Executor`."""

from __future__ import annotations

import logging
import multiprocessing
import sys
import threading
import time
from collections import deque
from concurrent.futures import Executor
from multiprocessing import connection
from types import TracebackType
from typing import Any
from typing import Callable
from typing import Optional

from .future import Arguments
from .future import LimitExceeded
from .future import Task
from .future import TaskError
from .future import TaskStopped
from .future import WorkerDied
from .future import place
from .lanes import ANY
from .lanes import SHORT
from .lanes import SHORT_SECONDS
from .lanes import Lanes
from .worker import run_tasks
from .worker_handle import WorkerHandle

__all__ = ["WorkerPool"]

POLL_INTERVAL = 0.02  # time between two checks of cancellations and limits [s]
FAILED_STARTS = 3  # consecutive failed starts of workers after which queued tasks fail

log = logging.getLogger(__name__)


class WorkerPool(Executor):
    """Pool of processes that run one task at a time.

    When a process ends (by a crash, lack of memory or a kill), only its task fails, and the process
    is replaced. A task that does not stop on request is ended with its process.

    Parameters
    ----------
    workers
        Number of processes.
    warm_up
        Function called in every process before its first task.
    grace
        Time between the request to stop a task and killing its process [s].
    reserved
        Number of additional processes for urgent tasks only; the second and third run short ones only.
    niceness
        By how much the system prefers other processes to those that run long tasks, as in :func:`os.nice`, where it has priorities.
    preload
        Module that workers of the first pool share where processes can be forked: it is imported once.

    Attributes
    ----------
    workers
        Number of processes for all tasks.
    """

    def __init__(
        self,
        workers: int = 1,
        warm_up: Optional[Callable[[], object]] = None,
        grace: float = 1.0,
        reserved: int = 0,
        niceness: int = 0,
        preload: str = "",
    ):
        self._context = _context(preload)
        self._warm_up = warm_up
        self._grace = grace
        self._niceness = niceness
        self.workers = workers
        self._waiting: deque[Task] = deque()
        self._change = threading.Condition()
        self._closed = False
        self._failed_starts = 0
        self.replaced = 0
        self._lanes = Lanes(workers, reserved)
        self._slots = [WorkerHandle(lane) for lane in self._lanes.kinds]
        self._threads = [threading.Thread(target=self._keep, args=(slot,), daemon=True) for slot in self._slots]
        for thread in self._threads:
            thread.start()

    def submit(self, function: Callable, /, *args: Any, **kwargs: Any) -> Task:
        """Queue a call; `function` must be importable by the workers."""
        return self.start(function, args, kwargs)

    def start(
        self,
        function: Callable,
        args: Arguments = (),
        kwargs: Optional[dict] = None,
        on_progress: Optional[Callable[[object], object]] = None,
        time_limit: Optional[float] = None,
        urgent: bool = False,
        client: str = "",
        memory_limit: Optional[int] = None,
        alike: str = "",
    ) -> Task:
        """Queue a call with a listener for its reports, limits on time [s] and memory [bytes], and optional priority."""
        task = Task((function, args, kwargs or {}), on_progress, time_limit, urgent, client, memory_limit, alike)
        with self._change:
            if self._closed:
                raise RuntimeError("the pool is closed; no task can be started")
            self._lanes.submitted(task)
            self._waiting.insert(place(task, self._waiting), task)
            self._change.notify_all()
        return task

    def health(self) -> dict:
        """Return the number of workers by state, and the number of queued tasks."""
        states = [slot.state for slot in self._slots]
        counts = {name: states.count(name) for name in ("starting", "idle", "busy")}
        return {"workers": len(states), **counts, "waiting": len(self._waiting), "replaced": self.replaced}

    def processes(self) -> list[int]:
        """Return the process ids of the workers."""
        pids = [slot.process.pid for slot in self._slots if slot.process is not None and slot.process.is_alive()]
        return [pid for pid in pids if pid is not None]

    def wait_until_ready(self, timeout: Optional[float] = None) -> bool:
        """Wait until every worker has started."""
        with self._change:
            return self._change.wait_for(lambda: all(slot.state in ("idle", "busy") for slot in self._slots), timeout)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes; running tasks are ended unless `wait` is true and `cancel_futures` is false."""
        with self._change:
            if wait and not cancel_futures:
                self._change.wait_for(lambda: not self._waiting and all(slot.state != "busy" for slot in self._slots))
            self._closed = True
            left = list(self._waiting)
            self._waiting.clear()
            self._change.notify_all()
        for task in left:
            if not task.cancel():
                _fail(task, TaskStopped("the server was stopped"))
        if wait:
            for thread in self._threads:
                thread.join()

    def __exit__(self, kind: Optional[type], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        """Shut down at the end of a block; tasks are finished first, unless the block ends with an exception."""
        self.shutdown(wait=True, cancel_futures=kind is not None)

    # ------------------------------------------------------------------
    # One thread per worker
    # ------------------------------------------------------------------

    def _keep(self, slot: WorkerHandle) -> None:
        """Keep a worker running and supply it with tasks until the pool is closed."""
        while not self._closed:
            if self._started(slot):
                self._failed_starts = 0
                self._feed(slot)
            elif not self._closed:
                self._give_up_some()
            slot.end()
        slot.state = "closed"

    def _started(self, slot: WorkerHandle) -> bool:
        try:
            return self._start(slot)
        except OSError as error:
            # Lack of memory, which ended the last worker, can delay the start of the next.
            log.error("a worker cannot be started: %s", error)
            return False

    def _start(self, slot: WorkerHandle) -> bool:
        with self._change:
            slot.state = "starting"
            # The end of a task is awaited, whether its worker outlived it or not.
            self._change.notify_all()
        slot.line, theirs = self._context.Pipe()
        slot.flag = self._context.RawValue("b", 0)
        niceness = 0 if slot.lane == SHORT else self._niceness
        slot.process = self._context.Process(target=run_tasks, args=(theirs, slot.flag, self._warm_up, niceness), daemon=True)
        slot.process.start()
        theirs.close()
        while not self._closed:
            if slot.line in connection.wait([slot.line, slot.process.sentinel], POLL_INTERVAL):
                try:
                    slot.line.recv()
                    return True
                except (EOFError, OSError):
                    return False
            if not slot.process.is_alive():
                return False
        return False

    def _give_up_some(self) -> None:
        self._failed_starts += 1
        log.error("a worker ended before it was ready (%d in a row)", self._failed_starts)
        if self._failed_starts >= FAILED_STARTS:
            with self._change:
                left = list(self._waiting)
                self._waiting.clear()
            for task in left:
                if task.running() or task.set_running_or_notify_cancel():
                    _fail(task, WorkerDied("the workers of the server do not start; see its log"))
            time.sleep(1.0)

    def _feed(self, slot: WorkerHandle) -> None:
        """Run tasks until the process ends."""
        while True:
            with self._change:
                slot.state = "idle"
                self._change.notify_all()
                while (task := self._next(slot)) is None and not self._closed and slot.process.is_alive():
                    self._change.wait(0.5)
                if task is None or self._closed or not slot.process.is_alive():
                    return
                self._waiting.remove(task)
                # A task that left the short lane is running already.
                if not (task.running() or task.set_running_or_notify_cancel()):
                    continue
                if task.stop_reason is not None:
                    _fail(task, task.stopped())
                    continue
                slot.state, slot.task = "busy", task
            try:
                if not self._run(slot, task):
                    self.replaced += 1
                    return
            finally:
                slot.task = None

    def _next(self, slot: WorkerHandle) -> Optional[Task]:
        """Return the queued task that a worker runs next."""
        running = [own.task for own in self._slots if own.lane == ANY and own.task is not None]
        free = sum(own.lane == slot.lane and own.state == "idle" for own in self._slots)
        return self._lanes.pick(slot.lane, self._waiting, running, free)

    def _run(self, slot: WorkerHandle, task: Task) -> bool:
        """Run a task; return whether the process is still alive."""
        slot.flag.value = 0
        started = time.monotonic()
        # On a busy machine short tasks take long because they wait for a processor.
        began, used = slot.clock(), slot.used()
        moving: Optional[float] = None  # since when the task is asked to leave the short lane
        stopping: Optional[float] = None  # since when it is asked to stop
        try:
            slot.line.send(task.prepared())
            if slot.lane != SHORT:
                task.call = None
        except Exception as error:
            task.set_exception(error if slot.process.is_alive() else WorkerDied(slot.exit_message()))
            return slot.process.is_alive()
        while True:
            if self._closed:
                _fail(task, TaskStopped("the server was stopped"))
                return False
            now, own = time.monotonic(), slot.clock()
            if task.time_limit is not None and now - started > task.time_limit:
                task.stop(f"it exceeded the time limit of {task.time_limit:g} s", self._grace, exceeded=True)
            if task.memory_limit is not None and slot.resident() > task.memory_limit:
                _fail(task, LimitExceeded(f"it exceeded the memory limit of {task.memory_limit / 2**20:.0f} MB"))
                slot.end()
                return False
            if task.stop_reason is None and moving is None and self._should_move(slot, own - began):
                moving = own
                slot.flag.value = 1
            if moving is not None and task.stop_reason is None and own - moving > self._grace:
                slot.end()
                self._move(task)
                return False
            if task.stop_reason is not None:
                slot.flag.value = 1
                stopping = own if stopping is None else stopping
                if not task.done() and now - task.stop_time > min(task.grace, self._grace):
                    # Report the stop now, but give the worker more time, as a new one would have to warm up.
                    task.set_exception(task.stopped())
                if own - stopping > self._grace:
                    slot.end()
                    return False
            if slot.line not in connection.wait([slot.line, slot.process.sentinel], POLL_INTERVAL) and slot.process.is_alive():
                continue
            try:
                # Messages sent before the end of the process can still be read.
                content: Any
                kind, content = slot.line.recv() if slot.line.poll() else ("gone", None)
            except (EOFError, OSError):
                kind, content = "gone", None
            if kind == "gone":
                slot.process.join(1.0)
                log.error("worker %s: %s", slot.process.pid, slot.exit_message())
                _fail(task, WorkerDied(slot.exit_message()))
                return False
            if kind == "progress":
                _tell(task, content)
                continue
            done = slot.used()
            self._lanes.ended(task, slot.clock() - began if used is None or done is None else done - used)
            if kind == "stopped" and moving is not None and task.stop_reason is None:
                self._move(task)
                return True
            if kind == "stopped":
                kind, content = content
            if kind == "error":
                _fail(task, TaskError(*content))
            elif not task.done():
                task.set_result(content)
            elif task.on_late is not None:
                _told(task.on_late, content)
            return True

    def _should_move(self, slot: WorkerHandle, seconds: float) -> bool:
        """Check whether a call has been on the short lane for long enough, and another waits for the lane."""
        if slot.lane != SHORT or seconds < SHORT_SECONDS:
            return False
        with self._change:
            return self._lanes.wants_short_lane(self._waiting)

    def _move(self, task: Task) -> None:
        """Let a long call begin again on another lane."""
        with self._change:
            self._lanes.moved(task)
            self._waiting.insert(place(task, self._waiting), task)
            self._change.notify_all()


def _context(preload: str) -> Any:
    """Return how processes are started: forked from one that has imported a module, or, where that is not safe, each from scratch.

    Libraries of macOS do not survive a fork, and before Python 3.11.1 others on the machine could reach the process that forks
    (CVE-2022-42919).
    """
    if not sys.platform.startswith("linux") or sys.version_info < (3, 11, 1):
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([preload] if preload else [])
    return context


def _fail(task: Task, error: Exception) -> None:
    if not task.done():
        task.set_exception(error)


def _tell(task: Task, progress: object) -> None:
    if task.on_progress is not None and not task.done():
        _told(task.on_progress, progress)


def _told(listener: Callable[[Any], object], news: object) -> None:
    try:
        listener(news)
    except Exception:
        log.exception("a listener to a task failed")
