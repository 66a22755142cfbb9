"""What Lighthouse says of the first page."""

from __future__ import annotations

import json
import os
import shutil
import subprocess

import pytest

from ...support.browser import browser_paths
from ...support.hands import WEB
from ...support.server_process import running_server

pytestmark = pytest.mark.nightly
CHROME = "--headless=new --no-sandbox --disable-dev-shm-usage"


@pytest.mark.parametrize("form", ["desktop", "mobile"])
def test_lighthouse_finds_nothing_to_complain_of(tmp_path, form):
    """Scores depend on how busy the machine is: those of what does not are held to 100, of performance to 95 once in three runs."""
    lighthouse = WEB / ".bin" / "lighthouse"
    if not (lighthouse.exists() and shutil.which("node")) or browser_paths() is None:
        pytest.skip("there is no Lighthouse (npm ci --prefix tests/support/web) or no Chromium")
    report = tmp_path / "report.json"
    command = [lighthouse, "--quiet", "--output=json", f"--output-path={report}", f"--chrome-flags={CHROME}"]
    command += ["--preset=desktop"] if form == "desktop" else []
    environment = {**os.environ, "CHROME_PATH": browser_paths()[0]}
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server:
        found = []
        for _ in range(3):
            subprocess.run([*command, f"{server.url}/#new"], check=True, capture_output=True, env=environment, timeout=300)
            scores = {name: kind["score"] for name, kind in json.loads(report.read_text(encoding="utf-8"))["categories"].items()}
            assert scores["accessibility"] == scores["best-practices"] == 1.0, scores
            found.append(scores["performance"])
            if found[-1] >= 0.95:
                return
    raise AssertionError(f"performance of {found}")
