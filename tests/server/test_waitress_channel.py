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

LARGE = 64 * 2**20


@contextmanager
def served(app, threads=4, **limits):
    """Run a WSGI application behind connections with limits, and yield its port and the channels."""
    channels: dict = {}
    server = create_server(app, map=channels, _dispatcher=Threads(threads), host="127.0.0.1", port=0, asyncore_use_poll=True)
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


def until_closed(connection, seconds=20.0):
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
    with served(echo, stall=1.0, slowest=1000) as port:
        drips, steady = (socket.create_connection(("127.0.0.1", port)) for _ in range(2))
        for connection in (drips, steady):
            connection.sendall(b"POST / HTTP/1.1\r\nHost: a\r\nConnection: close\r\nContent-Length: 6000\r\n\r\n")
        started = time.monotonic()
        with pytest.raises(OSError):
            for _ in range(30):
                drips.sendall(b"x")
                steady.sendall(200 * b"x")
                time.sleep(0.1)
            pytest.fail("the connection was left open")
        assert 0.9 < time.monotonic() - started < 3.0
        sent = int((time.monotonic() - started) / 0.1) + 1
        assert sent < 30
        steady.sendall(b"x" * 6000)
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
        assert over.wait(20.0), "the thread is free again"
        assert len(until_closed(connection)) < LARGE


def test_a_slow_solve_and_a_slow_reader_are_no_stalls():
    def slow(environ, start):
        time.sleep(2.0)
        start("200 OK", [("Content-Length", str(2**24))])
        return [bytes(2**24)]

    with served(slow, stall=1.0) as port:
        connection = socket.create_connection(("127.0.0.1", port))
        connection.sendall(b"GET / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        connection.settimeout(20.0)
        count, pieces = 0, 0
        while piece := connection.recv(2**18):
            count, pieces = count + len(piece), pieces + 1
            time.sleep(0.05 if pieces < 60 else 0.0)
        assert count > 2**24


def test_a_request_that_waited_too_long_for_a_thread_is_answered_with_503():
    go, begun = threading.Event(), []

    def busy(environ, start):
        begun.append(environ["PATH_INFO"])
        go.wait(20.0)
        start("200 OK", [("Content-Length", "0")])
        return []

    with served(busy, threads=1, blocking=0.5) as port:
        first, second = (socket.create_connection(("127.0.0.1", port)) for _ in range(2))
        first.sendall(b"GET /first HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        while not begun:
            time.sleep(0.01)
        second.sendall(b"GET /second HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        time.sleep(1.0)
        go.set()
        assert b"200 OK" in until_closed(first)
        head, _, body = until_closed(second).partition(b"\r\n\r\n")
        assert b"503 Service Unavailable" in head and "busy for 0.5 s" in json.loads(body)["message"] and begun == ["/first"]
