"""Firefox on a virtual screen and without geckodriver: its own WebDriver BiDi (https://w3c.github.io/webdriver-bidi/)."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from contextlib import contextmanager
from pathlib import Path

from .server_process import PATIENCE

PREFERENCES = {
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "toolkit.telemetry.enabled": False,
    "app.update.enabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "browser.download.folderList": 2,
    "browser.download.useDownloadDir": True,
    "browser.download.always_ask_before_handling_new_types": False,
    "webgl.force-enabled": True,
    "dom.disable_beforeunload": True,
    "ui.prefersReducedMotion": 1,
}


def firefox_path():
    """Return Firefox, None where there is none."""
    return shutil.which("firefox-esr") or shutil.which("firefox")


def screen_path():
    """Return what runs a program on a virtual screen, None where there is none."""
    return shutil.which("xvfb-run")


class Firefox:
    """One tab of Firefox."""

    def __init__(self, socket):
        self.socket = socket
        self.number = 0
        self.log = []
        self.ask("session.new", capabilities={})
        self.ask("session.subscribe", events=["log.entryAdded"])
        self.tab = self.ask("browsingContext.getTree")["contexts"][0]["context"]

    def ask(self, method, **params):
        """Send a command and return its result."""
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            answer = json.loads(self.socket.recv())
            if answer.get("id") != self.number:
                if answer.get("method") == "log.entryAdded" and answer["params"]["level"] in ("error", "warn"):
                    self.log.append(answer["params"]["text"])
                continue
            assert answer["type"] == "success", answer
            return answer["result"]

    def open(self, url):
        self.ask("browsingContext.navigate", context=self.tab, url=url, wait="complete")

    def size(self, width, height):
        self.ask("browsingContext.setViewport", context=self.tab, viewport={"width": width, "height": height})

    def script(self, body, *arguments):
        """Run the body of a function, which may wait, and return plain data."""
        function = f"async (text) => JSON.stringify(await (async (...args) => {{ {body} }})(...JSON.parse(text)) ?? null)"
        found = self.ask(
            "script.callFunction",
            functionDeclaration=function,
            awaitPromise=True,
            target={"context": self.tab},
            arguments=[{"type": "string", "value": json.dumps(arguments)}],
        )
        assert found["type"] == "success", found
        return json.loads(found["result"]["value"])

    def pointer(self, *steps):
        self.ask("input.performActions", context=self.tab, actions=[{"type": "pointer", "id": "mouse", "actions": list(steps)}])

    def keys(self, *steps):
        self.ask("input.performActions", context=self.tab, actions=[{"type": "key", "id": "keys", "actions": list(steps)}])

    def picture(self):
        """Return what is seen as the bytes of a PNG."""
        return base64.b64decode(self.ask("browsingContext.captureScreenshot", context=self.tab)["data"])

    def complaints(self):
        found, self.log = self.log, []
        return found


@contextmanager
def open_firefox(folder: Path, dark=False):
    """Run Firefox with a profile and downloads of its own."""
    import websocket

    profile = folder / "profile"
    profile.mkdir()
    preferences = {**PREFERENCES, "browser.download.dir": str(folder), "ui.systemUsesDarkTheme": int(dark)}
    lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in preferences.items()]
    (profile / "user.js").write_text("\n".join(lines), encoding="utf-8")
    # Without a screen it has no WebGL; on a virtual one it has.
    screen = [screen_path(), "-a", "-s", "-screen 0 1600x1200x24"]
    command = [*screen, firefox_path(), "--no-remote", "--profile", str(profile), "--remote-debugging-port", "0", "about:blank"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, start_new_session=True)
    try:
        end = time.monotonic() + PATIENCE
        found = None
        while not found and time.monotonic() < end:
            line = process.stderr.readline()
            found = re.search(r"WebDriver BiDi listening on (ws://\S+)", line)
            assert line or process.poll() is None, "Firefox ended before it began"
        # A full pipe would stop it.
        threading.Thread(target=process.stderr.read, daemon=True).start()
        socket = websocket.create_connection(f"{found.group(1)}/session", timeout=PATIENCE, suppress_origin=True)
        try:
            yield Firefox(socket)
        finally:
            socket.close()
    finally:
        # The screen and all of the browser's processes with it.
        os.killpg(process.pid, signal.SIGTERM)
        process.wait(PATIENCE)
