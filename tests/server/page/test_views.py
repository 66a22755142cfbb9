"""Every view of the page, in both browsers: axe finds nothing, the browser complains of nothing, and nothing is cut off."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from compas_cgc import CGCMesh
from compas_cgc.io import write

from ...support.hands import BUSY
from ...support.hands import axe_script
from ...support.hands import open_hands
from ...support.server_process import running_server
from ...support.server_process import wait_for

KEY = "a-key-for-tests"
# Of browser, width in pixels, and dark: each browser, each width and each colour scheme once.
WAYS = [pytest.param("chromium", 1440, False, id="chromium-light"), pytest.param("firefox", 400, True, id="firefox-narrow-dark")]
GIVE = """
const [name, kind, text] = args; const moved = new DataTransfer();
moved.items.add(new File([text], `${name}.${kind}`));
window.dispatchEvent(Object.assign(new Event('drop', {bubbles: true, cancelable: true}), {dataTransfer: moved}));
"""


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with running_server(tmp_path_factory.mktemp("views") / "jobs.sqlite", key=KEY, workers=1) as running:
        yield running


@pytest.mark.nightly
@pytest.mark.parametrize("browser, width, dark", WAYS)
def test_all_views(server, tmp_path, browser, width, dark):
    if axe_script() is None:
        pytest.skip("axe-core is not installed: npm ci --prefix tests/support/web")
    shots = Path(os.environ.get("PAGE_PICTURES") or tmp_path)
    with open_hands(browser, tmp_path, width, 860, dark) as hands:

        def look(name, refused=()):
            (shots / f"view-{browser}-{width}-{name}.png").write_bytes(hands.picture())
            assert hands.violations() == [], name
            complaints = [text for text in hands.complaints() if not any(status in text for status in refused)]
            assert complaints == [], name
            across = hands.read(
                "return [document.documentElement.scrollWidth, innerWidth, document.querySelector('header').getBoundingClientRect().top]"
            )
            assert across[0] <= across[1] == width and across[2] == 0, (name, across)

        def solved(state="good"):
            wait_for(lambda: hands.shown(f".verdict.{state} h2") and not hands.shown(BUSY), what=f"{state} is not shown")

        def choose(selector, value):
            hands.read(
                "const s = document.querySelector(args[0]); s.value = args[1]; s.dispatchEvent(new Event('change', {bubbles: true}))",
                selector,
                value,
            )

        hands.open(f"{server.url}/#new")
        hands.seen("#key[open]")
        look("key", refused=("401", "UNAUTHORIZED"))
        hands.fill("#key-field", KEY)
        hands.seen(".example")
        look("first")
        hands.read(GIVE, "roof", "dae", "nothing")
        hands.seen("#trouble")
        look("refused")

        hands.click("#begin")
        hands.seen("#board")
        for tool in ("rectangle", "circle", "column", "hold", "move", "line"):
            hands.click(f"#draw-tools [value={tool}] + span")
        look("board")
        hands.click("#share summary")
        look("menu")
        hands.click("#share summary")
        hands.click("#another")
        hands.seen(".example")
        hands.click("[data-example=example4_a]")
        hands.seen("#solve")
        hands.click("#solve")
        solved()
        look("solved")
        for by in ("curvature", "error"):
            hands.click(f"#colours [value={by}] + span")
            look(by)
        for by in ("zebra", "height", "fit", "mean", "largest", "smallest", ""):
            choose("#more-colours", by)
        hands.click("#hand [value=section] + span")
        # On the two front regions in both sizes of the view.
        hands.click("#fit")
        hands.click("#canvas", -30, -40)
        hands.click("#canvas", 60, -40)
        hands.seen("#section")
        look("section")
        hands.click("#section button")
        for each in ("#more-goals summary", "#options summary", ".verdict summary"):
            hands.click(each)
        look("details")
        hands.click("#add-box")
        hands.seen("#boxes li")
        look("room")
        hands.click("#undo")
        wait_for(lambda: not hands.shown("#boxes li"))
        hands.click("#limit")
        wait_for(lambda: hands.text("#limit-said") and "…" not in hands.text("#limit-said"), what="no limit was found")
        hands.click("#solve")
        solved()
        look("limit")
        hands.fill("[name=rise]", "-40")
        hands.click("#solve")
        solved("bad")
        top = hands.read("return document.querySelector('.verdict h2').getBoundingClientRect().top")
        assert 0 <= top < 860, "bad news are out of sight"
        look("bad")
        hands.click("#undo")
        hands.click("#solve")
        solved()
        for task in ("mould", "membrane", "net", "drawings"):
            hands.click(f"#make-tabs [value={task}] + span")
            hands.click("#make")
            wait_for(lambda: hands.text("#make-said") and "…" not in hands.text("#make-said"), what=f"{task} is not made")
            assert hands.shown("#make-files"), (task, hands.text("#make-said"))
            look(task)

        # What unrolls, with its flat pieces.
        mesh = CGCMesh.from_meshgrid(dx=6, nx=6)
        mesh.set_supports("boundary")
        mesh.set_target(0.0)
        write(tmp_path / "flat.obj", mesh)
        hands.read(GIVE, "flat", "obj", (tmp_path / "flat.obj").read_text())
        wait_for(lambda: "49 vertices" in hands.text("#about"))
        hands.fill(".region .number", "0")
        hands.click("#solve")
        solved()
        hands.click("#make-tabs [value=unroll] + span")
        hands.click("#make")
        hands.seen("#sheets")
        look("unrolled")

        # What there is no surface for.
        hands.click("#another")
        hands.click("[data-example=example2]")
        wait_for(lambda: "Nine" not in hands.text("#about") and "flat" not in hands.text("#about"))
        hands.fill(".region .number", "50")
        solved("bad")
        look("none")
