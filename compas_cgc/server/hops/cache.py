"""Least recently used cache of responses."""

from __future__ import annotations

import hashlib
import json
import threading
from collections import OrderedDict
from typing import Optional

__all__ = ["Answers", "request_digest"]


class Answers:
    """Responses by the digest of their request; the least recently used are dropped first.

    Parameters
    ----------
    largest
        Largest total size of the responses [bytes].
    """

    def __init__(self, largest: int):
        self.largest = largest
        self.size = 0
        self._kept: OrderedDict[bytes, bytes] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, digest: bytes) -> Optional[bytes]:
        """Return the response, None if it is not in the cache."""
        with self._lock:
            if digest not in self._kept:
                return None
            self._kept.move_to_end(digest)
            return self._kept[digest]

    def put(self, digest: bytes, answer: bytes) -> None:
        """Store a response, unless it alone exceeds the size of the cache."""
        if len(answer) > self.largest:
            return
        with self._lock:
            self.size += len(answer) - len(self._kept.pop(digest, b""))
            self._kept[digest] = answer
            while self.size > self.largest:
                self.size -= len(self._kept.popitem(last=False)[1])


def request_digest(owner: str, uri: str, values: object, context: dict) -> bytes:
    """Return the digest of everything that determines a response: owner, function, values, units and tolerance."""
    return hashlib.sha256(json.dumps([owner, uri, values, context], sort_keys=True).encode()).digest()
