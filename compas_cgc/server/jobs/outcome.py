"""Outcome of the task of a job."""

from __future__ import annotations

import logging
from concurrent.futures import CancelledError
from concurrent.futures import Future
from typing import NamedTuple
from typing import Optional

from ...execution.future import TaskError
from ...execution.future import TaskStopped
from .output import JobOutput

__all__ = ["CANCELLED", "Outcome", "outcome_of"]

CANCELLED = "cancelled by the client"
log = logging.getLogger(__name__)


class Outcome(NamedTuple):
    """How a job ended."""

    state: str  # succeeded, failed or cancelled
    message: str  # one sentence
    content: Optional[bytes] = None  # the packed result
    figures: Optional[dict] = None  # residuals of the last step, or the remedies of a refusal


def outcome_of(task: Future) -> Outcome:
    """Return the outcome of a finished task."""
    reason = getattr(task, "stop_reason", None)
    try:
        output: JobOutput = task.result()
    except CancelledError:
        return Outcome("cancelled", "cancelled before it started")
    except TaskStopped as error:
        return Outcome("cancelled" if str(error) == CANCELLED else "failed", f"stopped: {error}")
    except TaskError as error:
        log.error("a job failed: %s", error.trace)
        return Outcome("failed", f"the solver failed unexpectedly ({error.kind}); see the log of the server")
    except Exception as error:
        return Outcome("failed", str(error))
    # The stop request may arrive after the task has ended.
    if not output.stopped or reason is None:
        return Outcome("succeeded" if output.content is not None else "failed", output.message, output.content, output.figures)
    if reason == CANCELLED:
        return Outcome("cancelled", output.message, output.content, output.figures)
    return Outcome("failed", f"stopped: {reason}", output.content, output.figures)
