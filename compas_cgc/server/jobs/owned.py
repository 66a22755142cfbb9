"""Jobs of one owner: a view of the engine without the jobs of other owners."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Sequence
from typing import IO
from typing import Optional
from typing import Union

from ..errors import NotFound
from .engine import Jobs
from .store import Job
from .store import owned_id

__all__ = ["OwnedJobs"]


class OwnedJobs:
    """The jobs of an owner; ids of other jobs are unknown. For the methods, see :class:`~compas_cgc.server.jobs.engine.Jobs`.

    Parameters
    ----------
    jobs
        The engine.
    owner
        Name of the owner, empty for the only owner of a server without keys.
    """

    def __init__(self, jobs: Jobs, owner: str):
        self._jobs = jobs
        self._owner = owner
        self.calls = jobs.calls
        self.executor = jobs.executor

    def _id(self, id: str) -> str:
        if ":" in id:
            raise NotFound(f"there is no job {id:.80}; it was deleted or never existed")
        return owned_id(self._owner, id)

    def submit(
        self, kind: str, body: Union[bytes, IO[bytes]], options: Optional[dict] = None, id: Optional[str] = None, client: str = ""
    ) -> tuple[Job, bool]:
        """Accept a job and start it when a worker is free."""
        job, new = self._jobs.submit(kind, body, options, id, client, self._owner)
        return job.shown(), new

    def get(self, id: str) -> Job:
        """Return a job with its current progress."""
        return self._jobs.get(self._id(id)).shown()

    def page(self, limit: int = 100, offset: int = 0, state: Optional[str] = None) -> tuple[Sequence[Job], int]:
        """Return one page of the jobs, newest first, and their total number; optionally only those in one state."""
        found, total = self._jobs.page(limit, offset, state, self._owner)
        return [job.shown() for job in found], total

    def positions(self) -> dict[str, int]:
        """Return the position in the queue of every queued job of the owner, counted from 1 including jobs of others."""
        prefix = owned_id(self._owner, "")
        return {id[len(prefix) :]: place for id, place in self._jobs.positions().items() if id.startswith(prefix)}

    def result(self, id: str) -> bytes:
        """Return the packed result of a job."""
        return self._jobs.result(self._id(id))

    def surface(self, id: str) -> Optional[bytes]:
        """Return the current vertices of a running live job."""
        return self._jobs.surface(self._id(id))

    def arrived(self, id: str) -> Optional[bytes]:
        """Return the solved vertices of a live job before its verdict."""
        return self._jobs.arrived(self._id(id))

    def judged(self, id: str) -> Optional[dict]:
        """Return the verdict on the surface of a live job before it is measured and stored."""
        return self._jobs.judged(self._id(id))

    def cancel(self, id: str) -> Job:
        """Request that a job stop."""
        return self._jobs.cancel(self._id(id)).shown()

    def delete(self, id: str, after: float = 0.0) -> None:
        """Stop a job and delete it, at once or unless it is requested within a time [s]."""
        self._jobs.delete(self._id(id), after)

    def wait(self, id: str, seconds: float) -> Job:
        """Wait until a job is finished, at most for the given time [s], and return it."""
        return self._jobs.wait(self._id(id), seconds).shown()

    def follow(self, id: str, heartbeat: float = 15.0) -> Iterator[Optional[Job]]:
        """Yield a job after every change until it is finished, and None after every `heartbeat` seconds without a change."""
        return (job and job.shown() for job in self._jobs.follow(self._id(id), heartbeat))
