"""Shares: slots that clients hold while they wait, of which no client can take all."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import Busy

__all__ = ["ByteBudget", "Shares"]

GREED = 2  # slots that a client may hold for each one that is free


class Shares:
    """Slots with a dynamic threshold: the fewer are free, the fewer more a client may hold.

    A client alone may hold two thirds of all, and any number of greedy clients leave some free for the next. After A. K. Choudhury
    and E. L. Hahne, Dynamic queue length thresholds for shared-memory packet switches, IEEE/ACM Transactions on Networking 6 (1998),
    doi:10.1109/90.664262.

    Parameters
    ----------
    total
        Number of slots.
    """

    def __init__(self, total: int):
        self._total = total
        self._held: Counter = Counter()
        self._lock = threading.Lock()

    @property
    def used(self) -> int:
        """Number of slots that are held."""
        return sum(self._held.values())

    def acquire(self, client: str) -> bool:
        """Take a slot if the client may have another."""
        with self._lock:
            free = self._total - sum(self._held.values())
            if self._held[client] >= GREED * free:
                return False
            self._held[client] += 1
            return True

    def release(self, client: str) -> None:
        """Return a slot."""
        with self._lock:
            self._held[client] -= 1
            if self._held[client] <= 0:
                del self._held[client]


class ByteBudget:
    """Bytes of request bodies in memory; who needs more waits.

    Parameters
    ----------
    total
        Bytes. A single body larger than that is let in alone.
    patience
        Seconds to wait.
    small
        Size of bodies [bytes] up to which any number may wait.
    slots
        Largest number of other bodies that wait or are held.
    """

    def __init__(self, total: int, patience: float, small: int, slots: int):
        self._total, self._patience, self._small = total, patience, small
        self._slots = Shares(slots)
        self._used = 0
        self._change = threading.Condition()

    @contextmanager
    def held(self, size: int, client: str = "") -> Iterator[None]:
        """Hold some bytes of a client within a block.

        Raises
        ------
        Busy
            If too many bodies wait, of this client or in all, or others hold the bytes for too long.
        """
        busy = Busy("the server is busy with other large requests; try again in a few seconds", 5.0)
        large = size > self._small
        if large and not self._slots.acquire(client):
            raise busy
        try:
            with self._change:
                if not self._change.wait_for(lambda: not self._used or self._used + size <= self._total, self._patience):
                    raise busy
                self._used += size
            try:
                yield
            finally:
                with self._change:
                    self._used -= size
                    self._change.notify_all()
        finally:
            if large:
                self._slots.release(client)
