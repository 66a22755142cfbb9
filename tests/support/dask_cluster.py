"""A Dask scheduler and workers in processes of their own on this machine, to be killed."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager

# As a worker of another version of the package would be.
OTHER = "import compas_cgc._version as own; own.__version__ = '0.0.1'; from distributed.cli.dask_worker import main; main()"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    """Processes by what they are; everything that was started is ended with the block."""

    def __init__(self) -> None:
        self.port = free_port()
        self.scheduler: subprocess.Popen = self._start(
            "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port)
        )
        self.workers: list[subprocess.Popen] = []

    @property
    def address(self) -> str:
        return f"dask://127.0.0.1:{self.port}"

    def _start(self, *arguments: str) -> subprocess.Popen:
        settings = {"DASK_DISTRIBUTED__ADMIN__LOG_LENGTH": "100", "OMP_NUM_THREADS": "1"}
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        extra = ["--no-dashboard"] if "scheduler" in arguments[1] else []
        return subprocess.Popen([sys.executable, *arguments, *extra], env={**os.environ, **settings}, start_new_session=True, **quiet)

    def add_worker(self, nanny: bool = False, other_version: bool = False) -> subprocess.Popen:
        how = ["-c", OTHER] if other_version else ["-m", "distributed.cli.dask_worker"]
        options = ["--nthreads", "1", "--no-dashboard", "--nanny" if nanny else "--no-nanny", "--death-timeout", "60"]
        process = self._start(*how, f"tcp://127.0.0.1:{self.port}", *options)
        self.workers.append(process)
        return process

    def restart_scheduler(self) -> None:
        """Start another scheduler at the address of one that was killed."""
        self.scheduler.wait()
        self.scheduler = self._start("-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port))

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            kill(process)


def kill(process: subprocess.Popen) -> None:
    """Kill a process with those that it has started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass
    process.wait()


@contextmanager
def dask_cluster(workers: int = 2, **how):
    """Run a scheduler with workers."""
    cluster = Cluster()
    try:
        for _ in range(workers):
            cluster.add_worker(**how)
        yield cluster
    finally:
        cluster.end()


def until(condition, seconds: float = 300.0) -> None:
    """Wait for something."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it does not come about"
        time.sleep(0.02)
