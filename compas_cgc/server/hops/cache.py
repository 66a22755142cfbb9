"""Cache of answers, least recently used first out."""

from __future__ import annotations

import hashlib
import json
import threading
from collections import OrderedDict
from typing import Optional

__all__ = ["Answers", "request_digest"]


class Answers:
    """Answers by the digest of their request; those not asked for the longest are dropped first.

    Parameters
    ----------
    largest
        Bytes of all the answers that are kept.
    """

    def __init__(self, largest: int):
        self.largest = largest
        self.size = 0
        self._kept: OrderedDict[bytes, bytes] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, digest: bytes) -> Optional[bytes]:
        """Return an answer, None if there is none."""
        with self._lock:
            if digest not in self._kept:
                return None
            self._kept.move_to_end(digest)
            return self._kept[digest]

    def put(self, digest: bytes, answer: bytes) -> None:
        """Keep an answer, unless it alone is larger than all may be."""
        if len(answer) > self.largest:
            return
        with self._lock:
            self.size += len(answer) - len(self._kept.pop(digest, b""))
            self._kept[digest] = answer
            while self.size > self.largest:
                self.size -= len(self._kept.popitem(last=False)[1])


def request_digest(uri: str, values: object, context: dict) -> bytes:
    """Return the digest of all that an answer depends on: the function, the values, the units and the tolerance."""
    return hashlib.sha256(json.dumps([uri, values, context], sort_keys=True).encode()).digest()
