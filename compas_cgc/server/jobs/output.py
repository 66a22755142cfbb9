"""Return value of the function that solves a job."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

__all__ = ["JobOutput"]


class JobOutput(NamedTuple):
    """Return value of the function that solves a job."""

    message: str  # one sentence
    content: Optional[bytes] = None  # the packed result, None if there is none
    stopped: bool = False  # whether it ended early on request
    figures: Optional[dict] = None  # residuals of its last step, or the remedies of its refusal
