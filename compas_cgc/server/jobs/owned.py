"""Jobs of one owner: the engine as a client sees it, in which other owners' jobs do not exist."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Sequence
from typing import Optional

from ..errors import NotFound
from .engine import Jobs
from .store import Job
from .store import owned_id

__all__ = ["OwnedJobs"]


class OwnedJobs:
    """The jobs of an owner; every id is looked up within them, see :class:`~compas_cgc.server.jobs.engine.Jobs` for the methods.

    Parameters
    ----------
    jobs
        The engine.
    owner
        Name, empty for the only owner of a server without keys.
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
        self, kind: str, body: bytes, options: Optional[dict] = None, id: Optional[str] = None, client: str = ""
    ) -> tuple[Job, bool]:
        """Accept a job and start it when a worker is free."""
        job, new = self._jobs.submit(kind, body, options, id, client, self._owner)
        return job.shown(), new

    def get(self, id: str) -> Job:
        """Return a job with its present progress."""
        return self._jobs.get(self._id(id)).shown()

    def page(self, limit: int = 100, offset: int = 0, state: Optional[str] = None) -> tuple[Sequence[Job], int]:
        """Return so many jobs after the newest ones, all or those in a state, and the number of all of them."""
        found, total = self._jobs.page(limit, offset, state, self._owner)
        return [job.shown() for job in found], total

    def positions(self) -> dict[str, int]:
        """Return the place in the queue of every waiting job of the owner, from 1; jobs of others count."""
        prefix = owned_id(self._owner, "")
        return {id[len(prefix) :]: place for id, place in self._jobs.positions().items() if id.startswith(prefix)}

    def result(self, id: str) -> bytes:
        """Return the packed result of a job."""
        return self._jobs.result(self._id(id))

    def surface(self, id: str) -> Optional[bytes]:
        """Return the present vertices of a running live job."""
        return self._jobs.surface(self._id(id))

    def arrived(self, id: str) -> Optional[bytes]:
        """Return the vertices of the final surface of a live job before it is judged."""
        return self._jobs.arrived(self._id(id))

    def judged(self, id: str) -> Optional[dict]:
        """Return the verdict on the surface of a live job before it is measured and stored."""
        return self._jobs.judged(self._id(id))

    def cancel(self, id: str) -> Job:
        """Ask a job to stop."""
        return self._jobs.cancel(self._id(id)).shown()

    def delete(self, id: str) -> None:
        """Stop a job and delete it."""
        self._jobs.delete(self._id(id))

    def wait(self, id: str, seconds: float) -> Job:
        """Return a job as soon as it is over, or as it is after some seconds."""
        return self._jobs.wait(self._id(id), seconds).shown()

    def follow(self, id: str, heartbeat: float = 15.0) -> Iterator[Optional[Job]]:
        """Yield a job after every change until it is over, and None when nothing happened for a while."""
        return (job and job.shown() for job in self._jobs.follow(self._id(id), heartbeat))
