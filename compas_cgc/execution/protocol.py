"""Protocol of executors: what the server and studies ask of whatever runs their tasks.

The default is the :class:`~compas_cgc.execution.pool.WorkerPool`, processes of this machine; Dask is another,
:class:`~compas_cgc.execution.dask_executor.DaskExecutor`. A third implements this protocol, and may be given to
``create_app(executor=...)`` and ``run_study(executor=...)``.

A function that is run as a task is importable where it runs. While it runs it may call :func:`~compas_cgc.execution.worker.report`
to tell how far it is, and :func:`~compas_cgc.execution.worker.stop_wanted` to learn whether it should end early; the executor carries
both. Any other exception than those of :mod:`~compas_cgc.execution.future` is one of the executor itself.
"""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any
from typing import Callable
from typing import Optional
from typing import Protocol
from typing import Union

from .future import Task

__all__ = ["AnyExecutor", "TaskExecutor"]


class TaskExecutor(Protocol):
    """Runs tasks elsewhere.

    Attributes
    ----------
    workers
        Number of tasks that run at once; it may change.
    """

    @property
    def workers(self) -> int:
        """Number of tasks that run at once."""
        ...

    def start(
        self,
        function: Callable,
        args: tuple = (),
        kwargs: Optional[dict] = None,
        on_progress: Optional[Callable[[Any], object]] = None,
        time_limit: Optional[float] = None,
        urgent: bool = False,
    ) -> Task:
        """Queue a call and return at once.

        The task becomes *running* (``set_running_or_notify_cancel``) when a worker takes it. Its result is what the function returns;
        its exception is a :class:`~compas_cgc.execution.future.TaskError` where the function raised one,
        :class:`~compas_cgc.execution.future.TaskStopped` where it was ended by force, with the reason, and
        :class:`~compas_cgc.execution.future.WorkerDied` where its worker ended: a task that has begun is not begun again by
        the executor, as it may be what ended the worker (a poisoned task). ``task.stop(reason, grace)`` asks it to end; when it has
        not within the grace period, it is ended by force, or, where nobody can do that, whoever waits is told so.

        Parameters
        ----------
        function, args, kwargs
            The call.
        on_progress
            Called with what the task reports, from a thread of the executor, before its end is told.
        time_limit
            Seconds that it may run; then it is stopped.
        urgent
            Somebody waits for it: it goes before those that nobody does, yet not for ever.

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
        """Wait until tasks can be run; tell whether they can."""
        ...

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Close it, and end what it has started; may be called again. Tasks are finished first, or ended as stopped with cancel_futures."""
        ...


AnyExecutor = Union[TaskExecutor, Executor]
"""What runs tasks, or, as a plain executor, calls that cannot report or be stopped."""
