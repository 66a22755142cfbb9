"""Many clients at once, for a short while of every day; ``python -m tests.support.soak`` goes on for longer."""

from __future__ import annotations

import pytest

from ..support.soak import soak


@pytest.mark.nightly
def test_many_clients_get_the_answers_that_one_alone_gets_and_nothing_is_left_behind():
    tally, memory = soak(clients=8, seconds=15.0)
    assert tally.wrong == []
    assert sum(tally.counts.values()) > 8 and len(memory) > 1
