"""A server under a crowd of clients; ``python -m tests.support.office eleventh 120`` and ``... bodies 256 60`` for more of it."""

from __future__ import annotations

import numpy as np
import pytest

from ..support.office import bodies
from ..support.office import eleventh
from ..support.server_process import KILLABLE

pytestmark = [KILLABLE, pytest.mark.nightly, pytest.mark.timeout(900)]


def test_short_calls_and_downloads_of_one_client_go_on_beside_ten_that_keep_the_server_busy():
    waited, answers = eleventh(30.0)
    assert {kind for kind, _ in answers} >= {"job", "upload"} and sum(answers.values()) > 100
    assert not any(isinstance(code, int) and code >= 500 and code != 504 for _, code in answers)
    assert all(np.percentile(seconds, 99) <= 1.0 for seconds in waited.values()), waited


def test_bodies_that_wait_are_on_the_disk_and_go_with_their_jobs():
    found = bodies(24, 30.0)
    assert found.accepted == 24 and found.kept > 24 * 29.0
    assert found.megabytes < 400.0 and found.left < 10.0
