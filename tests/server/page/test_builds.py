"""Builds on the page: the last one that was started is shown."""

from __future__ import annotations

import pytest

from ...support.hands import open_hands
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly
TEXTS = "return [...document.querySelectorAll('#sheets svg text')].map((each) => each.textContent)"


def test_a_title_typed_during_a_build_is_on_the_sheet(tmp_path):
    """Enter starts a build; a second one with another option replaces it, also while the first runs."""
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        hands.open_example(server, "example2")
        hands.solve()
        hands.click("#make-tabs [value=drawings] + span")
        hands.fill("#make-options [name=contours]", "0.5")
        hands.fill("#make-options [name=title]", "Roof at 5$ and 6$")
        wait_for(lambda: "Roof at 5$ and 6$" in hands.read(TEXTS), what="the title is not on the sheet")
        assert hands.text("#sheets figcaption span") == "Plans, sections, elevations" and hands.complaints() == []
        hands.click("#sheets figcaption button")
        hands.click("#make-tabs [value=unroll] + span")
        hands.click("#make")
        wait_for(lambda: hands.text("#sheets figcaption span") == "Flat pieces" and hands.shown("#sheets"), what="no flat pieces")
