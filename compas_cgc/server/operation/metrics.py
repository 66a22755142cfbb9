"""Metrics of a server in the text format of Prometheus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from prometheus_client import CollectorRegistry
from prometheus_client import Counter
from prometheus_client import Histogram
from prometheus_client import ProcessCollector
from prometheus_client import generate_latest
from prometheus_client.metrics_core import CounterMetricFamily
from prometheus_client.metrics_core import GaugeMetricFamily
from prometheus_client.metrics_core import Metric

from ..._version import __version__
from ..jobs.engine import Jobs

__all__ = ["Metrics"]

BUCKETS = (0.005, 0.02, 0.1, 0.5, 1.0, 2.0, 5.0, 20.0, 90.0)  # upper bounds of durations [s]; calls end at 90 s
METHODS = ("GET", "HEAD", "POST", "DELETE", "OPTIONS")  # clients may send any word
WORKER_STATES = ("starting", "idle", "busy")


class Metrics:
    """Counters of requests, and figures of the engine at the time of a scrape.

    Parameters
    ----------
    jobs
        The engine.
    """

    def __init__(self, jobs: Jobs):
        self._registry = CollectorRegistry()
        self._requests = Counter("cgc_requests", "Requests", ("method", "address", "status"), registry=self._registry)
        self._seconds = Histogram("cgc_request_seconds", "Duration of requests [s]", ("address",), buckets=BUCKETS, registry=self._registry)
        ProcessCollector(registry=self._registry)
        self._registry.register(_Engine(jobs))

    def count(self, method: str, address: str, status: int, seconds: float) -> None:
        """Count a request; `address` is the pattern of the route, of which there are few."""
        self._requests.labels(method if method in METHODS else "other", address, status).inc()
        self._seconds.labels(address).observe(seconds)

    def text(self) -> bytes:
        """Return all metrics."""
        return generate_latest(self._registry)


class _Engine:
    """Collector of the figures of an engine."""

    def __init__(self, jobs: Jobs):
        self._jobs = jobs

    def describe(self) -> list:
        """Return nothing: the names are known only when they are collected."""
        return []

    def collect(self) -> Iterator[Metric]:
        """Yield the metrics of the engine."""
        jobs = self._jobs
        yield _gauges("cgc_info", "Version of the program", "version", {__version__: 1})
        yield _gauges("cgc_jobs", "Unfinished jobs", "state", jobs.unfinished())
        finished = CounterMetricFamily("cgc_jobs_finished", "Jobs that ended since the start of the server", labels=["state"])
        for state in ("succeeded", "failed", "cancelled"):
            finished.add_metric([state], jobs.finished[state])
        yield finished
        yield CounterMetricFamily("cgc_job_seconds", "Total running time of the jobs that ended [s]", value=jobs.seconds)
        yield _gauges("cgc_calls", "Requests that wait for a worker", "kind", {kind: own.used for kind, own in jobs.calls.slots.items()})
        executor: Any = jobs.executor
        health: dict = executor.health() if hasattr(executor, "health") else {}
        yield _gauges("cgc_workers", "Workers", "state", {state: health[state] for state in WORKER_STATES if state in health})
        yield GaugeMetricFamily("cgc_tasks_waiting", "Tasks that wait for a worker", value=health.get("waiting", 0))
        yield CounterMetricFamily("cgc_workers_replaced", "Workers that ended and were replaced", value=health.get("replaced", 0))
        yield GaugeMetricFamily("cgc_store_bytes", "Size of the store [bytes]", value=jobs.store.size())
        free = jobs.store.free()
        if free is not None:
            yield GaugeMetricFamily("cgc_disk_free_bytes", "Free space of the disk of the store [bytes]", value=free)


def _gauges(name: str, text: str, label: str, values: dict) -> GaugeMetricFamily:
    found = GaugeMetricFamily(name, text, labels=[label])
    for key, value in values.items():
        found.add_metric([key], value)
    return found
