"""What the solve of a job returns."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

__all__ = ["JobOutput"]


class JobOutput(NamedTuple):
    """What the function that solves a job returns."""

    message: str  # one sentence
    content: Optional[bytes] = None  # the packed result, None if there is none
    stopped: bool = False  # it ended early because it was asked to
    figures: Optional[dict] = None  # of its last step, as a report tells them; the last report may be of an earlier one
