"""Errors with the HTTP status that tells of them."""

from __future__ import annotations

__all__ = [
    "BadRequest",
    "Broken",
    "Busy",
    "Conflict",
    "Gone",
    "Late",
    "NotFound",
    "RequestProblem",
    "Stopping",
    "TooLarge",
    "Unprocessable",
    "error_body",
]


class RequestProblem(Exception):
    """A request that cannot be served; the text is a sentence for the client.

    Attributes
    ----------
    status
        HTTP status code.
    headers
        Further headers of the answer.
    """

    status = 400
    headers: dict[str, str] = {}


class BadRequest(RequestProblem):
    """The request is not what it should be."""


class NotFound(RequestProblem):
    """There is no such thing."""

    status = 404


class Conflict(RequestProblem):
    """Not now."""

    status = 409


class Gone(RequestProblem):
    """It was here once."""

    status = 410


class TooLarge(RequestProblem):
    """More than the server takes."""

    status = 413


class Unprocessable(RequestProblem):
    """The request is well formed, its content is not."""

    status = 422


class Busy(RequestProblem):
    """The queue is full."""

    status = 429
    headers = {"Retry-After": "1"}


class Broken(RequestProblem):
    """A worker ended, or has a fault."""

    status = 500


class Stopping(RequestProblem):
    """The server ends."""

    status = 503


class Late(RequestProblem):
    """The client would give up soon."""

    status = 504


def error_body(message: str, **more: object) -> dict:
    """Return the JSON object that every client can show: ``message`` for people and newer Hops, ``errors`` for Hops."""
    return {"message": message, "values": [], "errors": [message], "warnings": [], **more}
