"""How waitress reads requests, but for two things.

Of a body that is too large no more than its length is kept: left to itself waitress would break the connection of a
client that is still sending, and nobody would read the sentence. And what is no HTTP is answered in JSON too.
"""

from __future__ import annotations

import json
from typing import Any

from waitress.buffers import OverflowableBuffer
from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser
from waitress.task import ErrorTask

from .errors import error_body

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


def channel_class(most: int) -> type[HTTPChannel]:
    """Return the class of connections that keep bodies of at most so many bytes."""

    class Parser(HTTPRequestParser):
        def parse_header(self, header_plus: bytes) -> None:
            super().parse_header(header_plus)
            if self.body_rcv is not None:
                self.body_rcv.buf = _Counted(self.adj.inbuf_overflow, most)

    class Channel(HTTPChannel):
        parser_class = Parser
        error_task_class = _JSONErrorTask

    return Channel
