"""What a terminal shows while a command is at work."""

from __future__ import annotations

import io
import re

import pytest

from compas_cgc.cli import console
from compas_cgc.cli.console import Parts

from ..support.server_process import PATIENCE
from ..support.server_process import wait_for


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_long_part_is_shown_and_taken_away():
    out = Terminal()
    parts = Parts(2, out)
    with parts.part("laying panels"):
        wait_for(lambda: "laying panels" in out.getvalue())
    with pytest.raises(KeyError), parts.part("writing"):
        wait_for(lambda: "writing" in out.getvalue())
        raise KeyError("as it was")
    said = out.getvalue()
    assert re.search(r"\[\.{24}\] laying panels: \d+ s", said) and "[############............] writing" in said
    assert said.endswith("\r") and not said.split("\r")[-2].strip(), "the line is empty again"


def test_a_short_part_and_a_file_are_not_written_to(monkeypatch):
    short, long, quiet, file = Terminal(), Terminal(), Terminal(), io.StringIO()
    with monkeypatch.context() as patient:
        patient.setattr(console, "_INTERVAL", PATIENCE)
        with Parts(1, short).part("nothing to wait for"):
            pass
    with Parts(1, file).part("into a file"), Parts(1, quiet, quiet=True).part("quiet"), Parts(1, long).part("on a terminal"):
        wait_for(long.getvalue)
    assert short.getvalue() == file.getvalue() == quiet.getvalue() == ""
