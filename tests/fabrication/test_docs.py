"""The example of docs/fabrication.md on moulds runs, and gives what the page promises."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "fabrication.md"


@pytest.mark.nightly
def test_the_example_on_moulds(capsys):
    (example,) = (own for own in re.findall(r"```py\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL) if "moulds(" in own)
    exec(compile(example, str(PAGE), "exec"), {})
    said = capsys.readouterr().out
    assert "in the exact measure" in said and "144 panels on 2 moulds" in said and "8 mm of glass-fibre reinforced plastic (gfrp)" in said
    error, gap = map(float, said.splitlines()[1].split())
    assert error < 1e-11 and gap < 1e-11
