"""What a terminal shows while a command is at work."""

from __future__ import annotations

import io
import time

import pytest

from compas_cgc.cli.console import Parts


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_long_part_is_shown_and_taken_away():
    out = Terminal()
    parts = Parts(2, out)
    with parts.part("laying panels"):
        time.sleep(0.7)
    with pytest.raises(KeyError), parts.part("writing"):
        time.sleep(0.5)
        raise KeyError("as it was")
    said = out.getvalue()
    assert "[........................] laying panels: 0 s" in said and "[############............] writing" in said
    assert said.endswith("\r") and not said.split("\r")[-2].strip(), "the line is empty again"


def test_a_short_part_and_a_file_are_not_written_to():
    short, file = Terminal(), io.StringIO()
    with Parts(1, short).part("nothing to wait for"):
        pass
    with Parts(1, file).part("into a file"), Parts(1, Terminal(), quiet=True).part("quiet"):
        time.sleep(0.4)
    assert short.getvalue() == file.getvalue() == ""
