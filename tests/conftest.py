from __future__ import annotations

import inspect
import os
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
