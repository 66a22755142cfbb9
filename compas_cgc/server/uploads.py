"""Bodies of requests: read at once within the limit of all bodies in memory, or in pieces."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO

from flask import current_app
from flask import request

from .security import client_name

__all__ = ["body_held", "pieces"]

PIECE = 2**20  # bytes


@contextmanager
def body_held() -> Iterator[bytes]:
    """Return the body of the request, which counts as a body in memory until the end of the block.

    Raises
    ------
    Busy
        If too many bodies are in memory.
    RequestEntityTooLarge
        If the body is too large.
    """
    length = request.content_length or 0
    with current_app.extensions["bodies"].held(length, client_name()):
        # The stream checks the length, but holds two copies while it reads everything.
        _ = request.stream
        yield request.environ["wsgi.input"].read(length)


def pieces(stream: BinaryIO) -> Iterable[bytes]:
    """Yield the content of a stream in pieces."""
    return iter(lambda: stream.read(PIECE), b"")
