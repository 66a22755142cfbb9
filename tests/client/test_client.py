"""The client: what a script sees, and that it needs nothing but Python."""

from __future__ import annotations

import re
import socket
import subprocess
import sys
import tempfile
import threading
from http.server import BaseHTTPRequestHandler
from http.server import HTTPServer
from pathlib import Path

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc.client import Client
from compas_cgc.client import Failed
from compas_cgc.client import Refused
from compas_cgc.client import ServerUnavailable
from compas_cgc.client import ensure_server
from compas_cgc.client.server_process import start_server

from ..support.server_process import PATIENCE
from ..support.server_process import free_port
from ..support.shapes import grid


def test_it_needs_the_standard_library_only():
    code = (
        "import sys; before = set(sys.modules); import compas_cgc.client; "
        "names = {m.split('.')[0] for m in set(sys.modules) - before if not m.startswith('_')}; "
        "own = {m for m in sys.modules if m.startswith('compas_cgc.') and not m.startswith('compas_cgc.client')}; "
        "print(sorted(names - set(getattr(sys, 'stdlib_module_names', names)) - {'compas_cgc'}), sorted(own))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2])
    assert out.stdout.strip() == "[] ['compas_cgc._lazy']"


def test_a_solve_with_progress(open_server):
    seen = []
    vertices, faces = grid(10, 9.0)
    result = open_server.client.solve(
        vertices, faces, on_progress=seen.append, supports="boundary", targets=0.01, method="flow", interval=0.05
    )
    assert result["status"] == "converged" and np.allclose([K for K in result["curvature"] if K is not None], 0.01, atol=1e-7)
    assert seen[-1]["state"] == "succeeded"
    steps = []

    def watch(status):
        seen.append(status)
        if status["state"] == "running":
            steps.append(status["iteration"])

    seen.clear()
    slow = {"method": "flow", "settings": {"steps": 100000, "tolerance": 0.0}, "on_progress": watch, "cancel": lambda: len(set(steps)) > 2}
    with pytest.raises(Failed, match="cancelled after"):
        open_server.client.solve(*grid(30, 9.0), supports="boundary", targets=0.01, interval=0.05, **slow)
    assert steps == sorted(steps)
    news = [{**status, "elapsed": None} for status in seen]
    assert all(one != other for one, other in zip(news, news[1:])), "nobody is told the same twice"


def test_the_script_of_the_readme_runs(open_server, tmp_path, monkeypatch, capsys):
    text = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"```py\n(.*?)```", text, re.DOTALL)
    assert len([line for line in script.splitlines() if line.strip()]) <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(script.replace("http://127.0.0.1:7331", open_server.url), "README.md", "exec"), {})
    assert "converged" in capsys.readouterr().out
    assert CGCMesh.from_3dm("roof.3dm").number_of_faces() == 800


def test_a_solve_can_be_cancelled(open_server):
    asked = {"supports": "boundary", "targets": 0.5, "method": "flow", "settings": {"steps": 100000, "tolerance": 0.0}}
    looks = []
    with pytest.raises(Failed, match="cancelled after") as failure:
        open_server.client.solve(*grid(20), on_progress=looks.append, cancel=lambda: len(looks) > 6, interval=0.05, **asked)
    assert failure.value.state == "cancelled"


def test_refusals_and_failures_say_why(open_server):
    with pytest.raises(Refused, match="refers to vertex 999"):
        open_server.client.solve(*grid(3), supports=[999], targets=1.0)
    with pytest.raises(Failed, match="too large for this boundary"):
        open_server.client.solve(*grid(6), supports="boundary", targets=100.0)


def test_no_server_and_another_server_are_told_apart():
    with pytest.raises(ServerUnavailable, match="compas-cgc serve"):
        Client(f"http://127.0.0.1:{free_port()}", retries=0).version()

    class Other(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.end_headers()
            self.wfile.write(b"<html>")

        def log_message(self, *_):
            pass

    other = HTTPServer(("127.0.0.1", 0), Other)
    threading.Thread(target=other.serve_forever, daemon=True).start()
    with pytest.raises(ServerUnavailable, match="not a server of compas_cgc"):
        Client(f"http://127.0.0.1:{other.server_port}", retries=0).version()
    other.shutdown()
    other.server_close()


def test_a_lost_connection_is_tried_again(open_server):
    """A listener that hangs up twice before it lets requests through."""
    port = int(open_server.url.rsplit(":", 1)[1])
    hung_up = []

    def relay(listener):
        while True:
            try:
                ours, _ = listener.accept()
            except OSError:
                return
            if len(hung_up) < 2:
                hung_up.append(1)
                ours.close()
                continue
            theirs = socket.create_connection(("127.0.0.1", port))
            request = ours.recv(100_000).replace(f":{near}".encode(), f":{port}".encode())
            theirs.sendall(request.replace(b"Connection: keep-alive", b"Connection: close"))
            while chunk := theirs.recv(100_000):
                ours.sendall(chunk)
            ours.close()

    listener = socket.create_server(("127.0.0.1", 0))
    near = listener.getsockname()[1]
    threading.Thread(target=relay, args=(listener,), daemon=True).start()
    assert Client(f"http://127.0.0.1:{near}", retries=4).version()["name"] == "compas_cgc"
    assert len(hung_up) == 2
    listener.close()


def test_a_running_server_is_found_and_its_version_checked(open_server):
    said = []
    assert ensure_server(open_server.url, version=compas_cgc.__version__, say=said.append).health()["status"] == "ok"
    assert said == []
    with pytest.raises(ServerUnavailable, match="not 99.0"):
        ensure_server(open_server.url, version="99.0")


def test_a_server_that_cannot_start_shows_its_log(tmp_path):
    log = tmp_path / "log.txt"
    url = f"http://127.0.0.1:{free_port()}"
    with pytest.raises(ServerUnavailable, match="at least 8 printable.*log.txt"):
        ensure_server(url, key="short", log=log, say=lambda text: None)
    with pytest.raises(ServerUnavailable, match="cannot be run"):
        ensure_server(url, python=tmp_path / "no-python", log=log, say=lambda text: None)


def test_a_log_without_a_name_is_a_private_file_that_nobody_can_predict(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(subprocess, "Popen", lambda *args, **more: None)
    logs = [start_server("http://127.0.0.1:7331").log for _ in range(3)]
    assert len(set(logs)) == 3 and all(log.parent == tmp_path for log in logs)
    assert sys.platform == "win32" or all(not log.stat().st_mode & 0o077 for log in logs)


def test_a_server_is_started_where_there_is_none(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    started = []
    start = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", lambda *args, **kwargs: started.append(start(*args, **kwargs)) or started[-1])
    said = []
    try:
        client = ensure_server(f"http://127.0.0.1:{free_port()}", log=tmp_path / "log.txt", say=said.append)
        assert client.health()["workers"] >= 1 and "log.txt" in said[0]
    finally:
        for process in started:
            process.terminate()
            process.wait(PATIENCE)
