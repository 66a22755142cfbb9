"""Executor on a Dask cluster: own queue, one task at a time for each thread of a worker, and an eye on what dies.

What Dask does by itself is left to it: connections, serialisation, transport of results. What a server must not leave to it is done
here: a task goes to one worker and is never begun again on another (it may be what ended the first), workers of another version get
none, and after the scheduler has died and come back, tasks that were under way are begun once more.
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
from .dask_cluster import PATIENCE
from .dask_cluster import ClusterWatch
from .dask_cluster import Message
from .dask_cluster import let_go
from .dask_task import ask_to_stop
from .dask_task import run_task
from .future import Task
from .future import TaskError
from .future import TaskStopped
from .future import WorkerDied
from .future import place

__all__ = ["DaskExecutor"]

POLL_INTERVAL = 0.02  # seconds between two checks of cancellations and limits
GONE = 2  # looks in a row that a worker is missing in, until its task is given up
BEGINNINGS = 2  # times that a task is begun whose scheduler dies under it

log = logging.getLogger(__name__)


class _Run:
    """A task on its way through the cluster."""

    def __init__(self, task: Task, name: str, address: str, urgent: bool):
        self.task, self.name, self.address, self.urgent = task, name, address, urgent
        self.future: Any = None
        self.started: Optional[float] = None
        self.asked = False  # to stop
        self.lost = False  # Dask has forgotten it
        self.missed = 0  # looks in a row without its worker, or after Dask has forgotten it
        self.restarted = False

    @property
    def is_deaf(self) -> bool:
        """Whether it goes on although everybody has been told that it ended."""
        return self.task.done()


class DaskExecutor:
    """Tasks on the workers of a Dask cluster, see :class:`~compas_cgc.execution.protocol.TaskExecutor`.

    Workers are best started as ``dask worker ADDRESS --nthreads 1``: then a task that does not end when it is asked to is ended with
    its process, and Dask's nanny starts another. A report of a live surface larger than 100 kB is left out.

    Parameters
    ----------
    address
        Of the scheduler, such as ``tcp://127.0.0.1:8786``.
    grace
        Seconds between being asked to stop and being ended by force.
    reserved
        Number of tasks at once that are kept for urgent ones, where there is more than one.

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
        self._runs: dict[str, _Run] = {}
        self._beginnings: dict[Task, int] = {}
        self._slots: dict[str, int] = {}  # tasks at once by the address of the worker
        self._refused: dict[str, str] = {}  # workers that are given nothing, and why
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
        """Number of tasks that run at once."""
        return sum(self._slots.values())

    def submit(self, function: Callable, /, *args: Any, **kwargs: Any) -> Task:
        """Queue a call."""
        return self.start(function, args, kwargs)

    def start(
        self,
        function: Callable,
        args: tuple = (),
        kwargs: Optional[dict] = None,
        on_progress: Optional[Callable[[object], object]] = None,
        time_limit: Optional[float] = None,
        urgent: bool = False,
    ) -> Task:
        """Queue a call, see :meth:`~compas_cgc.execution.protocol.TaskExecutor.start`."""
        if self._closing.is_set():
            raise RuntimeError("the executor is closed, no task can be started")
        task = Task((function, args, kwargs or {}), on_progress, time_limit, urgent)
        self._inbox.put(Message("task", task))
        return task

    def health(self) -> dict:
        """Count workers by what they do and tasks that wait, and name what is wrong."""
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
        """Return no process ids: the workers may be on other machines."""
        return []

    def wait_until_ready(self, timeout: Optional[float] = None) -> bool:
        """Wait until there is a worker."""
        return self._ready.wait(timeout)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Let go of the cluster, which goes on; tasks are finished first, or ended with `cancel_futures`."""
        while wait and not cancel_futures and not self._closing.is_set() and (self._runs or self._waiting or not self._inbox.empty()):
            time.sleep(POLL_INTERVAL)
        self._closing.set()
        self._inbox.put(Message("close"))
        if wait:
            for thread in self._threads:
                thread.join()
            self._errands.shutdown()

    # ------------------------------------------------------------------
    # The thread that keeps the tasks
    # ------------------------------------------------------------------

    def _keep(self) -> None:
        """Hand tasks out and follow them until the executor is closed; nothing else changes what is kept of them."""
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
            log.error("the worker %s is given nothing: it has %s, not %s", address, refused[address], __version__)
        self._refused = refused
        slots = {address: int(count) for address, count in threads.items() if address not in refused}
        self._replaced += len(self._slots.keys() - slots.keys())
        self._slots = slots
        if slots:
            self._ready.set()
        for run in list(self._runs.values()):
            run.missed = 0 if run.address in threads and not run.lost else run.missed + 1
            if run.missed >= GONE:
                self._give_up(run)

    def _on_cut(self, content: object) -> None:
        """The scheduler is lost with all that it knew: what was under way is begun again when it is back, but not for ever."""
        self._client, self._slots = None, {}
        for run in sorted(self._runs.values(), key=lambda run: run.task.since, reverse=True):
            if run.task.done():
                continue
            if self._beginnings[run.task] >= BEGINNINGS:
                self._beginnings.pop(run.task)
                text = f"the Dask scheduler ended {BEGINNINGS} times while this job ran; submit the job again"
                if self._begun(run):
                    run.task.set_exception(WorkerDied(text))
            else:
                self._waiting.appendleft(run.task)
        self._runs.clear()

    def _begun(self, run: _Run) -> bool:
        """Note that a task runs; tell whether anybody still wants it."""
        if run.started is None:
            run.started = time.monotonic()
            if run.task.running():
                return True
            return run.task.done() or run.task.set_running_or_notify_cancel()
        return True

    def _give_up(self, run: _Run) -> None:
        """Fail a task whose worker is gone; Dask is kept from beginning it again."""
        text = f"the Dask worker {run.address} of this job ended unexpectedly, perhaps for lack of memory; submit the job again"
        self._runs.pop(run.name, None)
        self._beginnings.pop(run.task, None)
        self._errands.submit(self._cancelled, run)
        if not run.task.done() and self._begun(run) and not run.task.done():
            log.error("%s: %s", run.name, text)
            run.task.set_exception(WorkerDied(text))

    def _look_after(self, run: _Run) -> None:
        """Stop a task that is to be, or has run too long."""
        task, now = run.task, time.monotonic()
        if task.cancelled() and run.started is None:
            # It waits on its worker still, behind one of somebody else.
            self._runs.pop(run.name, None)
            self._beginnings.pop(task, None)
            self._errands.submit(self._cancelled, run)
            return
        if run.started is None:
            return
        if task.time_limit is not None and now - run.started > task.time_limit:
            task.stop(f"it took longer than the {task.time_limit:g} seconds allowed", self._grace)
        if task.stop_reason is None:
            return
        if not run.asked:
            run.asked = True
            self._errands.submit(self._ask, run)
        if not task.done() and now - task.stop_time > min(task.grace, self._grace):
            task.set_exception(TaskStopped(task.stop_reason))
        if now - task.stop_time > self._grace and not run.restarted:
            run.restarted = True
            log.error("the task %s on %s does not end when it is asked to", run.name, run.address)
            if self._slots.get(run.address) == 1:
                self._errands.submit(self._restart, run)

    def _hand_out(self) -> None:
        """Give waiting tasks to workers that are free."""
        if self._client is None:
            return
        busy: dict[str, int] = {}
        for run in self._runs.values():
            busy[run.address] = busy.get(run.address, 0) + 1
        free = sorted(address for address, count in self._slots.items() for _ in range(count - busy.get(address, 0)))
        jobs = sum(not run.urgent for run in self._runs.values())
        reserved = self._reserved if self.workers > self._reserved else 0
        for task in list(self._waiting):
            if not free:
                return
            if task.cancelled():
                self._waiting.remove(task)
                self._beginnings.pop(task, None)
                continue
            if not task.urgent:
                if jobs >= self.workers - reserved:
                    continue
                jobs += 1
            self._waiting.remove(task)
            self._send(task, free.pop(0))

    def _send(self, task: Task, address: str) -> None:
        run = _Run(task, f"compas-cgc-{uuid.uuid4().hex}", address, task.urgent)
        self._runs[run.name] = run
        self._beginnings[task] = self._beginnings.get(task, 0) + 1
        assert task.call is not None
        try:
            run.future = self._client.submit(
                run_task,
                self._topic,
                run.name,
                *task.call,
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
        """Return what to say of a future of Dask that is done."""
        try:
            if future.status == "finished":
                return Message("done", (run.name, future.result(timeout=60)))
            if future.status == "error":
                error = future.exception(timeout=PATIENCE)
                text = f"the Dask worker {run.address} could not run this job ({type(error).__name__}); see its log"
                return Message("done", (run.name, ("raised", WorkerDied(text))))
        except Exception as error:
            log.error("the outcome of %s is lost: %s", run.name, error)
        return Message("lost", run.name)

    def _on_lost(self, name: str) -> None:
        """Dask has forgotten a task: with its scheduler, or its worker; the next looks at the cluster tell."""
        if name in self._runs:
            self._runs[name].lost = True

    # ------------------------------------------------------------------
    # Errands, which may wait for the cluster
    # ------------------------------------------------------------------

    def _ask(self, run: _Run) -> None:
        try:
            heard = self._client.run(ask_to_stop, run.name, workers=[run.address])
            if not heard.get(run.address):
                run.asked = False  # not there yet, or just done
        except Exception as error:
            log.error("the task %s on %s could not be asked to stop: %s", run.name, run.address, error)

    def _cancelled(self, run: _Run) -> None:
        try:
            run.future.cancel()
        except Exception as error:
            log.debug("the task %s could not be cancelled: %s", run.name, error)

    def _restart(self, run: _Run) -> None:
        try:
            self._client.restart_workers([run.address], timeout=30)
        except Exception as error:
            log.error("the worker %s could not be restarted (%s); end it by hand, or start it with its nanny", run.address, error)

    def _end(self) -> None:
        """Stop what runs and let go of the cluster."""
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
                log.debug("a task could not be asked to stop: %s", error)
        client, self._client = self._client, None
        if client is not None:
            for run in self._runs.values():
                self._cancelled(run)
            let_go(client)
        self._runs.clear()
        self._slots = {}
