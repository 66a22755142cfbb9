"""Hands and eyes of somebody at the page, in Chromium and in Firefox: they click, drag and type, and read what is shown."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path

import pytest

from .server_process import wait_for

BROWSERS = ("chromium", "firefox")
WEB = Path(__file__).parent / "web" / "node_modules"  # what package-lock.json there pins
AXE = (
    "return (await axe.run(document, {resultTypes: ['violations']})).violations.map(v => v.id + ': ' + v.nodes.map(n => n.html).join(' '))"
)


BUSY = ".verdict .old, #cancel, #outcome[aria-busy=true]"  # what is seen of a page that waits for a surface


def axe_script():
    """Return axe-core, None where it is not installed: ``npm ci --prefix tests/support/web``, or its path in AXE_CORE."""
    found = Path(os.environ.get("AXE_CORE") or WEB / "axe-core" / "axe.min.js")
    return found.read_text(encoding="utf-8") if found.exists() else None


class Hands:
    """What both browsers can do; places are pixels from the middle of an element."""

    def read(self, body, *arguments):
        """Run a script that only looks."""
        raise NotImplementedError

    def at(self, selector, dx=0, dy=0):
        """Bring an element into sight, and return the pixel of the window that is so far from its middle."""
        body = (
            "const all = [...document.querySelectorAll(args[0])].filter(e => e.checkVisibility());"
            "if (!all.length) return null;"
            "const box = () => all[0].getBoundingClientRect(); const m = b => [b.x + b.width / 2, b.y + b.height / 2];"
            "let [x, y] = m(box()); const top = document.elementFromPoint(x, y);"
            "if (!(top && (all[0].contains(top) || top.contains(all[0])))) { all[0].scrollIntoView({block: 'center'}); [x, y] = m(box()); }"
            "return [Math.round(x + args[1]), Math.round(y + args[2])]"
        )
        return wait_for(lambda: self.read(body, selector, dx, dy), what=f"{selector} is not shown")

    def text(self, selector):
        return self.read("return document.querySelector(args[0])?.textContent ?? ''", selector)

    def value(self, selector):
        return self.read("return document.querySelector(args[0])?.value ?? ''", selector)

    def shown(self, selector):
        return self.read("return [...document.querySelectorAll(args[0])].some(e => e.checkVisibility())", selector)

    def seen(self, selector):
        wait_for(lambda: self.shown(selector), what=f"{selector} is not shown")

    def open_example(self, server, name):
        """Choose an example on the first page of a server."""
        self.open(f"{server.url}/#new")
        self.seen(".example")
        self.click(f"[data-example={name}]")
        self.seen("#solve")

    def solve(self):
        """Solve what is shown, and wait for its verdict."""
        self.click("#solve")
        wait_for(lambda: self.text(".verdict h2") and not self.shown(BUSY), what="nothing is solved")

    def fill(self, selector, text):
        """Type a text into a field, in the place of what is there."""
        self.click(selector)
        self.chord("a")
        self.type(f"{text}\n")

    def violations(self):
        """Return what axe finds, None where it is not installed."""
        script = axe_script()
        if script is None:
            return None
        self.add_script(script)
        return self.read(AXE)


class ChromiumHands(Hands):
    """Through chromedriver."""

    def __init__(self, window):
        self.window = window

    def open(self, url):
        self.window.get("about:blank")
        self.window.get(url)

    def size(self, width, height, dark, ratio=1):
        touch = dict(width=width, height=height, deviceScaleFactor=ratio, mobile=False)
        self.window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", touch)
        scheme = dict(name="prefers-color-scheme", value="dark" if dark else "light")
        self.window.execute_cdp_cmd("Emulation.setEmulatedMedia", dict(features=[scheme]))

    def read(self, body, *arguments):
        # The promise of a script that is executed is awaited, and a rejected one is an error.
        return self.window.execute_script(f"return (async (args) => {{ {body} }})([...arguments])", *arguments)

    def add_script(self, text):
        self.window.execute_script(text)

    def _mouse(self, kind, x, y, **more):
        self.window.execute_cdp_cmd("Input.dispatchMouseEvent", dict(type=kind, x=x, y=y, **more))

    def move(self, selector, dx=0, dy=0):
        self._mouse("mouseMoved", *self.at(selector, dx, dy))

    def click(self, selector, dx=0, dy=0):
        self.drag(selector, 0, 0, dx, dy)

    def drag(self, selector, right, down, dx=0, dy=0, shift=False):
        x, y = self.at(selector, dx, dy)
        held = {"modifiers": 8} if shift else {}
        self._mouse("mouseMoved", x, y)
        self._mouse("mousePressed", x, y, button="left", clickCount=1, buttons=1, **held)
        for part in (0.5, 1.0) if right or down else ():
            self._mouse("mouseMoved", x + part * right, y + part * down, button="left", buttons=1, **held)
        self._mouse("mouseReleased", x + right, y + down, button="left", clickCount=1, **held)

    def type(self, text):
        from selenium.webdriver.common.keys import Keys

        self.window.switch_to.active_element.send_keys(text.replace("\n", Keys.ENTER))

    def chord(self, key, shift=False):
        from selenium.webdriver.common.keys import Keys

        self.window.switch_to.active_element.send_keys(Keys.CONTROL + (Keys.SHIFT if shift else "") + key)

    def press(self, name):
        from selenium.webdriver.common.keys import Keys

        named = {"Enter": Keys.ENTER, "ArrowLeft": Keys.ARROW_LEFT, "Delete": Keys.DELETE}
        self.window.switch_to.active_element.send_keys(named[name])

    def picture(self):
        return self.window.get_screenshot_as_png()

    def complaints(self):
        from .browser import complaints_of

        return [text for text in complaints_of(self.window) if "GL Driver Message" not in text]


class FirefoxHands(Hands):
    """Through the browser's own WebDriver BiDi."""

    def __init__(self, tab):
        self.tab = tab

    def open(self, url):
        self.tab.open("about:blank")
        self.tab.open(url)

    def size(self, width, height, dark):
        self.tab.size(width, height)

    def read(self, body, *arguments):
        return self.tab.script(f"return await (async (args) => {{ {body} }})(args)", *arguments)

    def add_script(self, text):
        self.tab.script(f"{text}; window.axe = axe;")

    def move(self, selector, dx=0, dy=0):
        x, y = self.at(selector, dx, dy)
        self.tab.pointer({"type": "pointerMove", "x": x, "y": y})

    def click(self, selector, dx=0, dy=0):
        self.drag(selector, 0, 0, dx, dy)

    def drag(self, selector, right, down, dx=0, dy=0):
        x, y = self.at(selector, dx, dy)
        moves = [{"type": "pointerMove", "x": round(x + part * right), "y": round(y + part * down)} for part in (0.5, 1.0)]
        press, lift = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        self.tab.pointer({"type": "pointerMove", "x": x, "y": y}, press, *(moves if right or down else []), lift)

    def type(self, text):
        named = {"\n": "\ue007"}
        for key in text:
            self.tab.keys({"type": "keyDown", "value": named.get(key, key)}, {"type": "keyUp", "value": named.get(key, key)})

    def chord(self, key, shift=False):
        held = ["\ue009", *(["\ue008"] if shift else []), key]
        down = [{"type": "keyDown", "value": value} for value in held]
        self.tab.keys(*down, *({"type": "keyUp", "value": value} for value in reversed(held)))

    def press(self, name):
        value = {"Enter": "\ue007", "ArrowLeft": "\ue012"}[name]
        self.tab.keys({"type": "keyDown", "value": value}, {"type": "keyUp", "value": value})

    def picture(self):
        return self.tab.picture()

    def complaints(self):
        return self.tab.complaints()


@contextmanager
def open_hands(browser: str, folder: Path, width=1440, height=900, dark=False):
    """Open a browser; the test is skipped where it is not installed."""
    if browser == "chromium":
        pytest.importorskip("selenium", reason="selenium is not installed")
        from .browser import browser_paths
        from .browser import open_browser

        if browser_paths() is None:
            pytest.skip("there is no Chromium with chromedriver on the path (Debian: apt-get install chromium chromium-driver)")
        with open_browser(folder, width, height) as window:
            hands = ChromiumHands(window)
            hands.size(width, height, dark)
            yield hands
        return
    pytest.importorskip("websocket", reason="websocket-client is not installed")
    from .firefox import firefox_path
    from .firefox import open_firefox
    from .firefox import screen_path

    if firefox_path() is None or screen_path() is None:
        pytest.skip("there is no Firefox with a virtual screen (Debian: apt-get install firefox-esr xvfb libgl1-mesa-dri)")
    with open_firefox(folder, dark) as tab:
        hands = FirefoxHands(tab)
        hands.size(width, height, dark)
        yield hands
