"""Connections of waitress with stricter limits.

The headers of a request must arrive within a few seconds, and the number of connections per address is limited: the one
with the least progress is closed for a new one. A body that is too large or comes without the key is read and dropped, because
waitress would close the connection while the client is still sending, and the client would not receive the error. A client
that sends `Expect: 100-continue` receives the error at once. Errors in the HTTP syntax are also reported as JSON.

Connections without progress are closed: a body that arrives too slowly, and a client that does not read its response. A request that
waited for a thread for too long is rejected instead of served.
"""

from __future__ import annotations

import json
import time
from socket import socket
from typing import Any
from typing import Optional

from waitress.buffers import OverflowableBuffer
from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser
from waitress.task import ErrorTask
from waitress.utilities import Error

from .errors import error_body
from .keys import Keys
from .limits import Limits

__all__ = ["channel_class"]


class _Counted(OverflowableBuffer):
    """Buffer that keeps bytes up to a limit and counts the rest; its length then causes waitress to reject the request."""

    def __init__(self, overflow: int, most: int):
        super().__init__(overflow)
        self.most = most
        self.size = 0

    def __len__(self) -> int:
        return self.size

    def append(self, s: bytes) -> None:
        """Append a piece of the body."""
        self.size += len(s)
        if self.size <= self.most:
            super().append(s)


class _Overloaded(Error):
    """A request waited too long for a thread."""

    code = 503
    reason = "Service Unavailable"


class _JSONErrorTask(ErrorTask):
    """Responds with JSON to requests that never reach the application."""

    def execute(self) -> None:
        """Send the response."""
        request: Any = self.request
        headers: Any = self.response_headers
        error = request.error
        text = error.body if isinstance(error, _Overloaded) else f"the request is not valid HTTP: {error.reason.lower()}, {error.body}"
        body = json.dumps(error_body(text)).encode()
        self.status = f"{error.code} {error.reason}"
        headers.extend([("Content-Type", "application/json"), ("X-Content-Type-Options", "nosniff")])
        self.set_close_on_finish()
        self.content_length = len(body)
        self.write(body)


def channel_class(limits: Limits, trusted_proxy: Optional[str] = None, keys: Optional[Keys] = None) -> type[HTTPChannel]:
    """Return a class of connections that enforces the limits.

    Parameters
    ----------
    limits
        Limits on bodies, headers and connections.
    trusted_proxy
        Address of the proxy, which may have any number of connections because they belong to different clients.
    keys
        Accepted keys; if there are any, a request with a body must carry one.
    """

    class Parser(HTTPRequestParser):
        def parse_header(self, header_plus: bytes) -> None:
            super().parse_header(header_plus)
            if self.body_rcv is None:
                return
            given = self.headers.get("RHINOCOMPUTEKEY", ""), self.headers.get("AUTHORIZATION", "")
            welcome = not keys or keys.find(*given) is not None
            if not welcome and getattr(self, "expect_continue", False):
                # The client waits for permission to send the body: reject the request at once.
                self.expect_continue = False
                self.completed = True
                # Close the connection, or a body sent nevertheless would be read as the next request.
                read: Any = self.headers
                read["CONNECTION"] = "close"
            self.body_rcv.buf = _Counted(self.adj.inbuf_overflow, limits.body if welcome else 0)

    class Channel(HTTPChannel):
        parser_class = Parser
        error_task_class = _JSONErrorTask

        def __init__(self, server: Any, sock: socket, addr: Any, adj: Any, map: Optional[dict] = None):
            # Start time of a request with incomplete headers; a new connection counts as one.
            self.head_since: Optional[float] = time.monotonic()
            # Start time of an incomplete body.
            self.body_since: Optional[float] = None
            # Last time at which a part of the pending response was sent, and since when it is so.
            self.unsent: tuple[Optional[float], float] = None, 0.0
            self.queued_at = 0.0
            super().__init__(server, sock, addr, adj, map=map)
            if trusted_proxy not in ("*", addr[0]):
                _make_room(self, list(server.active_channels.values()), limits.connections)

        def received(self, data: bytes) -> bool:
            found = super().received(data)
            reads_head = self.request is not None and not self.request.headers_finished
            now = time.monotonic()
            reads_body = self.request is not None and self.request.headers_finished
            self.head_since = (self.head_since or now) if reads_head else None
            self.body_since = (self.body_since or now) if reads_body else None
            return found

        def readable(self) -> bool:
            # Called in every loop, with or without new data.
            now = time.monotonic()
            if self.head_since is not None and now - self.head_since > limits.head_seconds:
                self.will_close = True
            if self.body_since is not None and now - self.body_since > limits.stall + self._received() / limits.slowest:
                self.will_close = True
            sent = self.last_activity if self.total_outbufs_len else None
            if sent != self.unsent[0]:
                self.unsent = sent, now
            elif sent is not None and now - self.unsent[1] > limits.stall:
                # Not by will_close, which waits until the client reads.
                self.handle_close()
                return False
            return super().readable()

        def _received(self) -> int:
            """Return the bytes of the incomplete body."""
            body = None if self.request is None else self.request.body_rcv
            return 0 if body is None else len(body.buf)

        def service(self) -> None:
            if time.monotonic() - self.queued_at > limits.blocking:
                waiting: Any = self.requests[0]
                waiting.error = _Overloaded(f"the server was busy for {limits.blocking:g} s; try again later")
            super().service()

    return Channel


def _make_room(newest: Any, channels: list, most: int) -> None:
    """Close the connection with the least progress if the address of the newest one has too many."""
    others = [own for own in channels if own is not newest and own.addr[0] == newest.addr[0] and not own.will_close]
    if len(others) >= most:
        # Connections whose request is being answered are kept.
        min((own for own in others if not own.requests), key=_progress, default=newest).will_close = True


def _progress(channel: Any) -> tuple[int, float]:
    """Return the progress of an incomplete request: in its headers, between two requests or in a body."""
    if channel.head_since is not None:
        return 0, channel.head_since
    return (1 if channel.request is None else 2), channel.last_activity
