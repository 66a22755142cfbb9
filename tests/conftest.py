from __future__ import annotations

from pathlib import Path

import hypothesis
import pytest

# The compiled kernels make the first example of a property slow, so no deadline.
hypothesis.settings.register_profile("default", deadline=None, max_examples=40, derandomize=True)
hypothesis.settings.load_profile("default")

PROCESSES = {"cli", "client", "execution", "grasshopper", "paper", "plot", "rpc", "server", "study", "system"}
LONG = 600  # seconds allowed for a nightly test, or one that starts processes


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Raise the time limit of nightly tests and of those that start processes."""
    for item in items:
        folder = Path(item.path).relative_to(Path(__file__).parent).parts[0]
        if (folder in PROCESSES or item.get_closest_marker("nightly")) and item.get_closest_marker("timeout") is None:
            item.add_marker(pytest.mark.timeout(LONG))
