"""Remedies: a rough surface is mended by a button of its verdict."""

from __future__ import annotations

import json
import re

import pytest

from ...support.hands import BUSY
from ...support.hands import open_hands
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly

# A roof between two walls, with more curvature than these carry.
OUTLINE = [[-0.29, -0.99], [13.69, -0.13], [12.83, 10.55], [0.06, 11.34]]
SKETCH = {"name": "Hall", "unit": "m", "edge_length": 0.87, "outline": OUTLINE, "held": [OUTLINE[:2], OUTLINE[2:]]}
OPEN = (
    "const { asFragment } = await import('/page/design/packing.js');"
    "const answer = await fetch('/api/v1/drawings', { method: 'POST', body: JSON.stringify(args[0]) });"
    "const data = { ...(await answer.json()), targets: [args[1]] };"
    "location.hash = `design=${await asFragment({ stage: 'shape', name: 'Hall', plan: null, data })}`;"
)


def solve_opened(server, hands, opening: str, sketch: dict, K: float) -> None:
    """Open a design of a sketch on the page, and press Solve."""
    hands.open(f"{server.url}/#new")
    hands.seen(".example")
    hands.read(opening, sketch, K)
    hands.seen("#solve")
    hands.click("#solve")


def test_a_button_of_the_verdict_mends_a_rough_surface(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        solve_opened(server, hands, OPEN, SKETCH, 0.025)
        wait_for(lambda: hands.text(".verdict h2") == "Rough" and not hands.shown(BUSY), what="the surface is not rough")
        buttons = hands.read("return [...document.querySelectorAll('.remedies button')].map((each) => each.textContent)")
        # The message names how much the supports carry.
        assert re.match(r"Reduce K to \d+ %", buttons[0]) and "Support the whole edge" in buttons, buttons
        assert "Mesh finer" not in buttons, "there is no drawing to mesh"
        hands.click(".remedies button")
        wait_for(lambda: hands.text(".verdict h2") == "Target reached" and not hands.shown(BUSY), what="the surface is still rough")
        assert not hands.shown(".remedies") and hands.complaints() == []
        hands.click("#undo")
        wait_for(lambda: hands.text(".verdict h2") == "Rough" and not hands.shown(BUSY), what="a remedy is a step that can be undone")


def test_a_button_allows_more_steps_after_the_step_limit(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        two_steps = OPEN.replace("targets: [args[1]]", "targets: [args[1]], method: 'newton', settings: { steps: 2 }")
        solve_opened(server, hands, two_steps, SKETCH, 0.01)
        wait_for(lambda: hands.text(".verdict h2") == "Step limit reached" and not hands.shown(BUSY), what="two steps are enough")
        assert hands.text(".remedies button") == "Allow 10 steps"
        hands.click(".remedies button")
        wait_for(lambda: hands.text(".verdict h2") not in ("", "Step limit reached") and not hands.shown(BUSY), what="ten are not")


def test_a_button_draws_a_crease_from_an_inward_corner(tmp_path):
    outline = [[0, 0], [14, 0], [14, 5], [6, 5], [6, 11], [0, 11]]
    sketch = {"name": "Hall", "unit": "m", "edge_length": 1.0, "outline": outline}
    plan = {"unit": "m", "edge": 1.0, "columns": [], "lines": [{"points": outline, "closed": True, "held": [0, 1, 2, 3, 4, 5]}]}
    opened = OPEN.replace("plan: null", f"plan: {json.dumps(plan)}")
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        solve_opened(server, hands, opened, sketch, 0.004)
        wait_for(lambda: hands.text(".verdict h2") not in ("", "Target reached") and not hands.shown(BUSY), what="the surface is not rough")
        label = "Draw a crease from the inward corner"
        hands.read(
            "[...document.querySelectorAll('.remedies button')].find((each) => each.textContent === args[0]).click(); return true", label
        )
        wait_for(lambda: hands.text(".verdict h2") == "Target reached" and not hands.shown(BUSY), what="the surface is still rough")
        assert not hands.shown(".remedies") and hands.complaints() == []
