"""Bodies of requests, within the limit of all bodies in memory."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from flask import current_app
from flask import request

from ..security import client_name

__all__ = ["body_held"]


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
