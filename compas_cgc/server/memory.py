"""Memory of the server: memory of large requests is returned to the operating system."""

from __future__ import annotations

import ctypes
import gc
import sys
import threading
import time

__all__ = ["give_back", "set_loaded_aside"]

# Parameters of mallopt, from malloc.h of the GNU C library.
TRIM_THRESHOLD, MMAP_THRESHOLD, ARENA_MAX = -1, -3, -8
LARGE = 2**21  # size from which blocks are mapped separately [bytes]; mapping the blocks of usual requests would dominate their time
LEFT = 2**23  # free space at the end of the heap from which it is returned [bytes]
PAUSE = 5.0  # time between two trims of the free space within the heap [s]; a trim takes milliseconds


def give_back() -> bool:
    """Return freed memory to the system: large blocks at once, small ones periodically. Return whether the C library supports it.

    By default, the GNU C library raises this threshold to the size of the largest block so far, and keeps smaller blocks per
    thread: a server with many threads would retain the memory of its largest requests.
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
    """Exclude all present objects, mostly modules, from garbage collection for the lifetime of the process.

    A full collection runs only when a quarter of all objects is new. With the hundreds of thousands of objects of modules, the
    garbage of thousands of requests would accumulate until then.
    """
    gc.collect()
    gc.freeze()
