"""Blocking calls: functions that a request waits for, run in a worker."""

from __future__ import annotations

from concurrent.futures import CancelledError
from functools import partial
from typing import Any
from typing import Callable

from flask import current_app
from flask import request

from ...errors import sentence_of
from ...execution.future import LimitExceeded
from ...execution.future import TaskError
from ...execution.future import TaskStopped
from ...execution.future import WorkerDied
from ..errors import GatewayTimeout
from ..errors import RequestError
from ..errors import ServerStopping
from ..errors import Unprocessable
from ..errors import WorkerFailed
from ..jobs.owned import OwnedJobs
from ..security import client_name
from ..security import owner

__all__ = ["jobs", "run_in_reader", "run_in_worker", "run_in_writer"]


def jobs() -> OwnedJobs:
    """Return the jobs of the owner of the request."""
    return OwnedJobs(current_app.extensions["jobs"], owner())


def run_in_worker(function: Callable, *args: object, hint: str, alike: str) -> Any:
    """Run a function in a worker and return its result; the function is stopped when the client disconnects.

    Parameters
    ----------
    function, args
        The function and its arguments. A :class:`RequestError` that it raises is passed on.
    hint
        Remedy that the error names when a limit is exceeded.
    alike
        Which calls of a client are expected to take about as long.

    Raises
    ------
    RequestError
        If the function raises one, the worker fails or the time limit is exceeded.
    """
    return _waited(partial(jobs().calls.call, function, *args, alike=alike), function, hint)


def run_in_reader(function: Callable, *args: object) -> Any:
    """Run a function that reads what a client sent in a process with limits of its own, as :func:`run_in_worker` does."""
    return _waited(partial(jobs().calls.read, function, *args), function, "send a smaller file, or a coarser mesh")


def run_in_writer(function: Callable, *args: object) -> Any:
    """Run a function that writes a result as a file, as :func:`run_in_worker` does, without waiting for solves and uploads."""
    return _waited(partial(jobs().calls.write, function, *args), function, "use a coarser mesh")


def _waited(run: Callable, function: Callable, hint: str) -> Any:
    seconds = current_app.config["LIMITS"].blocking
    try:
        return run(client=client_name(), disconnected=request.environ.get("waitress.client_disconnected", lambda: False))
    except CancelledError:
        raise ServerStopping("the server is shutting down; try again after it has restarted") from None
    except TimeoutError as error:
        if str(error) == "queued":
            raise GatewayTimeout(f"all workers were busy for {seconds:g} s; try again later, or use more --workers") from None
        raise GatewayTimeout(f"the calculation was stopped after {seconds:g} s; {hint}") from None
    except LimitExceeded as error:
        raise Unprocessable(f"the calculation was stopped because {error}; {hint}") from None
    except (WorkerDied, TaskStopped) as error:
        raise WorkerFailed(str(error)) from None
    except TaskError as error:
        if error.status is not None:
            raise _refused(error) from None
        current_app.logger.error("%s failed: %s", function.__name__, error.trace)
        raise WorkerFailed(f"the solver failed unexpectedly ({error.kind}); see the log of the server") from None


def _refused(error: TaskError) -> RequestError:
    # A separate frame avoids a reference cycle between error and frame, which would keep the request in memory.
    failure = RequestError(sentence_of(error))
    failure.status = error.status or failure.status
    return failure
