"""Functions that a request waits for, run in a worker."""

from __future__ import annotations

from concurrent.futures import CancelledError
from functools import partial
from typing import Callable

from flask import current_app
from flask import request

from ..errors import Broken
from ..errors import Late
from ..errors import RequestProblem
from ..errors import Stopping
from ..jobs.engine import Jobs
from ..jobs.future import TaskError
from ..jobs.future import TaskStopped
from ..jobs.future import WorkerDied

__all__ = ["by_clerk", "in_worker", "jobs"]


def jobs() -> Jobs:
    """Return the engine of the running application."""
    return current_app.extensions["jobs"]


def in_worker(function: Callable, *args: object, mend: str) -> object:
    """Run a function in a worker as long as the client waits for it, and return what it returns.

    Parameters
    ----------
    function, args
        What to run; a :class:`RequestProblem` that it raises is raised here.
    mend
        What to do when it takes too long.

    Raises
    ------
    RequestProblem
        Of the function, or because of the worker.
    """
    return _waited(partial(jobs().call, function, *args, client=request.remote_addr or ""), function, mend)


def by_clerk(function: Callable, *args: object) -> object:
    """Run a function that reads or writes a file beside the solves, as :func:`in_worker` does."""
    return _waited(partial(jobs().convert, function, *args), function, "use a coarser mesh")


def _waited(run: Callable, function: Callable, mend: str) -> object:
    seconds = current_app.config["LIMITS"].blocking
    try:
        return run(gone=request.environ.get("waitress.client_disconnected", lambda: False))
    except CancelledError:
        raise Stopping("the server is stopping; ask again when it is back") from None
    except TimeoutError as error:
        if str(error) == "queued":
            raise Late(f"all workers were busy for {seconds:g} seconds; try again later, or serve with more --workers") from None
        raise Late(f"the work was stopped after {seconds:g} seconds; {mend}") from None
    except (WorkerDied, TaskStopped) as error:
        raise Broken(str(error)) from None
    except TaskError as error:
        if error.status is not None:
            problem = RequestProblem(str(error))
            problem.status = error.status
            raise problem from None
        current_app.logger.error("%s failed: %s", function.__name__, error.trace)
        raise Broken(f"the solver failed unexpectedly ({error.kind}); the log of the server says more") from None
