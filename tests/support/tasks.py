"""Tasks for tests of executors; a worker imports them from here."""

from __future__ import annotations

import os
import time

from compas_cgc.execution.worker import report
from compas_cgc.execution.worker import stop_wanted


def add(a, b):
    report({"step": 1})
    return a + b


def loop(seconds):
    """Run until it is stopped; return what it heard."""
    end = time.monotonic() + seconds
    steps = 0
    while time.monotonic() < end and not stop_wanted():
        steps += 1
        if steps % 10 == 1:
            report({"step": steps, "process": os.getpid()})
        time.sleep(0.01)
    return "stopped" if time.monotonic() < end else "ended"


def loop_until(path):
    """Run until a file exists or it is stopped; return what it heard."""
    while not os.path.exists(path):
        if stop_wanted():
            return "stopped"
        time.sleep(0.01)
    return "ended"


def deaf(seconds):
    report({"process": os.getpid()})
    time.sleep(seconds)
    return "ended"


def start_when_allowed(path):
    """Wait for a file."""
    while not os.path.exists(path):
        time.sleep(0.01)


def fail(text):
    raise ValueError(text)


def end_process(path):
    """End the worker, and note that it was begun."""
    with open(path, "a", encoding="utf-8") as file:
        file.write("begun ")
    report({"process": os.getpid()})
    time.sleep(0.2)
    os._exit(3)
