"""What a function behind a component answers."""

from __future__ import annotations

import time
from typing import NamedTuple

__all__ = ["Reply", "spent"]


class Reply(NamedTuple):
    """What a function answers."""

    status: int
    values: list[dict]
    errors: list[str]
    warnings: list[str]
    spent: dict[str, float]  # seconds by part


def spent(started: float, read: float, solved: float) -> dict[str, float]:
    """Return the seconds of every part, of the times when it was over."""
    return {"decode": read - started, "solve": solved - read, "encode": time.perf_counter() - solved}
