"""Reply of the function of a component."""

from __future__ import annotations

import time
from typing import NamedTuple

__all__ = ["Reply", "spent"]


class Reply(NamedTuple):
    """Reply of a function."""

    status: int
    values: list[dict]
    errors: list[str]
    warnings: list[str]
    spent: dict[str, float]  # time by stage [s]


def spent(started: float, read: float, solved: float) -> dict[str, float]:
    """Return the time of every stage [s] from the times at their ends."""
    return {"decode": read - started, "solve": solved - read, "encode": time.perf_counter() - solved}
