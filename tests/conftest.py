from __future__ import annotations

import gc
import importlib
import inspect
import os
from contextlib import suppress
from pathlib import Path

import hypothesis
import pytest

# The compiled kernels make the first example of a property slow, so no deadline.
hypothesis.settings.register_profile("default", deadline=None, max_examples=40, derandomize=True)
hypothesis.settings.load_profile("default")

PROCESSES = {"cli", "client", "execution", "grasshopper", "paper", "plot", "rpc", "server", "study", "system"}
LONG = 600  # seconds allowed for a nightly test, or one that starts processes


def pytest_xdist_auto_num_workers() -> int:
    """Return one worker more than there are cores, as tests of servers and commands wait for other processes."""
    return len(os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)) + 1


def pytest_sessionstart(session: pytest.Session) -> None:
    """Let each of several processes compile a part of the tests, where all are collected: then the others load what it stored."""
    worker, folder = getattr(session.config, "workerinput", None), Path(__file__).parent
    if worker is None or [Path(own).resolve() for own in session.config.args] != [folder]:
        return
    files = sorted(folder.rglob("test_*.py"))
    for path in files[int(worker["workerid"].removeprefix("gw")) :: worker["workercount"]]:
        # What fails here, fails again when it is collected, and is reported then.
        with suppress(Exception, pytest.skip.Exception):
            importlib.import_module(".".join([folder.name, *path.relative_to(folder).with_suffix("").parts]))


def pytest_collection_finish() -> None:
    """Spare the garbage collector all that was collected, which stays to the end."""
    gc.freeze()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Raise the time limit of nightly tests and of those that start processes."""
    for item in items:
        folder = Path(item.path).relative_to(Path(__file__).parent).parts[0]
        if (folder in PROCESSES or item.get_closest_marker("nightly")) and item.get_closest_marker("timeout") is None:
            item.add_marker(pytest.mark.timeout(LONG))


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    """A server with two workers that requires a key, shared by all tests that neither stop nor limit it."""
    from .support.server_process import KEY
    from .support.server_process import running_server

    with running_server(tmp_path_factory.mktemp("server") / "jobs.sqlite", KEY) as running:
        yield running


@pytest.fixture(scope="session")
def open_server(tmp_path_factory):
    """A server with one worker and without a key, shared like ``server``."""
    from .support.server_process import running_server

    with running_server(tmp_path_factory.mktemp("open-server") / "jobs.sqlite", workers=1) as running:
        yield running


@pytest.fixture(scope="session")
def proxy():
    """A proxy of a service for COMPAS RPC in a process of its own, shared like ``server``."""
    from .support.server_process import running_rpc

    with running_rpc() as running:
        yield running


@pytest.fixture
def small_pictures(monkeypatch):
    """Draw pictures small and with few directions of light: their size and shading are tested in tests/plot."""
    from compas_cgc.plot import studio_light

    monkeypatch.setitem(inspect.unwrap(studio_light.studio).__kwdefaults__, "width", 200)
    monkeypatch.setattr("compas_cgc.cli.solve.PICTURE_WIDTH", 200)
    for name, few in (("SKIES", 2), ("SUNS", 1), ("SHADOW_PIXELS", 20)):
        monkeypatch.setattr(studio_light, name, few)
