"""Memory of the server: what large requests took is given back to the system."""

from __future__ import annotations

import ctypes
import sys

__all__ = ["give_large_blocks_back"]

# Of mallopt, in malloc.h of the GNU C library.
TRIM_THRESHOLD, MMAP_THRESHOLD, ARENA_MAX = -1, -3, -8
LARGE = 2**21  # bytes; to fetch each block of a usual request from the system anew would take as long as to work on it
LEFT = 2**23  # bytes that are free at the end of the heap, from which they go back


def give_large_blocks_back() -> bool:
    """Have large blocks given back as soon as they are free; tell whether the system can be told so.

    Left to itself the GNU C library raises the size from which it does so to that of the largest block so far, and keeps what is
    smaller for each of the threads that ever had one: a server of many threads would hold all that its largest requests took.
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):  # another C library
        return False
    return bool(mallopt(MMAP_THRESHOLD, LARGE) and mallopt(TRIM_THRESHOLD, LEFT) and mallopt(ARENA_MAX, 2))
