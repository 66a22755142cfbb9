"""The drawing board and the 3D view: corners take along what ends at them, and a lost graphics context comes back."""

from __future__ import annotations

import io

import pytest

from ...support.hands import open_hands
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly
GRAPHICS = "document.getElementById('canvas').getContext('webgl2').getExtension('WEBGL_lose_context')"


def colours(picture):
    """Return the number of colours in the middle of a picture."""
    from PIL import Image

    with Image.open(io.BytesIO(picture)) as image:
        width, height = image.size
        middle = image.convert("RGB").crop((width // 3, height // 4, 2 * width // 3, 3 * height // 4))
        return len(middle.getcolors(width * height))


def test_creases_and_columns_follow_the_corner_at_which_they_end(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        hands.open(f"{server.url}/#new")
        hands.seen(".example")
        moved, snapped = hands.read(
            "const { withMoved } = await import('/page/draw/plan.js'); const { snapped } = await import('/page/draw/snap.js');"
            "const line = (points, closed) => ({ points, closed, held: [] });"
            "const plan = { unit: 'm', edge: null, lines: [line([[0, 0], [8, 0], [8, 6], [0, 6]], true), line([[8, 6], [4, 0]], false)],"
            " columns: [{ x: 8, y: 6, height: 0 }, { x: 3, y: 3, height: 0 }] };"
            "return [withMoved(plan, [8, 6], [9, 7]), snapped([8.1, 6.1], plan, [], { reach: 0.5, step: 0.1, skip: [8, 6] })]"
        )
        assert [line["points"] for line in moved["lines"]] == [[[0, 0], [8, 0], [9, 7], [0, 6]], [[9, 7], [4, 0]]]
        assert [(own["x"], own["y"]) for own in moved["columns"]] == [(9, 7), (3, 3)]
        assert snapped["on"] == "grid", "the corner is not drawn back to what follows it"


def test_a_lost_graphics_context_is_reported_and_restored(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        hands.open_example(server, "example2")
        hands.solve()
        assert not hands.shown("#lost")
        before = wait_for(lambda: (own := colours(hands.picture())) > 200 and own, what="the surface is not shown")
        hands.read(f"window.lose = {GRAPHICS}; window.lose.loseContext()")
        wait_for(lambda: hands.shown("#lost"), what="the loss is not reported")
        hands.read("window.lose.restoreContext()")
        wait_for(lambda: not hands.shown("#lost"), what="the view does not come back")
        wait_for(lambda: colours(hands.picture()) > 0.5 * before, what="the view stays empty")
