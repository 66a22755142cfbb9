"""Signals that end a command: exceptions that reach its end wherever they arrive."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.machinery import ExtensionFileLoader
from typing import Any
from typing import Callable

from .._atomic_write import end_process

__all__ = ["end_cleanly_on_signals", "extensions_loaded_whole", "signals_in_kernels", "signals_repeated"]

REPEAT_SECONDS = 0.01  # until a signal is repeated


def end_cleanly_on_signals() -> None:
    """Let the signals that end a process do so as an exception, so that no temporary file is left."""

    def end(number: int, frame: object) -> None:
        end_process(128 + number)

    if threading.current_thread() is threading.main_thread():
        for name in ("SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            # A parent such as nohup may have a signal ignored.
            if number is not None and signal.getsignal(number) is signal.SIG_DFL:
                signal.signal(number, end)


@contextmanager
def signals_in_kernels() -> Iterator[None]:
    """Pass on the exception of a signal that arrived during calls of compiled functions, each of which wraps it in a SystemError."""
    try:
        yield
    except SystemError as error:
        cause = error.__cause__
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, (KeyboardInterrupt, SystemExit)):
            raise cause from None
        raise


@contextmanager
def signals_repeated() -> Iterator[None]:
    """Repeat signals whose exceptions Python ignores, such as those in callbacks of weak references, which every import has."""
    usual, thread, hooked = sys.unraisablehook, threading.get_ident(), threading.Lock()

    def repeat(number: int) -> None:
        # Python ignores exceptions in the hook too.
        with hooked:
            pass
        time.sleep(REPEAT_SECONDS)
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(thread, number)
        else:
            signal.raise_signal(number)

    def hook(ignored: sys.UnraisableHookArgs) -> None:
        error = ignored.exc_value
        if isinstance(error, KeyboardInterrupt):
            number = int(signal.SIGINT)
        elif isinstance(error, SystemExit) and isinstance(error.code, int) and error.code > 128:
            number = error.code - 128
        else:
            usual(ignored)
            return
        with hooked:
            threading.Thread(target=repeat, args=(number,)).start()

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = usual


@contextmanager
def extensions_loaded_whole() -> Iterator[None]:
    """Delay signals until extension modules are loaded: their exceptions abort some libraries, and others then seem to be missing."""
    methods = {name: getattr(ExtensionFileLoader, name) for name in ("create_module", "exec_module")}

    def whole(method: Callable) -> Callable:
        def load(loader: ExtensionFileLoader, given: Any) -> Any:
            with _signals_delayed():
                return method(loader, given)

        return load

    for name, method in methods.items():
        setattr(ExtensionFileLoader, name, whole(method))
    try:
        yield
    finally:
        for name, method in methods.items():
            setattr(ExtensionFileLoader, name, method)


@contextmanager
def _signals_delayed() -> Iterator[None]:
    """Repeat the signals that arrive within a block after it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    arrived: list[int] = []
    numbers = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    handlers = {number: signal.getsignal(number) for number in numbers if callable(signal.getsignal(number))}
    for number in handlers:
        signal.signal(number, lambda own, frame: arrived.append(own))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for number in arrived:
            signal.raise_signal(number)
