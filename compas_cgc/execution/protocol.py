"""Protocol of executors that run the tasks of the server and of studies.

The default is the :class:`~compas_cgc.execution.pool.WorkerPool` with local processes. The
:class:`~compas_cgc.execution.dask_executor.DaskExecutor` runs tasks on a Dask cluster. Other executors can implement this protocol and
be passed to ``create_app(executor=...)`` and ``run_study(executor=...)``.

The function of a task must be importable in the worker. It may call :func:`~compas_cgc.execution.worker.report` to report progress and
:func:`~compas_cgc.execution.worker.stop_wanted` to check for a stop request; the executor transmits both. Exceptions other than those of
:mod:`~compas_cgc.execution.future` come from the executor itself.
"""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any
from typing import Callable
from typing import Optional
from typing import Protocol
from typing import Union

from .future import Arguments
from .future import Task

__all__ = ["AnyExecutor", "TaskExecutor"]


class TaskExecutor(Protocol):
    """Executor of tasks in other processes.

    Attributes
    ----------
    workers
        Number of simultaneous tasks; it may change.
    """

    @property
    def workers(self) -> int:
        """Number of tasks that run at once."""
        ...

    def start(
        self,
        function: Callable,
        args: Arguments = (),
        kwargs: Optional[dict] = None,
        on_progress: Optional[Callable[[Any], object]] = None,
        time_limit: Optional[float] = None,
        urgent: bool = False,
        client: str = "",
        memory_limit: Optional[int] = None,
        alike: str = "",
    ) -> Task:
        """Queue a call and return at once.

        The task becomes *running* (``set_running_or_notify_cancel``) when a worker takes it. Its result is the return value of the
        function. Its exception is a :class:`~compas_cgc.execution.future.TaskError` if the function raised one,
        :class:`~compas_cgc.execution.future.TaskStopped` with the reason if it was ended by force, and
        :class:`~compas_cgc.execution.future.WorkerDied` if its worker ended. The executor does not restart a started task, as it may
        have crashed the worker. ``task.stop(reason, grace)`` requests that the task stop. If it does not within the grace period, it
        is ended by force or, if that is impossible, reported as stopped.

        Parameters
        ----------
        function, args, kwargs
            The call.
        on_progress
            Called with the reports of the task, from a thread of the executor, before the end of the task is reported.
        time_limit
            Time limit after which the task is stopped [s].
        urgent
            Whether a client waits for it: it then has priority, but does not overtake other tasks indefinitely.
        client
            Name of the client. Workers are shared among clients.
        memory_limit
            Largest memory of its process [bytes], enforced by executors that can measure it.
        alike
            Name of the calls that are expected to take about as long. Default: the client.

        Raises
        ------
        RuntimeError
            If the executor is closed.
        """
        ...

    def health(self) -> dict:
        """Return ``workers``, ``starting``, ``idle``, ``busy``, ``waiting`` and ``replaced`` as numbers, at once."""
        ...

    def wait_until_ready(self, timeout: Optional[float] = None) -> bool:
        """Wait until tasks can run; return whether they can."""
        ...

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Close the executor and its processes; may be called again. Tasks are finished first, or stopped with `cancel_futures`."""
        ...


AnyExecutor = Union[TaskExecutor, Executor]
"""Executor of tasks, or a plain executor of calls without reports and stop requests."""
