"""Compiled kernels: decorator, storage and compilation time."""

from __future__ import annotations

import atexit
import gc
import logging
import os
import shutil
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from collections.abc import Iterator
from contextlib import contextmanager
from contextlib import suppress
from functools import cache
from typing import Any
from typing import NamedTuple
from typing import Optional

__all__ = ["Compilation", "compile_seconds", "is_compiling", "is_stored", "kernel", "watch_compilation"]

PACKAGE = __name__.rpartition(".")[0]
log = logging.getLogger(__name__)


class Compilation(NamedTuple):
    """Compilation in this process."""

    kernels: int  # number of compiled kernels that Python calls
    part: float  # compiled fraction of the loaded kernels, from 0 to 1; not all of them are needed
    seconds: float  # wall time [s]


Watcher = Callable[[Compilation], object]


class _Clock(threading.local):
    """Compilation in a thread: nesting depth, start time, and total time so far."""

    depth = 0
    started = 0.0
    seconds = 0.0
    part = 0.0
    collects = False  # whether the garbage collector was enabled before


_clock = _Clock()
_kernels: list[Any] = []
_compiled: list[str] = []
_watchers: list[Watcher] = []
_compiling: set[int] = set()  # identifiers of the threads that compile


def kernel(inner: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator of a compiled function, which is cached on disk.

    To reduce compile times, kernels have no C entry point and no checks for division by zero, which gives infinities as in NumPy.
    Small kernels without array creation, slices, string formatting or sorting compile fastest. Kernels run without the lock of the
    interpreter, so that the interface's thread in Rhino and threads of servers go on.

    Parameters
    ----------
    inner
        Whether only other kernels call it: it then has no Python entry point and is stored with its callers.
    options
        Further options of ``numba.njit``.
    """
    _listen()

    def decorate(function: Callable[..., Any]) -> Any:
        own = {"cache": not inner, "no_cpython_wrapper": inner, "error_model": "numpy", "no_cfunc_wrapper": True, "nogil": True}
        made = _made(function, {**own, **options})
        _kernels.append(made)
        return made

    return decorate


def compile_seconds() -> float:
    """Return the wall time that this thread has spent on compilation [s]."""
    running = time.perf_counter() - _clock.started if _clock.depth else 0.0
    return _clock.seconds + running


def is_compiling(thread: int) -> bool:
    """Check whether the thread with an identifier is compiling a kernel."""
    return thread in _compiling


@contextmanager
def watch_compilation(watcher: Watcher) -> Iterator[None]:
    """Within a block, call a function before and after the compilation of each kernel."""
    _listen()
    _watchers.append(watcher)
    try:
        yield
    finally:
        _watchers.remove(watcher)


def is_stored(made: Any) -> bool:
    """Check whether a kernel is in the cache on disk."""
    try:
        return bool(made._cache._cache_file._load_index())
    except Exception:  # Numba has no public way to ask, and the index may be damaged
        return False


def _made(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    import numba

    try:
        return _guard_storage(numba.njit(**options)(function))
    except RuntimeError:
        # Neither the folder of the package nor that of the user is writable.
        from numba.core import config

        setattr(config, "CACHE_DIR", _temporary_folder())  # noqa: B010  # types know only what is set already
        return _guard_storage(numba.njit(**options)(function))


def _guard_storage(made: Any) -> Any:
    """Let a kernel whose stored files are damaged, or cannot be written, be compiled anew.

    A kill or a full disk can leave an empty index or object file, which Numba would raise an EOFError for in every later process.
    """
    storage: Any = getattr(made, "_cache", None)
    load, save = getattr(storage, "load_overload", None), getattr(storage, "save_overload", None)
    if load is None or save is None:
        return made

    def discard(error: Exception) -> None:
        log.warning("the stored kernel %s is damaged (%s) and is compiled anew", made.py_func.__qualname__, type(error).__name__)
        with suppress(OSError):
            storage.flush()

    def load_or_discard(*args: Any) -> Any:
        try:
            return load(*args)
        except Exception as error:
            discard(error)
            return None

    def save_or_discard(*args: Any) -> None:
        try:
            save(*args)
        except OSError as error:
            log.warning("the kernel %s cannot be stored (%s)", made.py_func.__qualname__, error)
        except Exception as error:
            discard(error)
            with suppress(OSError):
                save(*args)

    storage.load_overload, storage.save_overload = load_or_discard, save_or_discard
    return made


@cache
def _temporary_folder() -> str:
    """Return a private folder for the kernel cache; it outlives the process if it is secure."""
    user = os.getuid() if sys.platform != "win32" else 0
    folder = os.path.join(tempfile.gettempdir(), f"{PACKAGE}-{user}")
    try:
        os.mkdir(folder, mode=0o700)
    except OSError:
        pass
    if sys.platform == "win32" or (os.path.isdir(folder) and not os.path.islink(folder) and _is_private(os.stat(folder), user)):
        return folder
    folder = tempfile.mkdtemp(prefix=f"{PACKAGE}-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _is_private(stat: os.stat_result, user: int) -> bool:
    return stat.st_uid == user and not stat.st_mode & 0o022


@cache
def _listen() -> None:
    """Listen to the compilation events of Numba."""
    from numba.core import event as events

    class Listener(events.Listener):
        def on_start(self, event: Any) -> None:
            name = _name(event)
            if name is None:
                return
            if _clock.depth == 0:
                _clock.started = time.perf_counter()
                _compiling.add(threading.get_ident())
                _tell()
                # Garbage collection would take a sixth of the compile time; only one thread compiles at a time.
                _clock.collects = gc.isenabled()
                gc.disable()
            _clock.depth += 1

        def on_end(self, event: Any) -> None:
            name = _name(event)
            if name is None or not _clock.depth:
                return
            _clock.depth -= 1
            if _clock.depth == 0:
                if _clock.collects:
                    gc.enable()
                _clock.seconds += time.perf_counter() - _clock.started
                _compiled.append(name)
                _compiling.discard(threading.get_ident())
                _tell()

    events.register("numba:compile", Listener())


def _name(happening: Any) -> Optional[str]:
    """Return the name of the compiled kernel, None for internal functions of Numba."""
    function = happening.data["dispatcher"].py_func
    module = function.__module__ or ""
    return f"{module}.{function.__qualname__}" if _clock.depth or module.startswith(f"{PACKAGE}.") else None


def _tell() -> None:
    left = sum(not made.signatures for made in _kernels)
    # More kernels may be loaded meanwhile, but the progress must not decrease.
    _clock.part = max(_clock.part, len(_compiled) / max(1, len(_compiled) + left))
    state = Compilation(len(_compiled), _clock.part, compile_seconds())
    for watcher in list(_watchers):
        watcher(state)
