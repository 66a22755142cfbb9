"""How waitress reads requests, but for some things.

The head of a request has to come within some seconds as a whole, and no address can have so many connections that others
find none: the one that got the least far makes room for a new one. Of a body that is too large, or comes without the key,
no more than its length is kept: left to itself waitress would break the connection of a client that is still sending, and
nobody would read the sentence. A client that asks before it sends hears it at once. And what is no HTTP is answered in JSON
too.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from socket import socket
from typing import Any
from typing import Optional

from waitress.buffers import OverflowableBuffer
from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser
from waitress.task import ErrorTask

from .errors import error_body
from .limits import Limits
from .security import key_among

__all__ = ["channel_class"]


class _Counted(OverflowableBuffer):
    """Keeps bytes up to a number and counts the rest; the length that it tells then has the request refused."""

    def __init__(self, overflow: int, most: int):
        super().__init__(overflow)
        self.most = most
        self.size = 0

    def __len__(self) -> int:
        return self.size

    def append(self, s: bytes) -> None:
        """Take more of the body."""
        self.size += len(s)
        if self.size <= self.most:
            super().append(s)


class _JSONErrorTask(ErrorTask):
    """Answers what never reaches the application."""

    def execute(self) -> None:
        """Send the answer."""
        request: Any = self.request
        headers: Any = self.response_headers
        error = request.error
        body = json.dumps(error_body(f"the request is not as HTTP wants it: {error.reason.lower()}, {error.body}")).encode()
        self.status = f"{error.code} {error.reason}"
        headers.extend([("Content-Type", "application/json"), ("X-Content-Type-Options", "nosniff")])
        self.set_close_on_finish()
        self.content_length = len(body)
        self.write(body)


def channel_class(limits: Limits, trusted_proxy: Optional[str] = None, keys: Sequence[str] = ()) -> type[HTTPChannel]:
    """Return the class of connections that keep to the limits.

    Parameters
    ----------
    limits
        Of bodies, heads and connections.
    trusted_proxy
        Its address may have any number of connections, as they are other people's.
    keys
        Of which a request that brings a body has to have one, where there are any.
    """

    class Parser(HTTPRequestParser):
        def parse_header(self, header_plus: bytes) -> None:
            super().parse_header(header_plus)
            if self.body_rcv is None:
                return
            given = self.headers.get("RHINOCOMPUTEKEY", ""), self.headers.get("AUTHORIZATION", "")
            welcome = not keys or key_among(keys, *given) is not None
            if not welcome and getattr(self, "expect_continue", False):
                # It has not sent anything yet, and is told what is missing without it.
                self.expect_continue = False
                self.completed = True
                # Else what it sends in spite of the answer would be read as its next request.
                read: Any = self.headers
                read["CONNECTION"] = "close"
            self.body_rcv.buf = _Counted(self.adj.inbuf_overflow, limits.body if welcome else 0)

    class Channel(HTTPChannel):
        parser_class = Parser
        error_task_class = _JSONErrorTask

        def __init__(self, server: Any, sock: socket, addr: Any, adj: Any, map: Optional[dict] = None):
            # When the request began whose head is not here yet; a connection is made to send one.
            self.head_since: Optional[float] = time.monotonic()
            super().__init__(server, sock, addr, adj, map=map)
            if trusted_proxy not in ("*", addr[0]):
                _make_room(self, list(server.active_channels.values()), limits.connections)

        def received(self, data: bytes) -> bool:
            found = super().received(data)
            reads_head = self.request is not None and not self.request.headers_finished
            self.head_since = (self.head_since or time.monotonic()) if reads_head else None
            return found

        def readable(self) -> bool:
            # Asked in every round, whether anything comes or not.
            if self.head_since is not None and time.monotonic() - self.head_since > limits.head_seconds:
                self.will_close = True
            return super().readable()

    return Channel


def _make_room(newest: Any, channels: list, most: int) -> None:
    """Close a connection of the address of the newest one if it has too many: that which waits for the least."""
    others = [own for own in channels if own is not newest and own.addr[0] == newest.addr[0] and not own.will_close]
    if len(others) >= most:
        # None whose request is being answered.
        min((own for own in others if not own.requests), key=_progress, default=newest).will_close = True


def _progress(channel: Any) -> tuple[int, float]:
    """Return how far a connection is whose request is not complete: in its head, between two requests, or in a body."""
    if channel.head_since is not None:
        return 0, channel.head_since
    return (1 if channel.request is None else 2), channel.last_activity
