"""The job engine: accepts, runs, follows, keeps."""

from __future__ import annotations

import hashlib
import json
import logging
import re
import secrets
import sqlite3
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from concurrent.futures import Future
from typing import Callable
from typing import Optional

from ..api.tasks import solve_job
from ..errors import Busy
from ..errors import Conflict
from ..errors import Gone
from ..errors import NotFound
from ..errors import Unprocessable
from ..limits import Limits
from .ending import CANCELLED
from .ending import ending
from .future import stop
from .future import wait_for
from .store import Job
from .store import Store

__all__ = ["Jobs"]

ATTEMPTS = 2  # times that a job may be running while the server ends, until it is blamed for it
log = logging.getLogger(__name__)
_ID = re.compile(r"[A-Za-z0-9_-]{8,64}")


class _Live:
    """A job that waits or runs."""

    def __init__(self, client: str):
        self.client = client
        self.task: Optional[Future] = None
        self.progress: dict = {}
        self.surface: Optional[bytes] = None
        self.changes = 0


class Jobs:
    """Jobs on an executor, kept in a store.

    Parameters
    ----------
    executor
        Runs the solves. With a :class:`~compas_cgc.server.jobs.pool.WorkerPool` jobs report their
        progress and can be stopped; any other executor runs them to their end.
    store
        Keeps the jobs. Those in it that are not finished are taken up again.
    limits
        What is refused.
    clerk
        Reads and writes files, beside the solves. Default: the executor.
    """

    def __init__(self, executor: Executor, store: Store, limits: Optional[Limits] = None, clerk: Optional[Executor] = None):
        self.executor = executor
        self.clerk = clerk or executor
        self.store = store
        self.limits = limits or Limits()
        self._live: dict[str, _Live] = {}
        # Jobs that are over, which the store could not be told of.
        self._lost: dict[str, Job] = {}
        self._change = threading.Condition(threading.RLock())
        self._closed = False
        self._conversions = threading.BoundedSemaphore(self.limits.conversions)
        for job in store.unfinished():
            if job.attempts >= ATTEMPTS:
                text = f"the server ended {job.attempts} times while this job ran, it may need too much memory; use a coarser mesh"
                store.finish(job.id, "failed", text, job.progress)
            else:
                self._start(job)

    # ------------------------------------------------------------------
    # Jobs
    # ------------------------------------------------------------------

    def submit(
        self, kind: str, body: bytes, options: Optional[dict] = None, id: Optional[str] = None, client: str = ""
    ) -> tuple[Job, bool]:
        """Accept a job and start it when a worker is free.

        Parameters
        ----------
        kind
            ``"arrays"``, ``"compas"``, ``"hops"``, ``"3dm"`` or ``"obj"``: what the body is.
        body
            The request, checked.
        options
            What a file cannot say: supports, targets, method, settings.
        id
            The client's name for the job: a second submit under it returns the first job.
        client
            Who asks.

        Returns
        -------
        Job, bool
            And whether it is new.

        Raises
        ------
        Busy
            If too many jobs wait.
        Conflict
            If the id was used for another request.
        """
        options = options or {}
        digest = hashlib.sha256(json.dumps([kind, options], sort_keys=True).encode() + body).hexdigest()
        if id is not None and not _ID.fullmatch(id):
            raise Unprocessable("the id of a job must be 8 to 64 letters, digits, - or _")
        with self._change:
            known = (self._lost.get(id) or self.store.get(id)) if id is not None else None
            if known is not None:
                if known.digest != digest:
                    raise Conflict(f"the id {id} was used for another request; take a new one")
                return known, False
            self.admit(client)
            id = id or secrets.token_urlsafe(16)
            name = str(options.get("name", ""))[:100]
            job = Job(id, "queued", time.time(), None, None, 0, client, digest, name, {}, None, None)
            self.store.add(job, kind, options, body)
            self._start(job)
        return job, True

    def get(self, id: str) -> Job:
        """Return a job with its present progress."""
        with self._change:
            job = self._lost.get(id) or self.store.get(id)
            if job is None:
                raise NotFound(f"there is no job {id:.80}; it was deleted, or was never here")
            live = self._live.get(id)
            return job if live is None else job._replace(progress=dict(live.progress))

    def list(self) -> list[Job]:
        """Return the newest jobs."""
        with self._change:
            live = {id: dict(entry.progress) for id, entry in self._live.items()}
            found = [self._lost.get(job.id, job) for job in self.store.list()]
            return [job._replace(progress=live.get(job.id, job.progress)) for job in found]

    def result(self, id: str) -> bytes:
        """Return the packed result of a job."""
        job = self.get(id)
        if not job.over:
            raise Conflict(f"the job is {job.state}; ask again when it has succeeded")
        content = self.store.result(id)
        if content is not None:
            return content
        if job.state == "succeeded":
            raise Gone("the result of this job is gone, newer ones took its place; submit the job again")
        raise Conflict(f"the job has no result, it was {job.state}: {job.message}" if job.state == "cancelled" else f"{job.message}")

    def surface(self, id: str) -> Optional[bytes]:
        """Return the present vertices of a running job that was submitted as live: float32, x y z after x y z."""
        self.get(id)
        with self._change:
            live = self._live.get(id)
            return live.surface if live is not None else None

    def cancel(self, id: str) -> Job:
        """Ask a job to stop; does nothing to one that is over."""
        self.get(id)
        with self._change:
            task = self._live[id].task if id in self._live else None
        if task is not None:
            stop(task, CANCELLED)
        return self.get(id)

    def delete(self, id: str) -> None:
        """Stop a job and forget it."""
        self.get(id)
        with self._change:
            self.store.delete(id)
            live = self._live.pop(id, None)
            self._lost.pop(id, None)
            self._change.notify_all()
        if live is not None:
            task, live.task = live.task, None
            stop(task, CANCELLED)

    def wait(self, id: str, seconds: float) -> Job:
        """Return a job as soon as it is over, or as it is after some seconds."""
        self.get(id)
        with self._change:
            self._change.wait_for(lambda: self._closed or id not in self._live, seconds)
            if self._closed:
                raise Busy("the server is stopping; ask again when it is back")
        return self.get(id)

    def follow(self, id: str, patience: float = 15.0) -> Iterator[Optional[Job]]:
        """Yield a job after every change until it is over, and None when nothing happened for a while."""
        with self._change:
            seen = self._live[id].changes if id in self._live else -1
        job: Optional[Job] = self.get(id)
        while True:
            yield job
            if job is not None and job.over:
                return
            with self._change:

                def changed(seen: int = seen) -> bool:
                    return self._closed or id not in self._live or self._live[id].changes != seen

                happened = self._change.wait_for(changed, patience)
                if self._closed or self.store.get(id) is None:
                    return
                seen = self._live[id].changes if id in self._live else -1
                job = self.get(id) if happened else None

    # ------------------------------------------------------------------
    # Calls that are waited for
    # ------------------------------------------------------------------

    def call(self, function: Callable, *args: object, client: str = "", gone: Callable[[], bool] = lambda: False) -> object:
        """Run a function in a worker and wait for it.

        Parameters
        ----------
        function, args
            What to run.
        client
            Who asks.
        gone
            Tells whether the client has given up, which stops the function.

        Raises
        ------
        Busy
            If too many calls and jobs wait.
        TimeoutError
            If it took longer than the limit for requests that wait.
        """
        key = secrets.token_urlsafe(16)
        with self._change:
            if sum(id.startswith("call:") for id in self._live) >= self.limits.calls:
                raise Busy("the server is busy with other solves; try again in a moment")
            self.admit(client)
            live = self._live[f"call:{key}"] = _Live(client)
            # Somebody waits for it, as nobody does for a job.
            live.task = self._run(function, args, None, urgent=True)
        try:
            return wait_for(live.task, self.limits.blocking, gone)
        finally:
            with self._change:
                self._live.pop(f"call:{key}", None)

    def convert(self, function: Callable, *args: object, gone: Callable[[], bool] = lambda: False) -> object:
        """Run a function that reads or writes a file and wait for it; no solve is waited for.

        Raises
        ------
        Busy
            If too many wait already.
        TimeoutError
            If it took longer than the limit for requests that wait.
        """
        if not self._conversions.acquire(blocking=False):
            raise Busy("the server is busy with other files; try again in a moment")
        try:
            return wait_for(self._run(function, args, None, self.clerk), self.limits.blocking, gone)
        finally:
            self._conversions.release()

    def admit(self, client: str) -> None:
        """Refuse when too much waits.

        Raises
        ------
        Busy
            With what to do.
        """
        if self._closed:
            raise Busy("the server is stopping; submit again when it is back")
        if len(self._live) >= self.limits.queue:
            raise Busy(f"the queue is full ({self.limits.queue} jobs); submit again when some are finished")
        if sum(live.client == client for live in self._live.values()) >= self.limits.per_client:
            raise Busy(f"this client has {self.limits.per_client} unfinished jobs, which is the limit; wait for some or cancel them")

    def close(self) -> None:
        """Stop everything; jobs that are not finished wait for the next start of the server."""
        with self._change:
            if self._closed:
                return
            self._closed = True
            left = [id for id in self._live if not id.startswith("call:")]
            self._change.notify_all()
        for executor in {self.executor, self.clerk}:
            executor.shutdown(wait=True, cancel_futures=True)
        for id in left:
            job = self.store.get(id)
            if job is not None and not job.over:
                self.store.set_queued(id)
        self.store.close()

    # ------------------------------------------------------------------

    def _start(self, job: Job) -> None:
        live = self._live[job.id] = _Live(job.client)
        kind, options, body = self.store.request(job.id)
        live.task = self._run(solve_job, (kind, options, body, self.limits), lambda progress: self._progress(job.id, live, progress))
        live.task.add_done_callback(lambda task: self._done(job, live, task))

    def _run(
        self, function: Callable, args: tuple, on_progress: Optional[Callable], executor: Optional[Executor] = None, urgent: bool = False
    ) -> Future:
        executor = executor or self.executor
        if hasattr(executor, "start"):
            return executor.start(function, args, on_progress=on_progress, time_limit=self.limits.seconds, urgent=urgent)
        return executor.submit(function, *args)

    def _progress(self, id: str, live: _Live, news: dict) -> None:
        with self._change:
            # It may have been deleted, and another may have its id by now.
            if self._live.get(id) is not live:
                return
            if not live.progress:
                self.store.set_started(id)
            live.surface = news.pop("surface", live.surface)
            live.progress = news
            live.changes += 1
            self._change.notify_all()

    def _done(self, job: Job, live: _Live, task: Future) -> None:
        with self._change:
            if self._closed or self._live.get(job.id) is not live:
                return
            del self._live[job.id]
            # The task knows its listeners: a circle that would keep request and result for a long while.
            live.task = None
            try:
                state, message, content = ending(task)
                self.store.finish(job.id, state, message, live.progress, content)
                self.store.tidy(self.limits.results, self.limits.result_bytes, self.limits.remembered, keep=job.id)
            except sqlite3.Error as error:
                log.error("the outcome of job %s cannot be kept: %s", job.id, error)
                text = "the server could not keep the result, its disk may be full; make room there and submit the job again"
                self._lost[job.id] = job._replace(state="failed", finished=time.time(), message=text, progress=live.progress)
            finally:
                self._change.notify_all()
