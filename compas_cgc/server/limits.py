"""How much the server takes on."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Limits"]


@dataclass(frozen=True)
class Limits:
    """Limits that keep a server answering, each refused with a sentence of its own.

    Parameters
    ----------
    body
        Largest request in bytes.
    json
        Largest request in JSON in bytes, what is packed in it included.
    light
        Largest request in JSON in bytes that is parsed by the server itself. Larger ones, and those of many values, are parsed by
        a process that nobody else waits for.
    depth
        Deepest nesting of lists and objects in JSON.
    containers
        Most lists and objects in JSON; each takes up to 70 times of its bytes in memory.
    values
        Most values in JSON, and half as many names of values.
    vertices, faces
        Largest mesh.
    steps
        Most steps of a solve.
    queue
        Most jobs that wait or run.
    per_client
        Most jobs of one client (an address, or a key where there are several) that wait or run.
    seconds
        Longest running time of a job.
    blocking
        Longest time that a request may wait for its solve. Hops gives up after 100 seconds.
    grace
        Seconds between being asked to stop and being killed.
    results
        Most finished jobs that are kept.
    result_bytes
        Most bytes of results that are kept.
    remembered
        Most jobs that are remembered after their result is gone.
    streams
        Most event streams and requests that wait for a job at once; each holds a thread.
    calls
        Most blocking solves at once; each holds a thread.
    reserved
        Workers besides the others that take nothing but blocking solves, so that no job keeps these waiting.
    connections
        Most connections of one address; of more those are closed that sent the least of a request.
    head_seconds
        Longest time that the head of a request may take to arrive.
    conversions
        Most files that are read or written at once; each holds a thread.

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
    calls: int = 32
    reserved: int = 1
    connections: int = 128
    head_seconds: float = 10.0
    conversions: int = 8

    @property
    def threads(self) -> int:
        """Serving threads needed so that short requests are never kept waiting."""
        return self.streams + self.calls + self.conversions + 8
