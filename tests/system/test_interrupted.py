"""Commands that are ended by signals, kills and full disks; ``python -m tests.support.interrupted 500`` for longer."""

from __future__ import annotations

import pytest

from ..support.interrupted import COMMANDS
from ..support.interrupted import KINDS
from ..support.interrupted import interruptions
from ..support.interrupted import wrong
from ..support.server_process import KILLABLE

pytestmark = [KILLABLE, pytest.mark.nightly, pytest.mark.timeout(1800)]


def test_an_interrupted_command_leaves_the_old_outputs_or_all_new_ones_and_never_a_traceback():
    found = interruptions(len(COMMANDS) * len(KINDS), seed=1)
    assert wrong(found) == []
    assert {"old", "new"} <= {trial.outputs for trial in found}, "some are ended before and some after"
