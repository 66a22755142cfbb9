"""Limits of the server."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

__all__ = ["Limits"]


@dataclass(frozen=True)
class Limits:
    """Limits that keep a server responsive. A request beyond a limit is rejected with a message.

    Parameters
    ----------
    body
        Largest request [bytes].
    json
        Largest JSON request, packed arrays included [bytes].
    light
        Largest JSON request that the server process itself parses [bytes]. Larger requests, and those with many values, are
        parsed by a worker.
    depth
        Deepest nesting of lists and objects in JSON.
    containers
        Largest number of lists and objects in JSON; each takes up to 70 times its size in memory.
    values
        Largest number of values in JSON. Names of values are limited to half this number.
    vertices, faces
        Largest number of vertices and of faces of a mesh.
    steps
        Largest number of steps of a solve.
    queue
        Largest number of queued and running jobs.
    per_client
        Largest number of queued and running jobs of one client (an address, or a key if there are several).
    seconds
        Longest running time of a job [s].
    blocking
        Longest time that a request may wait for its solve [s]. Hops gives up after 100 s.
    grace
        Time between the request to stop a job and killing its worker [s].
    results
        Largest number of results that are kept.
    result_bytes
        Largest total size of the results that are kept [bytes].
    remembered
        Largest number of jobs that stay listed after their result was deleted.
    streams
        Largest number of simultaneous event streams and requests that wait for a job; each holds a thread.
    calls
        Largest number of simultaneous blocking solves; each holds a thread.
    reserved
        Number of additional workers for blocking solves only, so that these do not wait for jobs. The second and third take short
        ones only, so that these do not wait for long ones.
    connections
        Largest number of connections of one address; beyond it, the connections that have sent the least are closed.
    head_seconds
        Longest time in which the headers of a request must arrive [s].
    stall
        Time without progress of a request or response after which its connection is closed [s].
    slowest
        Slowest transfer of a request body [bytes/s]; slower ones are dropped after the time `stall`.
    conversions
        Largest number of large uploads, of files that are read and of files that are written at once; each holds a thread.
    memory
        Largest memory of a worker process [bytes], if the operating system reports it.
    file_seconds, file_memory
        Longest time [s] and largest memory of a process [bytes] for reading a file of a client.
    bodies
        Largest total size of request bodies in memory [bytes]; further ones wait.
    owner_bytes
        Largest total size of the waiting requests and results of one owner [bytes].
    free
        Free space of the disk below which no jobs are accepted [bytes].
    days
        Age beyond which finished jobs are deleted [days], None to keep them.

    Examples
    --------
    >>> from compas_cgc.server import Limits
    >>> isinstance(Limits(), Limits)
    True
    """

    body: int = 64 * 2**20
    json: int = 32 * 2**20
    light: int = 2 * 2**20
    depth: int = 32
    containers: int = 3_000_000
    values: int = 6_000_000
    vertices: int = 200_000
    faces: int = 400_000
    steps: int = 100_000
    queue: int = 256
    per_client: int = 128
    seconds: float = 3600.0
    blocking: float = 90.0
    grace: float = 1.0
    results: int = 200
    result_bytes: int = 2**30
    remembered: int = 5000
    streams: int = 16
    calls: int = 64
    reserved: int = 3
    connections: int = 128
    head_seconds: float = 10.0
    stall: float = 30.0
    slowest: int = 2000
    conversions: int = 32
    memory: int = 8 * 2**30
    file_seconds: float = 30.0
    file_memory: int = 2**30
    bodies: int = 128 * 2**20
    owner_bytes: int = 16 * 2**30
    free: int = 256 * 2**20
    days: Optional[float] = None

    @property
    def threads(self) -> int:
        """Number of serving threads that leaves one free for short requests at any time."""
        return self.streams + self.calls + 3 * self.conversions + 8
