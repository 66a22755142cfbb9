"""The dialog that takes a freeform design to panels on few moulds, in both browsers."""

from __future__ import annotations

import base64
import json
import os
from pathlib import Path

import pytest
import rhino3dm

from compas_cgc.discrete.nurbs import NurbsPatch
from compas_cgc.io.occt import opencascade
from compas_cgc.io.opencascade import step_content
from compas_cgc.io.opencascade import untrimmed_face
from compas_cgc.rationalisation import read_design

from ...support.freeform import nurbs_file
from ...support.hands import open_hands
from ...support.server_process import free_port
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly

# Of browser, width in pixels, and dark: each browser, each width and each colour scheme once.
WAYS = [pytest.param("chromium", 1440, False, id="chromium-light"), pytest.param("firefox", 400, True, id="firefox-narrow-dark")]
DROP = """
const [name, content] = args; const moved = new DataTransfer();
moved.items.add(new File([Uint8Array.from(atob(content), (sign) => sign.charCodeAt(0))], name));
window.dispatchEvent(Object.assign(new Event('drop', {bubbles: true, cancelable: true}), {dataTransfer: moved}));
"""
SLIDE = """
const slider = document.querySelector('#rationalise-slider'); slider.value = args[0];
for (const name of ['input', 'change']) slider.dispatchEvent(new Event(name, {bubbles: true}));
"""
COLOURS = """
const canvas = document.querySelector(args[0]); const { width, height } = canvas;
const { data } = canvas.getContext('2d').getImageData(0, 0, width, height); const found = new Map();
for (let k = 0; k < data.length; k += 4) if (data[k + 3] === 255) {
  const own = [data[k], data[k + 1], data[k + 2]].join(); found.set(own, (found.get(own) ?? 0) + 1);
}
return [...found].filter(([, count]) => count > 0.004 * width * height).map(([own]) => own)
"""
HEAD = "#rationalise-verdict h2"


@pytest.fixture
def roof(tmp_path):
    """Name and content of a smooth roof of 12 x 8 m that curves both ways."""
    path = tmp_path / "hall.3dm"
    nurbs_file(path, lambda x, y: 2.0 - 0.05 * (x - 5.0) ** 2 + 0.002 * (x - 5.0) ** 3 - 0.03 * (y - 4.0) ** 2, 12.0, 8.0)
    return path.name, base64.b64encode(path.read_bytes()).decode("ascii")


def given(hands, server, roof):
    """Open the dialog, and drop a design into it."""
    hands.open(f"{server.url}/#new")
    hands.seen(".example")
    hands.click("#rationalise-begin")
    hands.seen("#rationalise-close")
    hands.read(DROP, *roof)
    hands.seen("#rationalise-start")


def reload(hands):
    hands.read("window.before = true; location.reload()")
    wait_for(lambda: hands.read("return window.before === undefined && document.readyState === 'complete'"))


def figure(hands, row):
    return hands.read("return document.querySelectorAll('#rationalise-figures dd')[args[0]]?.textContent ?? ''", row)


@pytest.mark.parametrize("browser, width, dark", WAYS)
def test_a_design_becomes_a_roof_of_few_moulds(open_server, tmp_path, roof, browser, width, dark):
    shots = Path(os.environ.get("PAGE_PICTURES") or tmp_path)
    with open_hands(browser, tmp_path, width, 860, dark) as hands:

        def look(name):
            """Keep a picture, and find nothing wrong with what is shown."""
            (shots / f"rationalise-{browser}-{name}.png").write_bytes(hands.picture())
            assert not hands.violations(), name
            assert hands.complaints() == [], name
            wide = hands.read("return [document.querySelector('#rationalise').scrollWidth, innerWidth]")
            assert wide[0] <= wide[1] == width, "nothing is cut off"

        given(hands, open_server, roof)
        assert "12 × 8 ×" in hands.text("#rationalise-file-facts") and hands.value("[name=panel]") == "1"
        look("0-design")
        hands.fill("[name=panel]", "2,5")
        wait_for(lambda: "on 4 moulds" in hands.text(HEAD), what=f"no result: {hands.text('#rationalise-trouble')}")
        [job] = [own for own in open_server.client.jobs() if own["name"] == "hall" and own["has_result"]][:1]
        told = open_server.client.result(job["id"])
        assert told["panels"] == 15 and hands.text(HEAD) == "15 panels on 4 moulds"
        assert float(figure(hands, 0).split()[0]) == pytest.approx(1000.0 * told["distance"]["max"], rel=0.006)
        rows = hands.read("return [...document.querySelectorAll('#rationalise-moulds tr')].map((row) => row.lastElementChild.textContent)")
        assert [int(own) for own in rows] == told["panels_per_class"]
        assert len(hands.read(COLOURS, "#rationalise-panels")) >= 4 and "Plan" in hands.text("#rationalise-panels-head")
        hands.click("#rationalise-colours [value=distance] + span")
        wait_for(lambda: hands.text("#rationalise-legend .what") == "Distance from the design in mm")
        assert hands.text("#rationalise-distances-head").endswith("in mm, red above")
        ends = hands.read("return [...document.querySelectorAll('#rationalise-legend .ends span')].map((end) => end.textContent)")
        assert ends[0] == f"−{ends[2]}" and float(ends[2]) >= 1000.0 * told["distance"]["max"]
        look("1-moulds")

        # Another number is solved once, and is there at once the second time.
        hands.read(SLIDE, 2)
        wait_for(lambda: "on 2 moulds" in hands.text(HEAD), what="the slider does not solve")
        known = len(open_server.client.jobs())
        hands.read(SLIDE, 4)
        assert hands.text(HEAD) == "15 panels on 4 moulds"
        hands.read(SLIDE, 2)
        assert "on 2 moulds" in hands.text(HEAD) and len(open_server.client.jobs()) == known

        # The fewest moulds within a distance, then files and the roof.
        hands.click("#rationalise-aim [value=within] + span")
        hands.fill("[name=within]", "0,5")
        wait_for(lambda: "on 1 mould" in hands.text(HEAD) and "500 mm" in figure(hands, 2), what="the distance is not kept")
        bars = "return [...document.querySelectorAll('#rationalise-stops i:not([hidden])')].map((bar) => bar.nextSibling.textContent)"
        assert hands.read(bars) == ["1", "2", "4"]
        # The cheapest within it.
        hands.click("#rationalise-limit summary")
        given_costs = {"cost-saddle-mould": "9000", "cost-sphere-mould": "5000", "cost-flat-panel": "100"}
        for name, cost in given_costs.items():
            hands.fill(f"[name={name}]", cost)
        rows = "[...document.querySelectorAll('#rationalise-figures dt')]"
        costs = f"return {rows}.find((own) => own.textContent === 'Costs')?.nextSibling.textContent"
        wait_for(lambda: hands.read(costs) == "1,500", what=f"no costs: {hands.text('#rationalise-trouble')}")
        look("2-costs")
        # A place that counts ten times.
        hands.click("#rationalise-choices > .options summary")
        hands.fill("[name=weights]", "12,0 0.0 1.0 4")
        assert "five numbers" in hands.read("return document.querySelector('[name=weights]').validationMessage")
        hands.fill("[name=weights]", "12,0 0.0 1.0 4 10")
        hands.click("#rationalise-start")
        wait_for(lambda: "Weighted distance" in hands.text("#rationalise-figures"), what="no weights")
        look("3-weights")
        hands.fill("[name=weights]", " ")
        hands.click("#rationalise-start")
        wait_for(lambda: "Weighted distance" not in hands.text("#rationalise-figures"), what="the weights stay")
        for format, ending in (("3dm", "panels.3dm"), ("json", "moulds.json")):
            hands.click(f"#rationalise-files [data-format='{format}']")
            wait_for(lambda ending=ending: [own for own in tmp_path.glob(f"hall {ending}") if own.stat().st_size], what=f"no {ending}")
        assert wait_for(lambda: json.loads((tmp_path / "hall moulds.json").read_text(encoding="utf-8")))["panels"] == 15
        layers = wait_for(lambda: rhino3dm.File3dm.Read(str(tmp_path / "hall panels.3dm"))).Layers
        assert any("CGC Rationalised::Moulds" in layer.FullPath for layer in layers)
        hands.click("#rationalise-open")
        wait_for(lambda: hands.text(".verdict.good h2") == "Target reached", what=f"no roof: {hands.text('#rationalise-trouble')}")
        assert not hands.shown("#rationalise") and "15 regions" in hands.text("#about") and hands.complaints() == []


@pytest.mark.parametrize("browser", ("chromium", "firefox"))
def test_a_step_file_in_millimetres_becomes_panels(open_server, tmp_path, roof, browser):
    pytest.importorskip("compas_occt")
    drawn = read_design(tmp_path / roof[0]).surface
    content = step_content(untrimmed_face(opencascade(), NurbsPatch(drawn.control, drawn.knots, drawn.degrees).scaled(1e3)), "hall")
    with open_hands(browser, tmp_path) as hands:
        given(hands, open_server, ("hall.step", base64.b64encode(content).decode("ascii")))
        assert "12000 × 8000 ×" in hands.text("#rationalise-file-facts") and hands.text("#rationalise-form .unit.length") == "in mm"
        hands.fill("[name=panel]", "2500")
        wait_for(lambda: "15 panels on 4 moulds" in hands.text(HEAD), what=f"no result: {hands.text('#rationalise-trouble')}")
        assert figure(hands, 0).endswith("mm") and float(figure(hands, 0).split()[0]) < 50.0 and hands.complaints() == []


def test_a_job_is_stopped_and_wrong_files_and_numbers_get_a_sentence(open_server, tmp_path, roof):
    with open_hands("chromium", tmp_path) as hands:
        given(hands, open_server, roof)
        for name, content, sentence in (
            ("wrong.obj", "AAAA", "not a text file"),
            ("wrong.step", "AAAA", "STEP"),
            ("wrong.dwg", "AAAA", "unsupported format"),
        ):
            hands.read(DROP, name, content)
            wait_for(lambda sentence=sentence: sentence in hands.text("#rationalise-trouble"), what=hands.text("#rationalise-trouble"))
        assert hands.text("#rationalise-file-name") == "hall.3dm", "the last design stays"
        hands.fill("[name=panel]", "1.234,5")
        assert not hands.shown("#rationalise-stop")
        hands.fill("[name=panel]", "0.25")
        hands.seen("#rationalise-stop")
        hands.click("#rationalise-stop")
        wait_for(lambda: not hands.shown("#rationalise-stop"), what="the job goes on")
        assert hands.text("#rationalise-said") == "Stopped." or "Stopped before the end" in hands.text("#rationalise-verdict p")
        # A result that arrives while the dialog is closed is shown when it opens again.
        hands.fill("[name=panel]", "2")
        hands.click("#rationalise-close")
        wait_for(
            lambda: hands.read("return document.querySelector('#rationalise-results').ariaBusy") == "false", what="the job does not end"
        )
        hands.click("#rationalise-begin")
        wait_for(lambda: hands.text(HEAD) == "24 panels on 4 moulds", what=hands.text(HEAD))
        assert len(hands.read(COLOURS, "#rationalise-panels")) >= 4
        # Of formats that only designs have, files open the dialog by themselves.
        hands.click("#rationalise-close")
        hands.read(DROP, "roof.stl", "AAAA")
        hands.seen("#rationalise-trouble")


@pytest.mark.parametrize("browser", ("chromium", "firefox"))
def test_a_reload_finds_the_job_and_its_result_again(open_server, tmp_path, roof, browser):
    with open_hands(browser, tmp_path) as hands:
        given(hands, open_server, roof)
        before = {own["id"] for own in open_server.client.jobs()}

        def own_jobs():
            return [own for own in open_server.client.jobs() if own["id"] not in before]

        hands.click("#rationalise .options summary")
        hands.read("document.querySelector('#rationalise [name=supports]').value = 'boundary'")
        hands.fill("[name=panel]", "0,5")
        [job] = wait_for(own_jobs, what="no job")
        reload(hands)
        hands.seen("#rationalise-start")
        wait_for(lambda: hands.text(HEAD) == "400 panels on 4 moulds", what=f"no result: {hands.text('#rationalise-trouble')}")
        assert [own["id"] for own in own_jobs()] == [job["id"]], "it is the same job"
        assert hands.text("#rationalise-file-name") == "hall.3dm" and hands.value("#rationalise [name=supports]") == "boundary"
        # Results are found again, too, and others are solved from there.
        reload(hands)
        wait_for(lambda: hands.text(HEAD) == "400 panels on 4 moulds", what=f"no result: {hands.text('#rationalise-trouble')}")
        assert [own["id"] for own in own_jobs()] == [job["id"]] and hands.complaints() == []
        hands.fill("[name=panel]", "2")
        wait_for(lambda: hands.text(HEAD) == "24 panels on 4 moulds", what="no other result")
        # A dialog that was closed stays closed, and has its result when it opens.
        hands.click("#rationalise-close")
        reload(hands)
        hands.seen(".example")
        assert not hands.shown("#rationalise")
        hands.click("#rationalise-begin")
        wait_for(lambda: hands.text(HEAD) == "24 panels on 4 moulds", what=f"no result: {hands.text('#rationalise-trouble')}")
        # A new start of the page leaves it.
        hands.open("about:blank")
        hands.open(f"{open_server.url}/#new")
        hands.click("#rationalise-begin")
        hands.seen("#rationalise-close")
        assert hands.shown("#rationalise.bare") and wait_for(lambda: not own_jobs(), what="the job stays on the server")


def test_a_tab_that_is_closed_for_good_leaves_no_job(open_server, tmp_path, roof):
    before = {own["id"] for own in open_server.client.jobs()}
    with open_hands("chromium", tmp_path) as hands:
        given(hands, open_server, roof)
        hands.fill("[name=panel]", "0,2")
        [job] = wait_for(lambda: [own for own in open_server.client.jobs() if own["id"] not in before], what="no job")
        tab = hands.window.current_window_handle
        hands.window.switch_to.new_window("tab")
        blank = hands.window.current_window_handle
        hands.window.switch_to.window(tab)
        hands.window.close()
        hands.window.switch_to.window(blank)
        assert job["id"] in {own["id"] for own in open_server.client.jobs()}, "it may be a reload"
        wait_for(lambda: job["id"] not in {own["id"] for own in open_server.client.jobs()}, what="the job stays on the server")


def test_a_job_goes_on_when_its_server_is_killed_and_started_again(tmp_path, roof):
    port, store = free_port(), tmp_path / "jobs.sqlite"
    with open_hands("chromium", tmp_path) as hands:
        with running_server(store, workers=1, port=port) as server:
            given(hands, server, roof)
            hands.click("#rationalise-start")
            wait_for(lambda: server.client.jobs(), what="no job")
            server.process.kill()
            wait_for(lambda: "does not respond" in hands.text("#rationalise-said"), what="the cut is not seen")
        with running_server(store, workers=1, port=port):
            wait_for(lambda: "on 4 moulds" in hands.text(HEAD), what=f"no result: {hands.text('#rationalise-trouble')}")
