"""How waitress reads requests, except that of a body that is too large no more than its length is kept.

Left to itself it would break the connection of a client that is still sending, and nobody would read the sentence.
"""

from __future__ import annotations

from waitress.buffers import OverflowableBuffer
from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser

__all__ = ["channel_class"]


class _Counted(OverflowableBuffer):
    """Keeps bytes up to a number and counts the rest; the length that it tells then has the request refused."""

    def __init__(self, overflow: int, most: int):
        super().__init__(overflow)
        self.most = most
        self.size = 0

    def __len__(self) -> int:
        return self.size

    def append(self, content: bytes) -> None:
        """Take more of the body."""
        self.size += len(content)
        if self.size <= self.most:
            super().append(content)


def channel_class(most: int) -> type[HTTPChannel]:
    """Return the class of connections that keep bodies of at most so many bytes."""

    class Parser(HTTPRequestParser):
        def parse_header(self, header_plus: bytes) -> None:
            super().parse_header(header_plus)
            if self.body_rcv is not None:
                self.body_rcv.buf = _Counted(self.adj.inbuf_overflow, most)

    class Channel(HTTPChannel):
        parser_class = Parser

    return Channel
