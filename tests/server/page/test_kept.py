"""Designs that are kept: after a reload, by a link, in two tabs, and through a restart of the server."""

from __future__ import annotations

import pytest

from ...support.hands import BUSY
from ...support.hands import open_hands
from ...support.server_process import free_port
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly

OVER = ".verdict h2"
# What is kept in the browser: id, rise, whether a surface is with it, and the rises of its history.
KEPT = (
    "const base = await new Promise((done) => { const asked = indexedDB.open('compas_cgc', 1);"
    " asked.onupgradeneeded = () => asked.result.createObjectStore('designs', { keyPath: 'id' });"
    " asked.onsuccess = () => done(asked.result); });"
    "const all = await new Promise((done) => {"
    " const asked = base.transaction('designs').objectStore('designs').getAll(); asked.onsuccess = () => done(asked.result); });"
    "const rise = (own) => own.data?.wishes?.rise ?? null;"
    "base.close(); return all.map((own) => [own.id, rise(own), Boolean(own.solution), (own.states ?? []).map(rise)])"
)
# The times in ms since the beginning of the page: of the first verdict, and how many solves were asked for.
WATCH = (
    "const solves = performance.getEntriesByType('resource').filter(({ name }) => /api.v1.jobs/.test(name)).length;"
    "return document.querySelector('.verdict h2') && !document.querySelector('.verdict').hidden ? [performance.now(), solves] : null"
)


@pytest.fixture(params=["chromium", "firefox"])
def hands(request, tmp_path):
    with open_hands(request.param, tmp_path) as open_:
        yield open_


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with running_server(tmp_path_factory.mktemp("kept") / "jobs.sqlite", workers=1) as server:
        yield server


def solved_example(hands, url, name="example2"):
    hands.open(f"{url}/#new")
    hands.click(f"[data-example={name}]")
    hands.seen("#solve")
    hands.click("#solve")
    solved(hands)


def solved(hands):
    wait_for(lambda: hands.text(OVER) == "Target reached" and not hands.shown(BUSY), what="the roof is not solved")


def kept(hands):
    return {own[0]: own[1:] for own in hands.read(KEPT)}


def test_a_reload_shows_the_solved_roof_without_a_solve(hands, server):
    solved_example(hands, server.url)
    words = hands.text(".verdict dl")
    wait_for(lambda: any(own[1] for own in kept(hands).values()), what="the surface is not stored")
    hands.read("window.before = true; location.reload()")
    _, solves = wait_for(lambda: hands.read(f"if (window.before) return null; {WATCH}"), what="nothing is shown")
    assert solves == 0 and hands.text(".verdict dl") == words
    assert "Shown as stored" in hands.text(".verdict")


@pytest.mark.parametrize("mode", ["view", "copy"])
def test_a_link_shows_the_solved_roof_to_its_receiver_until_it_is_revoked(server, tmp_path, mode):
    with open_hands("chromium", tmp_path) as sender:
        solved_example(sender, server.url)
        words = sender.text(".verdict dl")
        sender.read("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
        sender.click("#share summary")
        sender.click(f"#share-{mode}")
        wait_for(lambda: "Whoever has it" in sender.text("#share-said"), what=sender.text("#share-said"))
        link = sender.read("return window.copied")
        assert len(link) < 100
        (tmp_path / "other").mkdir()
        with open_hands("chromium", tmp_path / "other") as receiver:
            receiver.open(link)
            _, solves = wait_for(lambda: receiver.read(WATCH), what="nothing is shown")
            assert solves == 0 and receiver.text(".verdict dl") == words
            assert receiver.shown("#panel") is (mode == "copy")
            assert bool(kept(receiver)) is (mode == "copy"), "what may only be viewed is not stored"
            assert receiver.complaints() == []
            sender.click("#revoke")
            wait_for(lambda: "1 link revoked" in sender.text("#share-said"), what=sender.text("#share-said"))
            receiver.open(link)
            wait_for(lambda: "revoked" in receiver.text("#trouble"), what="a revoked link still opens")


def test_two_tabs_with_the_same_design_lose_nothing(server, tmp_path):
    with open_hands("chromium", tmp_path) as hands:
        solved_example(hands, server.url)
        wait_for(lambda: len(kept(hands)) == 1)
        id = hands.read("return sessionStorage.getItem('compas_cgc.design')")
        tabs = [hands.window.current_window_handle]
        hands.window.switch_to.new_window("tab")
        # As the browser does when a tab is duplicated.
        hands.open(f"{server.url}/page/main.js")
        hands.read(f"sessionStorage.setItem('compas_cgc.design', '{id}')")
        hands.open(f"{server.url}/")
        wait_for(lambda: hands.read(WATCH), what="nothing is shown")
        tabs.append(hands.window.current_window_handle)
        edits = [[2.5, 2.6, 2.7], [1.5, 1.6, 1.7]]
        for k in range(3):
            for tab in (1, 0):
                hands.window.switch_to.window(tabs[tab])
                rise = edits[tab][k]
                hands.fill("[name=rise]", rise)
                wait_for(lambda rise=rise: rise in [own[0] for own in kept(hands).values()], what="not stored")
        found = sorted(kept(hands).values())
        assert [own[0] for own in found] == [1.7, 2.7]
        for own, rises in zip(found, reversed(edits)):
            assert [rise for rise in own[2] if rise in rises] == rises, "each tab has all of its own edits"
        assert "another tab" in hands.text("#share-said") and hands.read("return sessionStorage.getItem('compas_cgc.design')") != id


def test_a_solve_goes_on_when_its_server_is_killed_and_started_again(tmp_path):
    port, store = free_port(), tmp_path / "jobs.sqlite"
    with open_hands("chromium", tmp_path) as hands:
        with running_server(store, workers=1, port=port) as server:
            hands.open(f"{server.url}/#new")
            hands.click("[data-example=example2]")
            hands.seen("#solve")
            # So that the server is killed within the solve.
            hands.read(
                "const { fetch } = window; window.asked = 0; window.fetch = (...all) => { window.asked += 1; return fetch(...all); }"
            )
            hands.click("#solve")
            wait_for(lambda: hands.read("return window.asked"))
            server.process.kill()
            wait_for(lambda: "does not respond" in hands.text("#progress") or hands.text(OVER), what="the cut is not seen")
        with running_server(store, workers=1, port=port):
            solved(hands)
