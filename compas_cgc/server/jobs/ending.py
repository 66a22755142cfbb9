"""How a task ended, in words."""

from __future__ import annotations

import logging
from concurrent.futures import CancelledError
from concurrent.futures import Future
from typing import NamedTuple
from typing import Optional

from .future import TaskError
from .future import TaskStopped

__all__ = ["CANCELLED", "Ending", "ending"]

CANCELLED = "it was cancelled"

log = logging.getLogger(__name__)


class Ending(NamedTuple):
    """How a job ended."""

    state: str  # succeeded, failed or cancelled
    message: str  # one sentence
    content: Optional[bytes] = None  # packed result


def ending(task: Future) -> Ending:
    """Return how a task that is over ended; it handed back an :class:`~compas_cgc.server.api.serialization.Outcome`."""
    wish = getattr(task, "stop_reason", None)
    try:
        outcome = task.result()
    except CancelledError:
        return Ending("cancelled", "cancelled before it began")
    except TaskStopped as error:
        return Ending("cancelled" if str(error) == CANCELLED else "failed", f"stopped: {error}")
    except TaskError as error:
        log.error("a job failed: %s", error.trace)
        return Ending("failed", f"the solver failed unexpectedly ({error.kind}); the log of the server says more")
    except Exception as error:
        return Ending("failed", str(error))
    # The wish may come when it has just ended by itself.
    if outcome.stopped and wish is not None:
        cancelled = wish == CANCELLED
        return Ending("cancelled" if cancelled else "failed", outcome.message if cancelled else f"stopped: {wish}", outcome.content)
    return Ending("succeeded" if outcome.content is not None else "failed", outcome.message, outcome.content)
