"""Deployment files: nginx in front of a server, and the unit of systemd."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from compas_cgc.client import Client
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.server.operation.configuration import read_configuration

from ...support.hops_client import Hops
from ...support.server_process import free_port
from ...support.server_process import running_server
from ...support.shapes import grid

FILES = Path(__file__).parents[3] / "docs" / "deploy"
NGINX = shutil.which("nginx", path=f"{os.environ.get('PATH', '')}:/usr/sbin")


def test_the_configuration_in_the_manual_can_be_read(tmp_path):
    found = read_configuration(FILES / "compas-cgc.toml")
    assert found["prefix"] == "/cgc" and found["limits"].days == 30
    page = (FILES.parent / "operators.md").read_text(encoding="utf-8")
    (tmp_path / "shown.toml").write_text(re.search(r"```toml\n(.*?)```", page, re.DOTALL).group(1))
    assert read_configuration(tmp_path / "shown.toml")["limits"].owner_bytes == 4_000_000_000


def test_the_body_limit_of_nginx_is_that_of_the_server():
    limit = read_configuration(FILES / "compas-cgc.toml")["limits"].body
    text = (FILES / "nginx.conf").read_text()
    assert f"client_max_body_size {limit // 2**20}m;" in text
    for body in re.findall(r"return \d+ '(.*?)';", text):
        assert set(json.loads(body)) == {"message", "values", "errors", "warnings"}


@contextmanager
def nginx_before(url, folder):
    """Run nginx with the server block of the manual, without TLS, and yield its port."""
    port = free_port()
    text = (FILES / "nginx.conf").read_text()
    text = re.sub(r"\n\s*ssl_certificate.*", "", text.replace("listen 443 ssl", f"listen 127.0.0.1:{port}"))
    text = text.replace("http://127.0.0.1:7331", url)
    paths = "".join(f"{kind}_temp_path {folder}/{kind};\n" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
    user = "user root;" if os.geteuid() == 0 else ""
    head = f"{user} pid {folder}/pid; error_log {folder}/error.log; daemon off;\nevents {{}}\nhttp {{ access_log off;\n{paths}\n"
    (folder / "nginx.conf").write_text(f"{head}{text}\n}}\n")
    process = subprocess.Popen([NGINX, "-p", str(folder), "-c", str(folder / "nginx.conf")])
    try:
        for _ in range(100):
            time.sleep(0.05)
            assert process.poll() is None, (folder / "error.log").read_text()
            if (folder / "pid").exists():
                break
        yield port
    finally:
        process.terminate()
        process.wait(20.0)


@pytest.mark.nightly
@pytest.mark.skipif(NGINX is None, reason="nginx is not installed")
def test_nginx_with_path_and_body_limit(tmp_path):
    (folder := tmp_path / "nginx").mkdir()
    folder.chmod(0o777)
    vertices, faces = grid(8)
    with (
        running_server(tmp_path / "jobs.sqlite", limits={}, trusted_proxy="127.0.0.1", prefix="/cgc") as server,
        nginx_before(server.url, folder) as port,
    ):
        url = f"http://127.0.0.1:{port}/cgc"
        server.address = f"127.0.0.1:{port}"
        # The Python client under the path, with a stream and a stored result.
        client = Client(url)
        seen = []
        result = client.solve(vertices.tolist(), faces.tolist(), supports="boundary", targets=0.2, on_progress=seen.append)
        assert result["status"] == "converged" and seen
        status, headers, content = server.ask("POST", "/cgc/api/v1/jobs", json.dumps({"vertices": [], "faces": []}))
        assert status == 422 and len(headers["X-Request-ID"]) == 32, "nginx gives the id"
        body = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.2}
        status, headers, content = server.ask("POST", "/cgc/api/v1/jobs", json.dumps(body))
        links = json.loads(content)
        assert status == 202 and links["status_url"].startswith("/cgc/api/v1/jobs/") and headers["Location"].endswith(links["status_url"])
        status, _, content = server.ask("GET", links["events_url"])
        assert status == 200 and b"event: done" in content
        # The page and its files.
        assert server.ask("GET", "/cgc")[0] == 301
        status, _, content = server.ask("GET", "/cgc/", Accept="text/html")
        names = re.findall(r'(?:href|src)="([^"#]+)"', content.decode())
        assert status == 200 and len(names) > 15
        assert {server.ask("GET", f"/cgc/{name}")[0] for name in names} == {200}
        # Hops: descriptions under the path, calls at the root.
        status, outputs, errors, _ = Hops(f"{url}/cgc/dome").solve(Mesh=mesh_from_arrays(*grid(8, 9.0)), K=0.01)
        assert status == 200 and not errors and outputs["Mesh"]
        # Body limit: beyond it JSON, below it the answer of the server.
        status, headers, content = server.ask("POST", "/cgc/api/v1/models?kind=obj", b"v 0 0 0\n" * (9 * 2**20))
        assert status == 413 and headers["Content-Type"] == "application/json" and "64 MB" in json.loads(content)["message"], content
        status, _, content = server.ask("POST", "/cgc/api/v1/models?kind=obj", b"v 0 0 0\n" * 400_000)
        assert status == 422 and "holds no mesh" in json.loads(content)["message"], content
        # Metrics stay on the machine.
        assert server.ask("GET", "/cgc/metrics")[0] == 404
        # Without the server, JSON too.
        server.process.terminate()
        server.process.wait(60.0)
        status, headers, content = server.ask("GET", "/cgc/version")
        assert status == 502 and "does not respond" in json.loads(content)["message"], content


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed")
def test_the_unit_of_systemd_is_valid(tmp_path):
    text = (FILES / "compas-cgc.service").read_text().replace("/opt/compas-cgc/bin/compas-cgc", sys.executable)
    (unit := tmp_path / "compas-cgc.service").write_text(text)
    found = subprocess.run(["systemd-analyze", "verify", "--man=no", str(unit)], capture_output=True, text=True)
    own = [line for line in found.stderr.splitlines() if "compas-cgc.service" in line]
    assert not own, own
