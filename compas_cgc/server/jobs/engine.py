"""Job engine: a queue of solves with their progress, results and cancellation."""

from __future__ import annotations

import hashlib
import io
import json
import logging
import re
import secrets
import sqlite3
import threading
import time
from collections import Counter
from collections import deque
from collections.abc import Iterator
from collections.abc import Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import IO
from typing import Any
from typing import Callable
from typing import Optional
from typing import Union

from ...execution.future import Task
from ...execution.future import start
from ...execution.future import stop
from ...execution.protocol import AnyExecutor
from ..errors import Busy
from ..errors import Conflict
from ..errors import Gone
from ..errors import NoRoom
from ..errors import NotFound
from ..errors import ServerStopping
from ..errors import Unprocessable
from ..limits import Limits
from .blobs import pieces
from .calls import Calls
from .outcome import CANCELLED
from .outcome import Outcome
from .outcome import outcome_of
from .output import JobOutput
from .store import Job
from .store import Staged
from .store import Store
from .store import owned_id

__all__ = ["Jobs"]

MAINTENANCE_INTERVAL = 15.0  # seconds
ATTEMPTS = 2  # number of server crashes during a job after which the job is not started again
log = logging.getLogger(__name__)
_ID = re.compile(r"[A-Za-z0-9_-]{8,64}")

# Solves a request (kind, options, body, limits) in a worker; must be importable there.
SolveJob = Callable[[str, dict, bytes, Limits], JobOutput]


class RunningJob:
    """A job that is queued or running."""

    def __init__(self, client: str):
        self.client = client
        self.task: Optional[Future] = None
        self.since: Optional[float] = None  # start time
        self.progress: dict = {}
        self.surface: Optional[bytes] = None
        self.arrived: Optional[bytes] = None
        self.judged: Optional[dict] = None
        self.changes = 0


class Jobs:
    """Jobs on an executor, kept in a store.

    Parameters
    ----------
    executor
        Runs the solves. With a :class:`~compas_cgc.execution.pool.WorkerPool`, jobs report their
        progress and can be stopped; with any other executor they cannot.
    store
        Stores the jobs. Unfinished jobs in it are resumed.
    solve
        Function that solves a request; runs on the executor.
    limits
        Limits on the size and number of requests.
    readers, writers
        Read the files of clients, and write files for them, apart from the solves. Default: the executor.

    Attributes
    ----------
    finished
        Number of jobs that ended, by state.
    seconds
        Total running time of the jobs that ended [s].
    """

    def __init__(
        self,
        executor: AnyExecutor,
        store: Store,
        solve: SolveJob,
        limits: Optional[Limits] = None,
        readers: Optional[AnyExecutor] = None,
        writers: Optional[AnyExecutor] = None,
    ):
        self.executor = executor
        self.limits = limits or Limits()
        self.calls = Calls(executor, readers or executor, writers or executor, self.limits)
        self.store = store
        self._solve = solve
        self._running: dict[str, RunningJob] = {}
        # Finished jobs whose outcome could not be stored.
        self._lost: dict[str, Job] = {}
        # Deleted jobs that could not be removed from the store yet.
        self._forgotten: set[str] = set()
        # Jobs that are deleted at a time of the monotonic clock, unless a client asks for them before.
        self._expiring: dict[str, float] = {}
        self._took: deque[float] = deque(maxlen=50)  # durations of the last jobs [s]
        self.finished: Counter[str] = Counter()
        self.seconds = 0.0
        self._change = threading.Condition(threading.RLock())
        self._closed = False
        for job in store.unfinished():
            if job.attempts >= ATTEMPTS:
                text = f"the server crashed {job.attempts} times during this job, probably for lack of memory; use a coarser mesh"
                store.finish(job.id, "failed", text, job.progress)
            else:
                if job.state == "running":
                    store.set_waiting(job.id)
                self._start(job, *store.request(job.id))
        threading.Thread(target=self._maintain, name="maintenance", daemon=True).start()

    # ------------------------------------------------------------------
    # Jobs
    # ------------------------------------------------------------------

    def submit(
        self,
        kind: str,
        body: Union[bytes, IO[bytes]],
        options: Optional[dict] = None,
        id: Optional[str] = None,
        client: str = "",
        owner: str = "",
    ) -> tuple[Job, bool]:
        """Accept a job and start it when a worker is free.

        Parameters
        ----------
        kind
            Format of the body, such as ``"json"`` or ``"3dm"``.
        body
            The checked request, or a file that is read in pieces.
        options
            Options that a file cannot hold: supports, targets, method, settings.
        id
            Id chosen by the client. Submitting the same request again with this id returns the first job.
        client
            Address of the client, or name of its key.
        owner
            Name of the owner, within whose jobs the id is unique.

        Returns
        -------
        Job, bool
            The job, and whether it is new.

        Raises
        ------
        Busy
            If too many jobs wait.
        Conflict
            If the id belongs to a different request.
        """
        options = options or {}
        checksum = hashlib.sha256(json.dumps([kind, options], sort_keys=True).encode())
        content = _counted(io.BytesIO(body) if isinstance(body, bytes) else body, checksum)
        if id is not None and not _ID.fullmatch(id):
            raise Unprocessable("the id of a job must consist of 8 to 64 letters, digits, '-' or '_'")
        # Without holding up others while the body is written; another request may have taken the id or the room meanwhile.
        with self._change:
            known = self._known_or_room(id, client, owner, len(body) if isinstance(body, bytes) else 0)
        if known is not None:
            deque(content, maxlen=0)
            return _same(known, checksum.hexdigest()), False
        with self.store.staged(content) as staged, self._change:
            digest = checksum.hexdigest()
            known = self._known_or_room(id, client, owner, staged.size)
            if known is not None:
                return _same(known, digest), False
            id = owned_id(owner, id or secrets.token_urlsafe(16))
            name = str(options.get("name", ""))[:100]
            task = {"task": options["task"]} if "task" in options else {}
            job = Job(id, "queued", time.time(), None, None, 0, client, digest, name, task, None, None)
            self.store.add(job, kind, options, staged)
            self._start(job, kind, options)
        return job, True

    def _known_or_room(self, id: Optional[str], client: str, owner: str, size: int) -> Optional[Job]:
        """Return the job with this id; None if there is none, and room for it."""
        self._forget()
        known = self._found(owned_id(owner, id)) if id is not None else None
        if known is not None:
            self._expiring.pop(known.id, None)
        else:
            self.admit(client)
            self._check_room(owner, size)
        return known

    def get(self, id: str) -> Job:
        """Return a job with its current progress. A job that a client asks for is not deleted later, see :meth:`delete`."""
        with self._change:
            self._expiring.pop(id, None)
            return self._current(id)

    def _current(self, id: str) -> Job:
        """Return a job with its current progress."""
        with self._change:
            job = self._found(id)
            if job is None:
                raise NotFound(f"there is no job {id:.80}; it was deleted or never existed")
            running = self._running.get(id)
            return job if running is None else job._replace(progress={**job.progress, **running.progress})

    def list(self) -> Sequence[Job]:
        """Return the newest jobs."""
        return self.page()[0]

    def page(
        self, limit: int = 100, offset: int = 0, state: Optional[str] = None, owner: Optional[str] = None
    ) -> tuple[Sequence[Job], int]:
        """Return one page of the jobs, newest first, and their total number; optionally only those in one state."""
        with self._change:
            running = {id: dict(entry.progress) for id, entry in self._running.items()}
            shown, total = self._page(limit, offset, state, owner)
            return [job._replace(progress={**job.progress, **running.get(job.id, {})}) for job in shown], total

    def positions(self) -> dict[str, int]:
        """Return the position in the queue of every queued job, counted from 1."""
        with self._change:
            waiting = [id for id, running in self._running.items() if not running.progress]
            return {id: place for place, id in enumerate(waiting, 1)}

    def result(self, id: str) -> bytes:
        """Return the packed result of a job."""
        job = self.get(id)
        if not job.over:
            raise Conflict(f"the job is {job.state}; request the result after it has succeeded")
        content = self.store.result(id)
        if content is not None:
            return content
        if job.state == "succeeded":
            raise Gone("the result of this job was deleted to make room for newer ones; submit the job again")
        raise Conflict(f"the job has no result because it was {job.state}: {job.message}" if job.state == "cancelled" else f"{job.message}")

    def surface(self, id: str) -> Optional[bytes]:
        """Return the current vertices of a running live job as float32 bytes in the order x, y, z; None before the first report."""
        self.get(id)
        with self._change:
            running = self._running.get(id)
            return running.surface if running is not None else None

    def arrived(self, id: str) -> Optional[bytes]:
        """Return the solved vertices of a live job before its verdict, as float64 bytes in the order x, y, z."""
        with self._change:
            running = self._running.get(id)
            return running.arrived if running is not None else None

    def judged(self, id: str) -> Optional[dict]:
        """Return the verdict of a live job before its surface is measured and stored."""
        with self._change:
            running = self._running.get(id)
            return running.judged if running is not None else None

    def cancel(self, id: str) -> Job:
        """Request that a job stop; no effect on a finished job."""
        self.get(id)
        with self._change:
            running = self._running.get(id)
            task = None if running is None else running.task
        if task is not None:
            stop(task, CANCELLED)
            if running is not None and not isinstance(task, Task) and not task.cancelled():
                self._abandon(id, running, "cancelled", f"stopped: {CANCELLED}")
        return self.get(id)

    def delete(self, id: str, after: float = 0.0) -> None:
        """Stop a job and delete it.

        Parameters
        ----------
        id
            The job.
        after
            Time [s] within which any other request for the job revokes its deletion. A server that restarts meanwhile keeps the job.

        Raises
        ------
        NotFound
            If there is no such job.
        """
        self.get(id)
        if after > 0.0:
            with self._change:
                self._expiring[id] = time.monotonic() + after
            return
        with self._change:
            # Deleting must work on a full disk: the store is updated when there is room.
            self._forgotten.add(id)
            self._forget()
            running = self._running.pop(id, None)
            self._lost.pop(id, None)
            self._change.notify_all()
        if running is not None:
            task, running.task = running.task, None
            if isinstance(task, Task):
                task.on_late = None
            stop(task, CANCELLED)

    def wait(self, id: str, seconds: float) -> Job:
        """Wait until a job is finished, at most for the given time [s], and return it."""
        self.get(id)
        with self._change:
            self._change.wait_for(lambda: self._closed or id not in self._running, seconds)
            if self._closed:
                raise ServerStopping("the server is shutting down; try again after it has restarted")
        return self._current(id)

    def follow(self, id: str, heartbeat: float = 15.0) -> Iterator[Optional[Job]]:
        """Yield a job after every change until it is finished, and None after every `heartbeat` seconds without a change."""
        with self._change:
            seen = self._running[id].changes if id in self._running else -1
        job: Optional[Job] = self.get(id)
        while True:
            yield job
            if job is not None and job.over:
                return
            with self._change:

                def changed(seen: int = seen) -> bool:
                    return self._closed or id not in self._running or self._running[id].changes != seen

                happened = self._change.wait_for(changed, heartbeat)
                if self._closed or self._found(id) is None:
                    return
                seen = self._running[id].changes if id in self._running else -1
                job = self._current(id) if happened else None

    def admit(self, client: str) -> None:
        """Check that the queue has room for another job.

        Raises
        ------
        Busy
            If the queue is full, or the client has too many unfinished jobs.
        """
        self._check_open()
        clients = [running.client for running in self._running.values()]
        if len(clients) >= self.limits.queue:
            raise Busy(f"the queue is full ({self.limits.queue} jobs); submit the job again when some have finished", self._pause())
        if clients.count(client) >= self.limits.per_client:
            message = f"this client has {self.limits.per_client} unfinished jobs, which is the limit; wait for some or cancel them"
            # Retry when the first job of this client is due.
            raise Busy(message, self._pause(clients.index(client)))

    def _check_room(self, owner: str, size: int) -> None:
        """Check that the disk and the owner's budget have room for a request.

        Raises
        ------
        NoRoom
            If they have not.
        """
        free = self.store.free()
        if free is not None and free - size < self.limits.free:
            raise NoRoom("the disk of the server is nearly full, and no jobs are accepted; free disk space, or delete old jobs")
        if self.store.owner_bytes(owner) + size > self.limits.owner_bytes:
            most = self.limits.owner_bytes / 2**20
            raise NoRoom(
                f"your jobs would take more than the {most:.0f} MB that one owner has; delete some, or wait until some have finished"
            )

    def problems(self) -> Sequence[str]:
        """Return what keeps the server from accepting jobs as sentences, nothing if it is ready."""
        problems = ["the server is shutting down"] if self._closed else []
        fault = self.store.check()
        if fault is not None:
            problems.append(fault)
        free = self.store.free()
        if free is not None and free < self.limits.free:
            problems.append(f"the disk has {free / 2**20:.0f} MB left, {self.limits.free / 2**20:.0f} MB are needed")
        health: dict = getattr(self.executor, "health", dict)()
        if health and health["starting"] >= health["workers"]:
            problems.append("no worker is running")
        return problems

    def _maintain(self) -> None:
        """Delete what clients have left or what is too old, give free space back to the disk, and end what plain executors do not."""
        due = time.monotonic() + MAINTENANCE_INTERVAL
        while True:
            with self._change:
                if self._change.wait_for(lambda: self._closed, 1.0):
                    return
                for running in self._running.values():
                    # A plain executor does not report when a job begins.
                    if (
                        running.since is None
                        and isinstance(running.task, Future)
                        and not isinstance(running.task, Task)
                        and running.task.running()
                    ):
                        running.since = time.monotonic()
                late = [
                    (id, running)
                    for id, running in self._running.items()
                    if running.since is not None
                    and not isinstance(running.task, Task)
                    and time.monotonic() - running.since > self.limits.seconds
                ]
                left = [id for id, end in self._expiring.items() if time.monotonic() >= end]
            for id in left:
                with suppress(NotFound):
                    self.delete(id)
            for id, running in late:
                self._abandon(id, running, "failed", f"stopped: it exceeded the time limit of {self.limits.seconds:g} s")
            if time.monotonic() >= due:
                try:
                    with self._change:
                        if self._closed:
                            return
                        self._tidy()
                        self._forget()
                    self.store.shrink()
                except (sqlite3.Error, OSError) as error:
                    log.error("the store cannot be tidied: %s", error)
                due = time.monotonic() + MAINTENANCE_INTERVAL

    def _tidy(self, keep: str = "") -> None:
        limits = self.limits
        self.store.tidy(limits.results, limits.result_bytes, limits.remembered, keep, limits.owner_bytes, limits.days)

    def _abandon(self, id: str, running: RunningJob, state: str, message: str) -> None:
        """End a job whose executor cannot end its task; what it returns later is dropped."""
        with self._change:
            if self._running.get(id) is not running:
                return
            del self._running[id]
            self._count(id, state, running)
            self.store.finish(id, state, message, running.progress)
            self._change.notify_all()

    def _count(self, id: str, state: str, running: RunningJob) -> None:
        """Count a job that ended, and log it."""
        seconds = 0.0 if running.since is None else time.monotonic() - running.since
        if running.since is not None:
            self._took.append(seconds)
        self.finished[state] += 1
        self.seconds += seconds
        log.info("job %s %s after %.3g s", id, state, seconds, extra={"fields": {"job": id, "state": state, "seconds": round(seconds, 3)}})

    def unfinished(self) -> dict[str, int]:
        """Return the number of queued and of running jobs."""
        with self._change:
            started = sum(bool(running.progress) for running in self._running.values())
            return {"queued": len(self._running) - started, "running": started}

    def _pause(self, ahead: int = 0) -> float:
        """Return the estimated time until a job with `ahead` jobs before it is finished [s], from the durations of earlier jobs."""
        took = sorted(self._took)
        median = took[len(took) // 2] if took else 1.0
        return median * (1.0 + ahead / max(1, getattr(self.executor, "workers", 1)))

    def _check_open(self) -> None:
        if self._closed:
            raise ServerStopping("the server is shutting down; submit the job again after it has restarted")

    def close(self) -> None:
        """Stop all jobs; unfinished jobs are resumed at the next start of the server."""
        with self._change:
            if self._closed:
                return
            self._closed = True
            left = list(self._running)
            self._change.notify_all()
        self.calls.close()
        for executor in {self.executor, self.calls.readers, self.calls.writers}:
            executor.shutdown(wait=True, cancel_futures=True)
        self._forget()
        for id in left:
            job = self._found(id)
            if job is not None and not job.over:
                self.store.set_queued(id)
        self.store.close()

    # ------------------------------------------------------------------

    def _found(self, id: str) -> Optional[Job]:
        return None if id in self._forgotten else self._lost.get(id) or self.store.get(id)

    def _page(self, limit: int, offset: int, state: Optional[str], owner: Optional[str]) -> tuple[Sequence[Job], int]:
        if not (self._lost or self._forgotten):
            # Read only the requested page from the store.
            return self.store.page(limit, offset, state, owner)
        stored = (self._lost.get(job.id, job) for job in self.store.all() if job.id not in self._forgotten)
        found = [job for job in stored if state in (None, job.state) and owner in (None, job.owner)]
        return found[offset : offset + limit], len(found)

    def _forget(self) -> None:
        """Remove the deleted jobs from the store; those that fail are retried later."""
        for id in tuple(self._forgotten):
            try:
                self.store.delete(id)
            except sqlite3.Error as error:
                log.error("job %s cannot be removed from the store yet: %s", id, error)
                return
            self._forgotten.discard(id)

    def _start(self, job: Job, kind: str, options: dict) -> None:
        running = self._running[job.id] = RunningJob(job.client)
        # A waiting request stays on the disk.
        running.task = start(
            self.executor,
            self._solve,
            lambda: (kind, options, self.store.body(job.id), self.limits),
            lambda progress: self._progress(job.id, running, progress),
            self.limits.seconds,
            client=job.client,
            memory_limit=self.limits.memory,
        )
        if isinstance(running.task, Task):
            running.task.on_late = lambda output: self._late(job.id, output)
        running.task.add_done_callback(lambda task: self._done(job, running, task))

    def _late(self, id: str, output: JobOutput) -> None:
        """Store the surface of a job that was marked as stopped before its last step ended."""
        try:
            if output.content is not None:
                self.store.add_result(id, output.content)
        except sqlite3.Error as error:
            log.error("the surface of the stopped job %s cannot be stored: %s", id, error)

    def _progress(self, id: str, running: RunningJob, news: dict) -> None:
        with self._change:
            # The job may have been deleted, and its id may belong to a new job.
            if self._running.get(id) is not running:
                return
            if not running.progress:
                self.store.set_started(id)
                running.since = time.monotonic()
            running.surface = news.pop("surface", running.surface)
            running.arrived = news.pop("arrived", running.arrived)
            running.judged = news.pop("judged", running.judged)
            running.progress = news
            running.changes += 1
            self._change.notify_all()

    def _done(self, job: Job, running: RunningJob, task: Future) -> None:
        if self._closed or self._running.get(job.id) is not running:
            return
        outcome = outcome_of(task)
        try:
            with self.store.staged(outcome.content or b"") as content:
                self._finish(job, running, outcome, None if outcome.content is None else content)
        except OSError as error:
            self._lose(job, running, error)

    def _finish(self, job: Job, running: RunningJob, outcome: Outcome, content: Optional[Staged]) -> None:
        with self._change:
            if self._closed or self._running.get(job.id) is not running:
                return
            # Break the reference cycle between the task and its listeners, which would keep request and result in memory.
            running.task = None
            self._count(job.id, outcome.state, running)
            running.progress = {**job.progress, **running.progress, **(outcome.figures or {})}
            try:
                self.store.finish(job.id, outcome.state, outcome.message, running.progress, content)
                del self._running[job.id]
                self._tidy(job.id)
            except (sqlite3.Error, OSError) as error:
                self._lose(job, running, error)
            finally:
                self._forget()
                self._change.notify_all()

    def _lose(self, job: Job, running: RunningJob, error: Exception) -> None:
        """End a job whose outcome cannot be stored."""
        with self._change:
            log.error("the outcome of job %s cannot be stored: %s", job.id, error)
            self._running.pop(job.id, None)
            text = "the server could not store the result, probably because its disk is full; free disk space and submit the job again"
            self._lost[job.id] = job._replace(state="failed", finished=time.time(), message=text, progress=running.progress)
            self._change.notify_all()


def _counted(stream: IO[bytes], checksum: Any) -> Iterator[bytes]:
    """Yield the content of a stream in pieces, and add it to a checksum."""
    for piece in pieces(stream):
        checksum.update(piece)
        yield piece


def _same(job: Job, digest: str) -> Job:
    """Return a job after checking that it has the same request.

    Raises
    ------
    Conflict
        If it has another one.
    """
    if job.digest != digest:
        raise Conflict(f"the id {job.shown().id} belongs to a different request; choose another id")
    return job
