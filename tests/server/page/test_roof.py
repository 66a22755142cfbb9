"""A roof designed on the page from nothing, by hands that only click, drag and type."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
import rhino3dm

from ...support.hands import BUSY
from ...support.hands import open_hands
from ...support.server_process import wait_for

pytest.importorskip("compas_cgal", reason="the extra mesher is not installed")
pytestmark = pytest.mark.nightly

# Of browser, width in pixels, and dark: each browser, each width and each colour scheme once.
WAYS = [
    pytest.param("chromium", 400, True, id="chromium-narrow-dark"),
    pytest.param("firefox", 1440, False, id="firefox-light"),
]


def good(hands):
    """Wait until the surface is as asked."""
    wait_for(lambda: hands.text(".verdict.good h2") == "Target reached" and not hands.shown(BUSY), what="the roof is not solved")


def rise(hands):
    return float(hands.value("[name=rise]"))


@pytest.mark.parametrize("browser, width, dark", WAYS)
def test_a_roof_from_nothing_to_moulds(open_server, tmp_path, browser, width, dark):
    shots = Path(os.environ.get("PAGE_PICTURES") or tmp_path)
    with open_hands(browser, tmp_path, width, 860, dark) as hands:

        def look(name):
            """Keep a picture, and find nothing wrong with what is shown."""
            (shots / f"{browser}-{width}-{name}.png").write_bytes(hands.picture())
            assert not hands.violations(), name
            assert hands.complaints() == [], name
            wide = hands.read(
                "return [document.documentElement.scrollWidth, innerWidth, document.querySelector('header').getBoundingClientRect().top]"
            )
            assert wide[0] <= wide[1] == width and wide[2] == 0, "nothing is cut off, and the header stays"

        hands.open(f"{open_server.url}/#new")
        hands.seen(".example")
        look("0-welcome")

        # The plan: a line of typed lengths, closed at its first point, and a fold from side to side.
        hands.click("#begin")
        hands.fill("[name=plan-name]", "Canopy")
        corner = (-0.32 * min(width, 1000), -100)
        hands.click("#board", *corner)
        for text in ("12<0", "8<-90", "12<180"):
            hands.type(f"{text}\n")
        hands.click("#board", *corner)
        wait_for(lambda: "Outline 12 × 8 m" in hands.text("#plan-list"), what="the outline is open")
        hands.chord("z")
        wait_for(lambda: "Outline" not in hands.text("#plan-list"))
        hands.chord("z", shift=True)
        wait_for(lambda: "Outline" in hands.text("#plan-list"))
        hands.click("#board-fit")
        look("1-plan")
        hands.fill("[name=plan-edge]", "0.8")
        hands.click("[name=mesh]")

        # The roof: on its corners, 2.5 m high; then the crown is dragged.
        wait_for(lambda: "Canopy" in hands.text("#about") and "vertices" in hands.text("#about"), what="there is no mesh")
        hands.click("#supports [value=corners] + span")
        good(hands)
        assert float(hands.value(".region .number")) == pytest.approx(0.008)
        hands.fill("[name=rise]", "2.5")
        wait_for(lambda: float(hands.value(".region .number")) not in (0.008, 0.0), what="K does not follow")
        good(hands)
        hands.drag("#crown", 0, -30)
        wait_for(lambda: rise(hands) > 2.5, what="the crown cannot be dragged")
        good(hands)
        height = rise(hands)
        look("2-roof")

        # All is there again after a reload, also what was changed the moment before.
        for again in (height, 3.2):
            change = "const field = document.querySelector('[name=rise]'); field.value = args[0]; field.dispatchEvent(new Event('change'));"
            hands.read(("" if again == height else change) + "window.before = true; location.reload()", again)
            wait_for(
                lambda: hands.read("return window.before !== true && document.readyState === 'complete'"), what="it is not loaded again"
            )
            wait_for(lambda: "Canopy" in hands.text("#about") and hands.value("[name=rise]") not in ("", None), what="the roof is gone")
            assert rise(hands) == again
            good(hands)

        # Moulds of its panels, as a file.
        hands.seen("#making")
        hands.fill("#make-options [name=count]", "6")
        hands.seen("#make-key")
        assert "6 panels" in hands.text("#make-said")
        look("3-moulds")
        hands.click("#make-files [data-format='3dm']")
        found = wait_for(
            lambda: next((path for path in tmp_path.glob("Canopy mould*.3dm") if path.stat().st_size), None), what="no file came"
        )
        model = wait_for(lambda: rhino3dm.File3dm.Read(str(found)))
        layers = [layer.FullPath for layer in model.Layers]
        assert sum("Mould" in layer for layer in layers) and len(model.Objects) >= 7, layers
        assert model.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Meters


def test_a_design_is_the_same_after_a_link_and_a_file(open_server, tmp_path):
    """What the page packs into a link it unpacks to the same problem."""
    with open_hands("chromium", tmp_path) as hands:
        hands.open(f"{open_server.url}/#new")
        hands.seen(".example")
        packed, size = hands.read(
            "const { asFragment, fromFragment, asText } = await import('/page/design/packing.js');"
            "const data = await (await fetch('/api/v1/examples/example4_a')).json();"
            "const own = { ...data, wishes: { rise: 0.4, boxes: [] }, heights: { 3: 1.5 } };"
            "const state = { stage: 'shape', name: 'Nine', plan: null, data: own };"
            "const text = await asFragment(state); const back = await fromFragment(text);"
            "const rest = ({ vertices, ...more }) => JSON.stringify(more);"
            "const far = Math.max(...data.vertices.flat().map((x, k) => Math.abs(x - back.data.vertices.flat()[k])));"
            "return [[rest(back.data) === rest(state.data), far, asText(state) === asText({ ...back })], text.length]"
        )
        assert packed[0] and packed[1] < 1e-9 and packed[2] and size < 20_000
        broken = hands.read(
            "const { fromFragment } = await import('/page/design/packing.js');"
            "try { await fromFragment('abc'); } catch (error) { return error.message; }"
        )
        assert "incomplete" in broken


def test_lines_of_dxf_files_are_read_as_they_are(open_server, tmp_path):
    """What ezdxf writes, the page reads: lengths and areas are those of the curves."""
    ezdxf = pytest.importorskip("ezdxf", reason="the extra fabrication is not installed")
    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    # Curves outside of the outline would be left out.
    for a, b in (((0, -10), (50, -10)), ((50, -10), (50, 10)), ((0, 10), (50, 10)), ((0, 10), (0, -10))):
        space.add_line(a, b)
    space.add_lwpolyline([(2, 2, 1), (4, 2, 1)], format="xyb", close=True)
    space.add_circle((7, 3), 1)
    space.add_arc((20, 0), 5, 0, 180)
    space.add_ellipse((30, 0), (4, 0), 0.5)
    space.add_open_spline([(40, 0), (42, 3), (46, -3), (48, 0)])
    space.add_point((5, 5))
    path = tmp_path / "plan.dxf"
    drawing.saveas(path)
    from ezdxf.math import BSpline

    spline = BSpline([(40, 0), (42, 3), (46, -3), (48, 0)])
    length = sum(a.distance(b) for a, b in zip(list(spline.approximate(200)), list(spline.approximate(200))[1:]))
    with open_hands("chromium", tmp_path) as hands:
        hands.open(f"{open_server.url}/#new")
        hands.seen(".example")
        unit, lines, columns = json.loads(
            hands.read(
                "const { Api } = await import('/page/api.js');"
                "const { areaOf, segmentsOf } = await import('/page/draw/plan.js');"
                "const plan = await new Api(() => null).plan(new File([args[0]], 'plan.dxf'), 'dxf');"
                "const size = (l) => segmentsOf(l).reduce((s, [a, b]) => s + Math.hypot(a[0] - b[0], a[1] - b[1]), 0);"
                "const lines = plan.lines.map((l) => [l.closed, l.closed ? areaOf(l.points) : size(l)]);"
                "return JSON.stringify([plan.unit, lines, plan.columns])",
                path.read_text(),
            )
        )
    closed = sorted(size for is_closed, size in lines if is_closed)
    opened = sorted(size for is_closed, size in lines if not is_closed)
    assert unit == "mm" and [(own["x"], own["y"]) for own in columns] == [(5, 5)]
    assert closed == pytest.approx([3.1416, 3.1416, 25.133, 1000], rel=3e-3)
    assert opened == pytest.approx(sorted([15.708, length]), rel=3e-3)


def test_what_is_drawn_is_not_lost(open_server, tmp_path):
    """Enter or another tool closes the outline and ends a fold; what cannot be read is said, and stays to be mended."""
    with open_hands("chromium", tmp_path) as hands:
        hands.open(f"{open_server.url}/#new")
        hands.seen(".example")
        hands.click("#begin")
        hands.click("#draw-field")
        for text in ("0, 0", "10<0", "6<90"):
            hands.type(f"{text}\n")
        for text, said in (("0, 0", "already a point"), ("five", "a length such as 5")):
            hands.type(f"{text}\n")
            assert said in hands.text("#draw-hint") and hands.value("#draw-field") == text
            hands.chord("a")
        hands.type("10<180\n")
        hands.type("\n")
        wait_for(lambda: "Outline 10 × 6 m" in hands.text("#plan-list"), what="Enter does not close the outline")
        for text in ("5, 0", "6<90"):
            hands.type(f"{text}\n")
        hands.click("#draw-tools [value=column] + span")
        wait_for(lambda: "Crease 6 m" in hands.text("#plan-list"), what="the fold is lost with the tool")
        hands.click("#draw-tools [value=line] + span")
        hands.click("#draw-field")
        for text in ("1, 1", "2<0"):
            hands.type(f"{text}\n")
        hands.read("document.getElementById('draw-field').dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape', bubbles: true}))")
        hands.click("#draw-tools [value=column] + span")
        assert hands.read("return document.querySelectorAll('#plan-list li').length") == 2, "what is left by Escape is gone"


def test_an_outline_that_crosses_itself_is_told_so(open_server, tmp_path):
    with open_hands("chromium", tmp_path) as hands:
        hands.open(f"{open_server.url}/#new")
        hands.seen(".example")
        hands.click("#begin")
        hands.click("#draw-field")
        for text in ("0, 0", "10, 0", "-10, 10", "10, 0"):
            hands.type(f"{text}\n")
        hands.type("\n")
        hands.click("[name=mesh]")
        wait_for(lambda: "area that can be meshed" in hands.text("#desk-trouble"), what="nothing is said")


def test_the_tools_on_the_surface(open_server, tmp_path):
    """Points and sides are held, folds led and erased, by pointer and by keys; a section has its dimensions."""
    with open_hands("chromium", tmp_path) as hands:

        def choose(tool):
            hands.click(f"#hand [value={tool}] + span")

        def held():
            return hands.read("return document.querySelectorAll('#columns li').length")

        hands.open(f"{open_server.url}/#new")
        hands.seen(".example")
        hands.click("#begin")
        hands.click("#draw-tools [value=rectangle] + span")
        hands.click("#draw-field")
        hands.type("0, 0\n")
        hands.type("10, 10\n")
        hands.click("[name=mesh]")
        hands.seen("#solve")
        hands.click("#supports [value=corners] + span")
        good(hands)
        assert held() == 4

        # A point in the middle of the view is held, and let go again.
        choose("point")
        hands.click("#canvas")
        wait_for(lambda: held() == 5, what="the point is not held")
        hands.click("#undo")
        wait_for(lambda: held() == 4, what="it is not let go")
        hands.click("#redo")
        wait_for(lambda: held() == 5)
        hands.click("#undo")
        wait_for(lambda: held() == 4)
        good(hands)

        # By keys: a fold from the middle to the side, and away with it.
        choose("fold")
        hands.read("document.getElementById('canvas').focus()")
        hands.press("ArrowLeft")
        hands.press("Enter")
        for _ in range(30):
            hands.press("ArrowLeft")
        hands.press("Enter")
        wait_for(lambda: hands.shown("#crease-mark"), what="there is no fold")
        choose("erase")
        hands.read("document.getElementById('canvas').focus()")
        hands.press("ArrowLeft")
        hands.press("Enter")
        wait_for(lambda: not hands.shown("#crease-mark"), what="the fold stays")
        good(hands)

        choose("section")
        hands.click("#canvas", -60, 10)
        hands.click("#canvas", 60, -10)
        wait_for(lambda: "wide" in hands.text("#section figcaption"), what="there is no section")
        for by in ("zebra", "height", "fit", "mean", "largest", "smallest", "before", ""):
            pick = "const s = document.getElementById('more-colours'); s.value = args[0];"
            hands.read(pick + "s.dispatchEvent(new Event('change', {bubbles: true}))", by)
            wait_for(lambda by=by: hands.shown("#legend") == (by not in ("zebra", "")), what=f"the legend of {by} is wrong")
        assert hands.complaints() == []
