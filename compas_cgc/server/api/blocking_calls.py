"""Blocking calls: functions that a request waits for, run in a worker."""

from __future__ import annotations

from concurrent.futures import CancelledError
from functools import partial
from typing import Any
from typing import Callable

from flask import current_app
from flask import request

from ...execution.future import TaskError
from ...execution.future import TaskStopped
from ...execution.future import WorkerDied
from ..errors import GatewayTimeout
from ..errors import RequestError
from ..errors import ServerStopping
from ..errors import WorkerFailed
from ..jobs.engine import Jobs

__all__ = ["run_in_io_pool", "run_in_worker", "jobs"]


def jobs() -> Jobs:
    """Return the engine of the running application."""
    return current_app.extensions["jobs"]


def run_in_worker(function: Callable, *args: object, hint: str) -> Any:
    """Run a function in a worker as long as the client waits for it, and return what it returns.

    Parameters
    ----------
    function, args
        What to run; a :class:`RequestError` that it raises is raised here.
    hint
        What to do when it takes too long.

    Raises
    ------
    RequestError
        Of the function, or because of the worker.
    """
    return _waited(partial(jobs().calls.call, function, *args), function, hint)


def run_in_io_pool(function: Callable, *args: object) -> Any:
    """Run a function that reads or writes a file apart from the solves, as :func:`run_in_worker` does."""
    return _waited(partial(jobs().calls.convert, function, *args), function, "use a coarser mesh")


def _waited(run: Callable, function: Callable, hint: str) -> Any:
    seconds = current_app.config["LIMITS"].blocking
    try:
        return run(disconnected=request.environ.get("waitress.client_disconnected", lambda: False))
    except CancelledError:
        raise ServerStopping("the server is stopping; ask again when it is back") from None
    except TimeoutError as error:
        if str(error) == "queued":
            raise GatewayTimeout(f"all workers were busy for {seconds:g} seconds; try again later, or serve with more --workers") from None
        raise GatewayTimeout(f"the work was stopped after {seconds:g} seconds; {hint}") from None
    except (WorkerDied, TaskStopped) as error:
        raise WorkerFailed(str(error)) from None
    except TaskError as error:
        if error.status is not None:
            raise _refused(error) from None
        current_app.logger.error("%s failed: %s", function.__name__, error.trace)
        raise WorkerFailed(f"the solver failed unexpectedly ({error.kind}); the log of the server says more") from None


def _refused(error: TaskError) -> RequestError:
    # Not in the frame that raises it: an error that a frame knows which it knows would keep the request for a long while.
    failure = RequestError(str(error))
    failure.status = error.status or failure.status
    return failure
