"""Timing of one function."""

from __future__ import annotations

import time
from collections.abc import Callable

__all__ = ["best_of"]


def best_of(function: Callable[[], object], repeats: int = 3, budget: float = 2.0) -> float:
    """Return the shortest time of several runs [s], which is least affected by other load.

    Parameters
    ----------
    function
        Function to time; one additional call before loads everything it needs.
    repeats
        Minimum number of runs.
    budget
        Time for which runs are repeated [s].
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
