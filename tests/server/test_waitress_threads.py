"""Threads that serve requests come with them and go with them."""

from __future__ import annotations

import logging
import threading

import pytest

from compas_cgc.server.waitress_threads import Threads

from ..support.server_process import PATIENCE
from ..support.server_process import wait_for


class Request:
    """A request that takes until it is let go."""

    def __init__(self, fails=False):
        self.begun, self.go, self.over, self.cancelled = (threading.Event() for _ in range(4))
        self.fails = fails

    def service(self):
        self.begun.set()
        assert self.go.wait(PATIENCE)
        self.thread = threading.current_thread()
        self.over.set()
        if self.fails:
            raise ValueError("of no importance to others")

    def cancel(self):
        self.cancelled.set()


def ended(thread):
    thread.join(PATIENCE)
    return not thread.is_alive()


def test_threads_end_with_their_requests():
    threads, requests = Threads(8), [Request() for _ in range(3)]
    for request in requests:
        threads.add_task(request)
    assert all(request.begun.wait(PATIENCE) for request in requests)
    for request in requests:
        request.go.set()
    assert all(request.over.wait(PATIENCE) and ended(request.thread) for request in requests)
    assert threads.shutdown() is False


def test_requests_beyond_so_many_wait_for_a_thread():
    threads, first, second, third = Threads(2), Request(), Request(), Request()
    for request in (first, second, third):
        threads.add_task(request)
    assert first.begun.wait(PATIENCE) and second.begun.wait(PATIENCE) and not third.begun.is_set()
    third.go.set()
    first.go.set()
    assert third.over.wait(PATIENCE) and third.thread is first.thread
    second.go.set()
    assert threads.shutdown() is False


def test_a_request_that_fails_does_not_take_the_others_with_it(caplog):
    threads, bad, good = Threads(1), Request(fails=True), Request()
    good.go.set()
    with caplog.at_level(logging.ERROR, "waitress"):
        threads.add_task(bad)
        threads.add_task(good)
        bad.go.set()
        assert good.over.wait(PATIENCE)
    assert "of no importance" in caplog.text


def test_a_system_without_more_threads_serves_a_request_later(monkeypatch, caplog):
    threads, first, second = Threads(2), Request(), Request()
    first.go.set()
    second.go.set()
    with monkeypatch.context() as patch, caplog.at_level(logging.ERROR, "waitress"):
        patch.setattr(threading.Thread, "start", lambda thread: (_ for _ in ()).throw(RuntimeError("can't start new thread")))
        threads.add_task(first)
    assert "no thread" in caplog.text and not first.begun.is_set()
    threads.add_task(second)
    assert first.over.wait(PATIENCE) and second.over.wait(PATIENCE)


def let_go_once_nothing_waits(threads, request):
    wait_for(lambda: not threads.queue)
    request.go.set()


@pytest.mark.parametrize("busy", [False, True])
def test_the_end_drops_what_waits(busy):
    threads, first, second = Threads(1), Request(), Request()
    threads.add_task(first)
    threads.add_task(second)
    assert first.begun.wait(PATIENCE)
    if not busy:
        threading.Thread(target=let_go_once_nothing_waits, args=(threads, first)).start()
    assert threads.shutdown(timeout=0.2 if busy else PATIENCE) is True
    assert second.cancelled.is_set() and not second.begun.is_set() and first.over.is_set() is not busy
    first.go.set()
