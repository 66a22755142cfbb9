"""The drawing board and the 3D view: corners take along what ends at them; selections; supports; the view and its dots."""

from __future__ import annotations

import io

import numpy as np
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


# The scene of the page, which its scripts keep to themselves.
SCENE = (
    "const { Scene } = await import('/page/scene.js'); const { render } = Scene.prototype;"
    "Scene.prototype.render = function () { window.scene = this; return render.call(this); }"
)


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with running_server(tmp_path_factory.mktemp("board") / "jobs.sqlite", workers=1) as server:
        yield server


@pytest.fixture
def board(server, tmp_path):
    """Return hands at a board with a rectangle of 8 m by 6 m."""
    with open_hands("chromium", tmp_path) as hands:
        hands.open(f"{server.url}/#new")
        hands.click("#begin")
        hands.click("#draw-tools [value=rectangle] + span")
        hands.click("#draw-field")
        hands.type("0, 0\n")
        hands.type("8, 6\n")
        hands.click("#board-fit")
        yield hands


def corners(hands):
    """Return where the points of the outline are, in pixels from the middle of the board, the lowest at the left first."""
    body = (
        "const { x, y, width, height } = document.querySelector('#board').getBoundingClientRect();"
        "return [...document.querySelectorAll('#board .outline circle.point')].map((own) =>"
        " { const box = own.getBoundingClientRect();"
        " return [box.x + box.width / 2 - x - width / 2, box.y + box.height / 2 - y - height / 2] })"
    )
    return hands.read(body)


def rows(hands):
    return hands.read("return [...document.querySelectorAll('#plan-list li span')].map((own) => own.textContent)")


def test_several_points_are_selected_and_move_and_go_together(board):
    board.click("#draw-tools [value=move] + span")
    a, b, c, d = corners(board)
    # A frame around the right side takes two corners, one of which is dragged by a quarter of the width.
    board.drag("#board", c[0] - b[0] - 80, c[1] - b[1] - 80, b[0] + 40, b[1] + 40, shift=True)
    assert board.read("return document.querySelectorAll('#board .chosen').length") == 2
    board.drag("#board", (a[0] - b[0]) / 4, 0, *b)
    wait_for(lambda: "Outline 6 × 6 m" in rows(board), what="both corners do not move")
    assert board.read("return document.querySelectorAll('#board .chosen').length") == 2, "they stay selected"
    board.drag("#board", 0, 0, *corners(board)[1], shift=True)
    board.press("Delete")
    wait_for(lambda: len(corners(board)) == 3, what="the selected corner is not removed")
    board.click("#undo")
    wait_for(lambda: len(corners(board)) == 4 and "Outline 6 × 6 m" in rows(board), what="a removal is not undone")


def test_corners_are_supported_on_the_board(board):
    board.click("#draw-tools [value=hold] + span")
    for at in corners(board):
        board.click("#board", *at)
    wait_for(lambda: len(rows(board)) == 5, what="the corners are not supported")
    board.click("#board", *corners(board)[0])
    wait_for(lambda: len(rows(board)) == 4, what="a corner is not released")
    board.click("[name=mesh]")
    board.seen("#solve")
    wait_for(lambda: board.read("return document.querySelectorAll('#columns li').length") == 3, what="three corners are supports")


def test_columns_stay_when_other_supports_are_chosen(board):
    def heights():
        return board.read("return [...document.querySelectorAll('#columns input')].map((own) => own.value)")

    board.click("#draw-tools [value=column] + span")
    board.click("#draw-field")
    board.type("3, 3\n")
    board.click("[name=mesh]")
    board.seen("#solve")
    board.click("#supports [value=corners] + span")
    wait_for(lambda: len(heights()) == 5, what="the column is no support beside the corners")
    column = board.read("return [...document.querySelectorAll('#columns span')].findIndex((own) => own.textContent.endsWith('3, 3'))")
    assert column >= 0
    board.fill(f"#columns li:nth-child({column + 1}) input", "2")
    for choice, count in (("boundary", 1), ("corners", 5)):
        board.click(f"#supports [value={choice}] + span")
        wait_for(lambda count=count: len(heights()) == count and "2" in heights(), what=f"the column is gone with {choice}")


@pytest.mark.parametrize("chosen", [False, True], ids=["as it opens", "chosen"])
def test_the_first_solve_keeps_the_view(server, tmp_path, chosen):
    with open_hands("chromium", tmp_path) as hands:
        hands.open(f"{server.url}/#new")
        hands.seen(".example")
        hands.read(SCENE)
        hands.click("[data-example=example2]")
        hands.seen("#solve")
        if chosen:
            hands.drag("#canvas", 60, 20)
            wait_for(lambda: hands.read("return window.scene.chosen"), what="a drag does not turn the view")
            hands.drag("#canvas", 30, 0)
        view = hands.read("return window.scene.view")
        hands.solve()
        assert hands.read("return window.scene.view") == pytest.approx(view, abs=1e-9)


def test_dots_have_one_size_at_all_pixel_ratios(server, tmp_path):
    from PIL import Image

    reds = {}
    with open_hands("chromium", tmp_path) as hands:
        for ratio in (1, 2):
            hands.size(1200, 800, False, ratio)
            hands.open(f"{server.url}/#new")
            hands.click("[data-example=example4_a]")
            hands.seen("#solve")

            def red(ratio=ratio):
                with Image.open(io.BytesIO(hands.picture())) as image:
                    assert image.size == (1200 * ratio, 800 * ratio)
                    pixels = np.asarray(image.convert("RGB"), dtype=int)[:, 350 * ratio :]
                return int(((pixels[..., 0] > 180) & (pixels[..., 1:] < 80).all(axis=-1)).sum()) / ratio**2

            reds[ratio] = wait_for(red, what="no support is shown")
    assert reds[2] == pytest.approx(reds[1], rel=0.25), "twice the size would be four times the area"


def test_creases_and_columns_follow_the_corner_at_which_they_end(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:
        hands.open(f"{server.url}/#new")
        hands.seen(".example")
        moved, snapped = hands.read(
            "const { withMoved } = await import('/page/draw/plan.js'); const { snapped } = await import('/page/draw/snap.js');"
            "const line = (points, closed) => ({ points, closed, held: [] });"
            "const plan = { unit: 'm', edge: null, lines: [line([[0, 0], [8, 0], [8, 6], [0, 6]], true), line([[8, 6], [4, 0]], false)],"
            " columns: [{ x: 8, y: 6, height: 0 }, { x: 3, y: 3, height: 0 }] };"
            "return [withMoved(plan, [[8, 6]], [1, 1]), snapped([8.1, 6.1], plan, [], { reach: 0.5, step: 0.1, skip: [[8, 6]] })]"
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
