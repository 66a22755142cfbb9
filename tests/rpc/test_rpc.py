"""The service for compas.rpc, through Proxy as a script uses it."""

from __future__ import annotations

import dataclasses
import http.client
import os
import socket
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from xmlrpc.client import Fault
from xmlrpc.client import ServerProxy

import pytest
from compas.datastructures import Mesh
from compas.rpc import Proxy
from compas.rpc import RPCServerError

from compas_cgc import CGCMesh
from compas_cgc import __version__
from compas_cgc import solve
from compas_cgc.rpc.service import LIMITS
from compas_cgc.rpc.service import Handler
from compas_cgc.rpc.service import RPCServer
from compas_cgc.rpc.service import Service
from compas_cgc.server.api.tasks import solve_job
from compas_cgc.server.errors import RequestError
from compas_cgc.server.jobs.engine import Jobs
from compas_cgc.server.jobs.store import Store

from ..support.server_process import PATIENCE
from ..support.server_process import running_rpc
from ..support.server_process import wait_for


def roof(n=8):
    mesh = CGCMesh.from_meshgrid(dx=9, nx=n)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


ENDLESS = {"method": "flow", "settings": {"steps": 100000, "tolerance": 0.0}}


def test_it_says_who_it_is(proxy):
    assert proxy.version() == {"name": "compas_cgc", "version": __version__}


def test_a_mesh_comes_back_as_what_it_was(proxy):
    result = proxy.solve(roof())
    assert isinstance(result["mesh"], CGCMesh) and result["status"] == "converged" and result["max_error"] < 1e-7
    assert result["mesh"].arrays()[0].tolist() == solve(roof()).vertices.tolist()
    plain = proxy.solve(Mesh.from_meshgrid(9, 8), supports="boundary", targets=0.01)
    assert type(plain["mesh"]) is Mesh and plain["mesh"].number_of_vertices() == 81
    vertices, faces = roof().arrays()
    arrays = proxy.solve(vertices=vertices.tolist(), faces=faces.tolist(), supports="boundary", targets=0.01)
    assert len(arrays["vertices"]) == 81


def test_a_long_solve_is_followed_and_cancelled_while_others_are_answered(proxy):
    id = proxy.submit(roof(20), **ENDLESS)
    wait_for(lambda: proxy.status(id)["iteration"])
    assert proxy.version()["name"] == "compas_cgc"
    with pytest.raises(RPCServerError, match="request the result after it has succeeded"):
        proxy.result(id)
    proxy.cancel(id)
    wait_for(lambda: proxy.status(id)["state"] != "running")
    assert proxy.status(id)["state"] == "cancelled" and proxy.result(id)["status"] == "cancelled"


@pytest.mark.parametrize("name", ["os.getpid", "_dispatch", "_jobs.close", "on_module_imported", "system.listMethods"])
def test_nothing_else_can_be_called(proxy, name):
    with pytest.raises(RPCServerError, match="not part of the API"):
        Proxy.__getattr__(proxy, name)()


def _calls_of(proxy):
    return [getattr(proxy, name) for name in ("status", "result", "cancel")]


def test_errors_are_sentences_without_traces(proxy):
    for call, part in (
        (lambda: proxy.solve(roof(), method="magic"), "'method' must be one of"),
        (lambda: proxy.solve(roof(), targets=9.0), "too large for this boundary"),
        (lambda: proxy.submit({"dtype": "os/system", "data": {}}), "COMPAS Mesh"),
        (lambda: proxy.status("nobody-here"), "no job"),
        (lambda: proxy.status(), "status cannot be called with these arguments: missing a required argument: 'id'"),
        (lambda: proxy.result("nobody-here", colour="red"), "unexpected keyword argument 'colour'"),
        *(
            (lambda call=call, id=id: call(id), "the id of a job must be a string")
            for call in _calls_of(proxy)
            for id in (5, None, ["a"], {"a": 1})
        ),
    ):
        with pytest.raises(RPCServerError, match=part) as error:
            call()
        assert "Traceback" not in str(error.value) and "Service." not in str(error.value)


def test_a_path_of_the_client_is_not_imported_from(proxy, tmp_path):
    (tmp_path / "evil.py").write_text("raise SystemExit")
    server = ServerProxy(proxy.address)
    assert "not part of the API" in getattr(server, "evil.run")('{"args": [], "kwargs": {}}', str(tmp_path))
    assert "a call must be a JSON object" in server.version("[]")


def test_web_pages_and_other_hosts_are_refused(proxy):
    for headers in ({"Origin": "https://evil.example"}, {"Host": "evil.example"}, {"Content-Length": "999999999"}):
        connection = http.client.HTTPConnection(proxy.address.split("//")[1], timeout=PATIENCE)
        connection.request("POST", "/RPC2", b"", headers)
        assert connection.getresponse().status in (403, 413)
        connection.close()


def test_a_port_in_use_is_said(proxy):
    port = proxy.address.rsplit(":", 1)[1]
    command = [sys.executable, "-m", "compas_cgc.rpc.service", "--port", port, "--autoreload"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 2 and "choose another with --port" in done.stderr


def test_the_service_needs_no_web_framework(tmp_path):
    for name in ("flask", "werkzeug", "waitress"):
        (tmp_path / f"{name}.py").write_text(f"raise ModuleNotFoundError('no module named {name}', name='{name}')")
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH"), os.getcwd()])])
    command = [sys.executable, "-m", "compas_cgc.rpc.service", "--help"]
    said = subprocess.run(command, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, timeout=PATIENCE)
    assert (said.returncode, said.stderr) == (0, "") and "Serve compas.rpc" in said.stdout


def test_only_the_operator_stops_the_service(proxy, monkeypatch):
    port = proxy.address.rsplit(":", 1)[1]
    for address in (proxy.address, f"http://operator:wrong-key@127.0.0.1:{port}", f"http://operator:@127.0.0.1:{port}"):
        with pytest.raises(Fault, match="remote_shutdown requires the key of the service"):
            ServerProxy(address).remote_shutdown()
    assert proxy.version()["name"] == "compas_cgc"
    monkeypatch.setenv("COMPAS_CGC_KEY", "the-key-of-the-operator")
    with running_rpc() as other:
        port = other.address.rsplit(":", 1)[1]
        with pytest.raises(Fault):
            ServerProxy(other.address).remote_shutdown()
        assert ServerProxy(f"http://operator:the-key-of-the-operator@127.0.0.1:{port}").remote_shutdown() == 1
        other._process.wait(PATIENCE)


def test_a_half_open_connection_is_dropped(monkeypatch):
    monkeypatch.setattr(Handler, "timeout", 0.3)
    with RPCServer(("127.0.0.1", 0)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        connection = socket.create_connection(server.server_address)
        connection.sendall(b"POST /RPC2 HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\n<?xml")
        connection.settimeout(PATIENCE)
        while connection.recv(1000):
            pass
        server.shutdown()


def test_jobs_expire_and_are_forgotten():
    assert LIMITS.days == 1.0
    limits = dataclasses.replace(LIMITS, days=1e-9)
    jobs = Jobs(ThreadPoolExecutor(1), Store(":memory:"), solve_job, limits)
    service = Service(jobs)
    id = service.submit(vertices=[[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces=[[0, 1, 2]], supports="boundary")
    jobs.wait(id, PATIENCE)
    jobs._tidy()
    with pytest.raises(RequestError, match="no job"):
        service.status(id)
    other = service.submit(vertices=[[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces=[[0, 1, 2]], supports="boundary")
    assert list(service._given) == [other]
    jobs.close()
