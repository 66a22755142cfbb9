"""Numbers in the fields of the page: the decimal sign is a point or a comma, in every browser."""

from __future__ import annotations

import pytest

from ...support.hands import open_hands
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly

INVALID = "return document.querySelector(args[0]).matches(':invalid')"
NATIVE = "return document.querySelectorAll('[type=number]').length"


def shows(hands, selector, text):
    """Wait until a field shows a text, as the page writes the number that it read."""
    wait_for(lambda: hands.value(selector) == text, what=f"{selector} does not show {text}")


@pytest.mark.parametrize("browser", ["chromium", "firefox"])
def test_a_comma_and_a_point_give_the_same_number_and_groups_are_refused(tmp_path, browser):
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands(browser, tmp_path) as hands:
        hands.open_example(server, "example2")
        for text, shown in (("0,015", "0.015"), ("0.02", "0.02")):
            hands.fill(".region .number", text)
            shows(hands, ".region .number", shown)
        hands.click("#more-goals summary")
        hands.click("#add-box")
        hands.seen("#boxes li")
        for selector in ("[name=rise]", "[name=below]", "#boxes li .number"):
            for text, shown in (("3,5", "3.5"), ("2.5", "2.5"), ("0,015", "0.015")):
                hands.fill(selector, text)
                shows(hands, selector, shown)
            hands.fill(selector, "1.234,5")
            assert hands.value(selector) == "1.234,5" and hands.read(INVALID, selector)
            hands.fill(selector, "4")
            assert not hands.read(INVALID, selector)
        assert hands.read(NATIVE) == 0, "fields of the browser read numbers by its locale"
        assert hands.complaints() == []
