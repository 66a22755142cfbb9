"""Connections without progress are closed, and requests that waited too long are answered."""

from __future__ import annotations

import json
import socket
import threading
import time
from contextlib import contextmanager

import pytest
from waitress.server import create_server

from compas_cgc.server.limits import Limits
from compas_cgc.server.waitress_channel import channel_class
from compas_cgc.server.waitress_threads import Threads

from ..support.server_process import PATIENCE
from ..support.server_process import wait_for

LARGE = 64 * 2**20


@contextmanager
def served(app, threads=None, **limits):
    """Run a WSGI application behind connections with limits, and yield its port."""
    channels: dict = {}
    server = create_server(app, map=channels, _dispatcher=threads or Threads(4), host="127.0.0.1", port=0, asyncore_use_poll=True)
    server.channel_class = channel_class(Limits(**limits))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    try:
        yield server.effective_port
    finally:
        server.close()


def echo(environ, start):
    content = environ["wsgi.input"].read()
    start("200 OK", [("Content-Length", str(len(content)))])
    return [content]


def until_closed(connection, seconds=PATIENCE):
    """Return what arrives until the server closes the connection."""
    connection.settimeout(seconds)
    found = b""
    try:
        while piece := connection.recv(2**16):
            found += piece
    except ConnectionResetError:
        pass
    return found


def test_a_body_that_drips_is_dropped_and_a_steady_one_is_not():
    with served(echo, stall=1.0, slowest=20) as port:
        drips, steady = (socket.create_connection(("127.0.0.1", port)) for _ in range(2))
        head = b"POST / HTTP/1.1\r\nHost: a\r\nConnection: close\r\nContent-Length: 6000\r\n\r\n"
        started = time.monotonic()
        drips.sendall(head)
        # So many bytes would do for longer than this test may take.
        steady.sendall(head + 5000 * b"x")
        with pytest.raises(OSError):
            while True:
                drips.sendall(b"x")
                time.sleep(0.1)
        assert time.monotonic() - started > 1.0
        steady.sendall(1000 * b"x")
        assert b"200 OK" in until_closed(steady)


def test_a_client_that_does_not_read_its_response_is_dropped():
    over = threading.Event()

    def large(environ, start):
        start("200 OK", [("Content-Length", str(LARGE))])
        try:
            for _ in range(64):
                yield bytes(2**20)
        finally:
            over.set()

    with served(large, stall=1.0) as port:
        connection = socket.create_connection(("127.0.0.1", port))
        connection.sendall(b"GET / HTTP/1.1\r\nHost: a\r\n\r\n")
        assert over.wait(PATIENCE), "the thread is free again"
        assert len(until_closed(connection)) < LARGE


def test_a_slow_solve_and_a_slow_reader_are_no_stalls():
    def slow(environ, start):
        time.sleep(2.0)
        start("200 OK", [("Content-Length", str(2**24))])
        return [bytes(2**24)]

    with served(slow, stall=1.0) as port:
        connection = socket.create_connection(("127.0.0.1", port))
        connection.sendall(b"GET / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        connection.settimeout(PATIENCE)
        count, pieces = 0, 0
        while piece := connection.recv(2**18):
            count, pieces = count + len(piece), pieces + 1
            time.sleep(0.05 if pieces < 60 else 0.0)
        assert count > 2**24


def test_a_request_that_waited_too_long_for_a_thread_is_answered_with_503():
    go, begun = threading.Event(), []

    def busy(environ, start):
        begun.append(environ["PATH_INFO"])
        go.wait(PATIENCE)
        start("200 OK", [("Content-Length", "0")])
        return []

    threads = Threads(1)
    with served(busy, threads, blocking=PATIENCE) as port:
        first, second = (socket.create_connection(("127.0.0.1", port)) for _ in range(2))
        first.sendall(b"GET /first HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        wait_for(lambda: begun)
        second.sendall(b"GET /second HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        (waiting,) = wait_for(lambda: list(threads.queue))
        waiting.queued_at -= PATIENCE
        go.set()
        assert b"200 OK" in until_closed(first)
        head, _, body = until_closed(second).partition(b"\r\n\r\n")
        assert b"503 Service Unavailable" in head and f"busy for {PATIENCE:g} s" in json.loads(body)["message"] and begun == ["/first"]
