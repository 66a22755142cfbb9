"""Timing of one function."""

from __future__ import annotations

import time
from collections.abc import Callable

__all__ = ["best_of"]


def best_of(function: Callable[[], object], repeats: int = 3, budget: float = 2.0) -> float:
    """Return the shortest of several runs in seconds: what the machine can do when it is left alone.

    Parameters
    ----------
    function
        Called once more before, to load what it needs.
    repeats
        Fewest runs.
    budget
        Go on for this many seconds.
    """
    function()
    times: list[float] = []
    while len(times) < repeats or sum(times) < budget:
        started = time.perf_counter()
        function()
        times.append(time.perf_counter() - started)
        if len(times) >= 1000:
            break
    return min(times)
