"""Memory of the server: what large requests took is given back to the system."""

from __future__ import annotations

import ctypes
import gc
import sys
import threading
import time

__all__ = ["give_back", "set_loaded_aside"]

# Of mallopt, in malloc.h of the GNU C library.
TRIM_THRESHOLD, MMAP_THRESHOLD, ARENA_MAX = -1, -3, -8
LARGE = 2**21  # bytes; to fetch each block of a usual request from the system anew would take as long as to work on it
LEFT = 2**23  # bytes that are free at the end of the heap, from which they go back
PAUSE = 5.0  # seconds until what is free between blocks that are used goes back too, which takes milliseconds


def give_back() -> bool:
    """Have large blocks given back as soon as they are free, and small ones from time to time; tell whether the system can be told so.

    Left to itself the GNU C library raises the size from which it does so to that of the largest block so far, and keeps what is
    smaller for each of the threads that ever had one: a server of many threads would hold all that its largest requests took.
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        library = ctypes.CDLL(None)
        mallopt, malloc_trim = library.mallopt, library.malloc_trim
    except (OSError, AttributeError):  # another C library
        return False

    def trim() -> None:
        while True:
            time.sleep(PAUSE)
            malloc_trim(0)

    threading.Thread(target=trim, name="trim", daemon=True).start()
    return bool(mallopt(MMAP_THRESHOLD, LARGE) and mallopt(TRIM_THRESHOLD, LEFT) and mallopt(ARENA_MAX, 1))


def set_loaded_aside() -> None:
    """Have the garbage collector pass over what is there now, modules most of all, for as long as the process lives.

    It goes through everything only where a quarter of what there is is new: beside hundreds of thousands of objects of modules
    the garbage of thousands of requests would wait for that.
    """
    gc.collect()
    gc.freeze()
