"""Executor on a Dask cluster with its own queue, one task per worker thread, and recovery from failures.

Dask handles connections, serialisation and the transport of results. This module handles what a server cannot leave to Dask: a task
is sent to one worker and never restarted on another, because it may have crashed the first; workers with another version get no
tasks; and after a restart of the scheduler, running tasks are started once more.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
import uuid
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from typing import Callable
from typing import Optional

from .._version import __version__
from .dask_cluster import CONNECT_TIMEOUT
from .dask_cluster import ClusterWatch
from .dask_cluster import Message
from .dask_cluster import let_go
from .dask_task import ask_to_stop
from .dask_task import run_task
from .future import Arguments
from .future import Task
from .future import TaskError
from .future import TaskStopped
from .future import WorkerDied
from .future import place
from .lanes import ANY
from .lanes import Lanes

__all__ = ["DaskExecutor"]

POLL_INTERVAL = 0.02  # time between two checks of cancellations and limits [s]
MAX_MISSED = 2  # consecutive polls without a worker after which its task fails
MAX_STARTS = 2  # attempts for a task whose scheduler ends

log = logging.getLogger(__name__)


class _Run:
    """A task on the cluster."""

    def __init__(self, task: Task, name: str, address: str, urgent: bool):
        self.task, self.name, self.address, self.urgent = task, name, address, urgent
        self.future: Any = None
        self.started: Optional[float] = None
        self.asked = False  # whether a stop was requested
        self.lost = False  # whether Dask no longer knows the task
        self.missed = 0  # consecutive polls without its worker, or since Dask lost the task
        self.restarted = False

    @property
    def is_deaf(self) -> bool:
        """Whether the task keeps running although it was reported as ended."""
        return self.task.done()


class DaskExecutor:
    """Tasks on the workers of a Dask cluster, see :class:`~compas_cgc.execution.protocol.TaskExecutor`.

    Start workers as ``dask worker ADDRESS --nthreads 1``: a task that does not stop on request is then ended with its process, which
    Dask's nanny restarts. Live surfaces larger than 100 kB are omitted from progress reports.

    Parameters
    ----------
    address
        Address of the scheduler, such as ``tcp://127.0.0.1:8786``.
    grace
        Time between the request to stop a task and ending it by force [s].
    reserved
        Number of slots reserved for urgent tasks, if there is more than one slot.

    Raises
    ------
    CGCError
        If distributed is not installed.
    """

    def __init__(self, address: str, grace: float = 1.0, reserved: int = 0):
        self.address = address
        self._grace = grace
        self._reserved = reserved
        self._topic = f"compas-cgc-{uuid.uuid4().hex}"
        self._inbox: queue.SimpleQueue[Message] = queue.SimpleQueue()
        self._waiting: deque[Task] = deque()
        self._lanes = Lanes(0)  # as many as there are workers, which come and go
        self._runs: dict[str, _Run] = {}
        self._beginnings: dict[Task, int] = {}
        self._slots: dict[str, int] = {}  # number of simultaneous tasks by address of the worker
        self._refused: dict[str, str] = {}  # workers that get no tasks, with the reason
        self._client: Any = None
        self._replaced = 0
        self._closing = threading.Event()
        self._ready = threading.Event()
        self._errands = ThreadPoolExecutor(4, "dask-errand")
        watch = ClusterWatch(address, self._topic, self._inbox.put, self._closing)
        self._threads = [threading.Thread(target=self._keep, daemon=True), watch]
        for thread in self._threads:
            thread.start()

    # ------------------------------------------------------------------
    # The protocol
    # ------------------------------------------------------------------

    @property
    def workers(self) -> int:
        """Number of simultaneous tasks."""
        return sum(self._slots.values())

    def submit(self, function: Callable, /, *args: Any, **kwargs: Any) -> Task:
        """Queue a call."""
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
        """Queue a call, see :meth:`~compas_cgc.execution.protocol.TaskExecutor.start`."""
        if self._closing.is_set():
            raise RuntimeError("the executor is closed; no task can be started")
        task = Task((function, args, kwargs or {}), on_progress, time_limit, urgent, client, memory_limit, alike)
        self._inbox.put(Message("task", task))
        return task

    def health(self) -> dict:
        """Return the number of workers by state, the number of queued tasks, and problems."""
        runs, slots = list(self._runs.values()), sum(self._slots.values())
        busy = min(len(runs), slots)
        return {
            "workers": slots,
            "starting": 0,
            "idle": slots - busy,
            "busy": busy,
            "waiting": len(self._waiting),
            "replaced": self._replaced,
            "executor": self.address,
            "connected": self._client is not None,
            "refused": dict(self._refused),
            "deaf": [f"{run.name} on {run.address}" for run in runs if run.is_deaf],
        }

    def processes(self) -> list[int]:
        """Return an empty list, as the workers may be on other machines."""
        return []

    def wait_until_ready(self, timeout: Optional[float] = None) -> bool:
        """Wait until a worker is available."""
        return self._ready.wait(timeout)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Disconnect from the cluster, which keeps running; tasks are finished first, or stopped with `cancel_futures`."""
        while wait and not cancel_futures and not self._closing.is_set() and (self._runs or self._waiting or not self._inbox.empty()):
            time.sleep(POLL_INTERVAL)
        self._closing.set()
        self._inbox.put(Message("close"))
        if wait:
            for thread in self._threads:
                thread.join()
            self._errands.shutdown()

    # ------------------------------------------------------------------
    # The thread that manages the tasks
    # ------------------------------------------------------------------

    def _keep(self) -> None:
        """Distribute and follow tasks until the executor is closed; only this thread changes their state."""
        while True:
            try:
                message: Optional[Message] = self._inbox.get(timeout=POLL_INTERVAL)
            except queue.Empty:
                message = None
            if message is not None:
                if message.kind == "close":
                    break
                getattr(self, f"_on_{message.kind}")(message.content)
            for run in list(self._runs.values()):
                self._look_after(run)
            self._hand_out()
        self._end()

    def _on_task(self, task: Task) -> None:
        self._lanes.submitted(task)
        self._waiting.insert(place(task, self._waiting), task)

    def _on_event(self, event: dict) -> None:
        run = self._runs.get(event["task"])
        if run is None:
            return
        if event["kind"] == "started":
            self._begun(run)
        elif run.task.on_progress is not None and not run.task.done():
            self._begun(run)
            try:
                run.task.on_progress(event["content"])
            except Exception:
                log.exception("a listener to a task failed")

    def _on_done(self, content: tuple) -> None:
        name, (kind, value) = content
        run = self._runs.pop(name, None)
        if run is None:
            return
        self._begun(run)
        self._beginnings.pop(run.task, None)
        if run.task.done():
            return
        if kind == "result":
            run.task.set_result(value)
        else:
            run.task.set_exception(TaskError(*value) if kind == "error" else value)

    def _on_workers(self, content: tuple) -> None:
        client, threads, versions = content
        self._client = client
        refused = {address: said for address, said in versions.items() if said != __version__}
        for address in refused.keys() - self._refused.keys():
            log.error("the worker %s gets no tasks: it has version %s, not %s", address, refused[address], __version__)
        self._refused = refused
        slots = {address: int(count) for address, count in threads.items() if address not in refused}
        self._replaced += len(self._slots.keys() - slots.keys())
        self._slots = slots
        if slots:
            self._ready.set()
        for run in list(self._runs.values()):
            run.missed = 0 if run.address in threads and not run.lost else run.missed + 1
            if run.missed >= MAX_MISSED:
                self._give_up(run)

    def _on_cut(self, content: object) -> None:
        """Handle the loss of the scheduler: running tasks are restarted later, up to MAX_STARTS times."""
        self._client, self._slots = None, {}
        for run in sorted(self._runs.values(), key=lambda run: run.task.since, reverse=True):
            if run.task.done():
                continue
            if run.task.stop_reason is not None:
                # The worker that was asked to end the task is lost, and nobody wants it begun again.
                self._beginnings.pop(run.task, None)
                if self._begun(run):
                    run.task.set_exception(run.task.stopped())
            elif self._beginnings[run.task] >= MAX_STARTS:
                self._beginnings.pop(run.task)
                text = f"the Dask scheduler ended {MAX_STARTS} times during this job; submit the job again"
                if self._begun(run):
                    run.task.set_exception(WorkerDied(text))
            else:
                self._waiting.appendleft(run.task)
        self._runs.clear()

    def _begun(self, run: _Run) -> bool:
        """Mark a task as running; return whether its result is still needed."""
        if run.started is None:
            run.started = time.monotonic()
            if run.task.running():
                return True
            return run.task.done() or run.task.set_running_or_notify_cancel()
        return True

    def _give_up(self, run: _Run) -> None:
        """Fail a task whose worker ended, and prevent Dask from restarting it."""
        text = f"the Dask worker {run.address} of this job ended unexpectedly, probably for lack of memory; submit the job again"
        self._runs.pop(run.name, None)
        self._beginnings.pop(run.task, None)
        self._errands.submit(self._cancelled, run)
        if not run.task.done() and self._begun(run) and not run.task.done():
            log.error("%s: %s", run.name, text)
            run.task.set_exception(WorkerDied(text))

    def _look_after(self, run: _Run) -> None:
        """Stop a task on request or when it exceeds its time limit."""
        task, now = run.task, time.monotonic()
        if task.cancelled() and run.started is None:
            # The task is still queued on its worker, behind a task of another client.
            self._runs.pop(run.name, None)
            self._beginnings.pop(task, None)
            self._errands.submit(self._cancelled, run)
            return
        if run.started is None:
            return
        if task.time_limit is not None and now - run.started > task.time_limit:
            task.stop(f"it exceeded the time limit of {task.time_limit:g} s", self._grace, exceeded=True)
        if task.stop_reason is None:
            return
        if not run.asked:
            run.asked = True
            self._errands.submit(self._ask, run)
        if not task.done() and now - task.stop_time > min(task.grace, self._grace):
            task.set_exception(task.stopped())
        if now - task.stop_time > self._grace and not run.restarted:
            run.restarted = True
            log.error("the task %s on %s does not stop on request", run.name, run.address)
            if self._slots.get(run.address) == 1:
                self._errands.submit(self._restart, run)

    def _hand_out(self) -> None:
        """Send queued tasks to free workers."""
        if self._client is None:
            return
        busy: dict[str, int] = {}
        for run in self._runs.values():
            busy[run.address] = busy.get(run.address, 0) + 1
        free = sorted(address for address, count in self._slots.items() for _ in range(count - busy.get(address, 0)))
        for task in list(self._waiting):
            if task.stop_reason is not None and not task.done():
                task.set_exception(task.stopped())
            if task.done():
                self._waiting.remove(task)
                self._beginnings.pop(task, None)
        reserved = self._reserved if self.workers > self._reserved else 0
        self._lanes.kinds = [ANY] * self.workers
        for address in free:
            jobs = sum(not run.urgent for run in self._runs.values())
            waiting = [task for task in self._waiting if task.urgent or jobs < self.workers - reserved]
            chosen = self._lanes.pick(ANY, waiting, [run.task for run in self._runs.values()])
            if chosen is None:
                return
            self._waiting.remove(chosen)
            self._send(chosen, address)

    def _send(self, task: Task, address: str) -> None:
        run = _Run(task, f"compas-cgc-{uuid.uuid4().hex}", address, task.urgent)
        self._runs[run.name] = run
        self._beginnings[task] = self._beginnings.get(task, 0) + 1
        try:
            run.future = self._client.submit(
                run_task,
                self._topic,
                run.name,
                *task.prepared(),
                key=run.name,
                workers=[address],
                pure=False,
                retries=0,
                priority=int(task.urgent),
            )
        except Exception as error:
            self._inbox.put(Message("done", (run.name, ("raised", error))))
            return
        run.future.add_done_callback(lambda future: self._inbox.put(self._told(run, future)))

    def _told(self, run: _Run, future: Any) -> Message:
        """Return the message for a finished Dask future."""
        try:
            if future.status == "finished":
                return Message("done", (run.name, future.result(timeout=60)))
            if future.status == "error":
                error = future.exception(timeout=CONNECT_TIMEOUT)
                text = f"the Dask worker {run.address} could not run this job ({type(error).__name__}); see its log"
                return Message("done", (run.name, ("raised", WorkerDied(text))))
        except Exception as error:
            log.error("the outcome of %s is lost: %s", run.name, error)
        return Message("lost", run.name)

    def _on_lost(self, name: str) -> None:
        """Mark a task that Dask no longer knows; the next polls show whether its scheduler or worker ended."""
        if name in self._runs:
            self._runs[name].lost = True

    # ------------------------------------------------------------------
    # Requests that may block on the cluster
    # ------------------------------------------------------------------

    def _ask(self, run: _Run) -> None:
        try:
            heard = self._client.run(ask_to_stop, run.name, workers=[run.address])
            if not heard.get(run.address):
                run.asked = False  # not started yet, or just finished
        except Exception as error:
            log.error("the stop request for the task %s on %s failed: %s", run.name, run.address, error)

    def _cancelled(self, run: _Run) -> None:
        try:
            run.future.cancel()
        except Exception as error:
            log.debug("the task %s could not be cancelled: %s", run.name, error)

    def _restart(self, run: _Run) -> None:
        try:
            self._client.restart_workers([run.address], timeout=30)
        except Exception as error:
            log.error("the worker %s could not be restarted (%s); end it manually, or start it with its nanny", run.address, error)

    def _end(self) -> None:
        """Stop running tasks and disconnect from the cluster."""
        for task in self._waiting:
            if not task.running():
                task.cancel()
            elif not task.done():
                task.set_exception(TaskStopped("the server was stopped"))
        self._waiting.clear()
        asked = [self._errands.submit(self._ask, run) for run in self._runs.values() if run.started is not None]
        for run in self._runs.values():
            if not run.task.cancel() and not run.task.done():
                run.task.set_exception(TaskStopped("the server was stopped"))
        for one in asked:
            try:
                one.result(timeout=self._grace)
            except Exception as error:
                log.debug("the stop request for a task failed: %s", error)
        client, self._client = self._client, None
        if client is not None:
            for run in self._runs.values():
                self._cancelled(run)
            let_go(client)
        self._runs.clear()
        self._slots = {}
