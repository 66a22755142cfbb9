"""Lanes: which of the waiting tasks a free worker takes, so that no client and no kind of task holds all workers."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable
from collections.abc import Sequence
from typing import Optional

from .future import Task

__all__ = ["ANY", "CALLS", "SHORT", "SHORT_SECONDS", "Lanes"]

# Lanes by the tasks that they take: all, urgent ones, urgent ones that are expected to be short.
ANY, CALLS, SHORT = "any", "calls", "short"
SHORT_SECONDS = 0.5  # a call that takes longer leaves the short lane when another call waits for it
SHORT_LANES = 2
MEMORY = 600.0  # seconds for which a client counts as active, and its calls as long after a long one


class Lanes:
    """The policy of an executor.

    Parameters
    ----------
    workers
        Number of lanes that take any task.
    reserved
        Number of further lanes for urgent tasks. The first takes all of them, the second and third short ones only, and any others all.
    """

    def __init__(self, workers: int, reserved: int = 0):
        short = min(SHORT_LANES, max(0, reserved - 1))
        self.kinds = [ANY] * workers + [CALLS] * (reserved - short) + [SHORT] * short
        self._seen: dict[str, float] = {}  # last submission by client
        self._served: dict[str, float] = {}  # last start by client
        self._long: dict[str, float] = {}  # last long call of those alike
        self._short: dict[str, float] = {}  # last short call of those alike, if no long one followed

    def submitted(self, task: Task) -> None:
        """Note a new task; a call does not begin on a short lane if the last one alike was long."""
        now = task.since
        for memory in (self._seen, self._served, self._long, self._short):
            for name in [name for name, moment in memory.items() if now - moment > MEMORY]:
                del memory[name]
        self._seen[task.client] = now
        task.long = task.long or task.alike in self._long

    def ended(self, task: Task, seconds: float) -> None:
        """Note how long a call took."""
        if task.urgent and seconds <= SHORT_SECONDS:
            self._long.pop(task.alike, None)
            self._short[task.alike] = time.monotonic()
        elif task.urgent:
            self._short.pop(task.alike, None)

    def moved(self, task: Task) -> None:
        """Note that a call turned out to be long."""
        task.long = True
        self._long[task.alike] = time.monotonic()
        self._short.pop(task.alike, None)

    def pick(self, lane: str, waiting: Sequence[Task], running: Iterable[Task], free: int = 1) -> Optional[Task]:
        """Return the task that a free lane takes: of the client that holds the fewest lanes, and was served the longest ago.

        Short lanes prefer calls that are known to be short. If there are several, the last free one takes no others, so that these
        do not wait for calls that turn out to be long.

        Parameters
        ----------
        lane
            Kind of the lane.
        waiting
            Tasks in the order of :func:`~compas_cgc.execution.future.place`.
        running
            Tasks on the lanes that take any task.
        free
            Number of free lanes of this kind.
        """
        held = Counter(task.client for task in running)
        lanes = self.kinds.count(ANY)
        # A client alone may use all lanes.
        most = max(1, lanes - 1) if len(self._seen) > 1 else lanes
        known = lane == SHORT and free == 1 and self.kinds.count(SHORT) > 1
        open_to = [
            task
            for task in waiting
            if self._admits(lane, task) and (lane != ANY or held[task.client] < most) and (task.alike in self._short or not known)
        ]
        # The first in the queue tells whether it is the turn of urgent tasks.
        turn = [task for task in open_to if task.urgent == open_to[0].urgent]

        def order(task: Task) -> tuple[bool, int, float]:
            return lane == SHORT and task.alike not in self._short, held[task.client], self._served.get(task.client, 0.0)

        found = min(turn, key=order, default=None)
        if found is not None:
            self._served[found.client] = time.monotonic()
        return found

    def wants_short_lane(self, waiting: Iterable[Task]) -> bool:
        """Check whether a call waits that may take the short lane."""
        return any(self._admits(SHORT, task) for task in waiting)

    def _admits(self, lane: str, task: Task) -> bool:
        return lane == ANY or (task.urgent and (lane == CALLS or not task.long))
