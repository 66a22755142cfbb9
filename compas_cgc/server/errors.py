"""Errors with the HTTP status that tells of them."""

from __future__ import annotations

__all__ = [
    "BadRequest",
    "WorkerFailed",
    "Busy",
    "Conflict",
    "Gone",
    "GatewayTimeout",
    "NotFound",
    "RequestError",
    "ServerStopping",
    "TooLarge",
    "Unprocessable",
    "UnsupportedEncoding",
    "error_body",
    "no_function",
]


LONGEST_PAUSE = 60  # seconds that a client is told to wait


class RequestError(Exception):
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


class BadRequest(RequestError):
    """The request is not what it should be."""


class NotFound(RequestError):
    """There is no such thing."""

    status = 404


class Conflict(RequestError):
    """Not now."""

    status = 409


class Gone(RequestError):
    """It was here once."""

    status = 410


class TooLarge(RequestError):
    """More than the server takes."""

    status = 413


class UnsupportedEncoding(RequestError):
    """The body is compressed."""

    status = 415


class Unprocessable(RequestError):
    """The request is well formed, its content is not."""

    status = 422


class Busy(RequestError):
    """The queue is full.

    Parameters
    ----------
    message
        A sentence for the client.
    seconds
        After which it may look different, as far as can be told.
    """

    status = 429

    def __init__(self, message: str, seconds: float = 1.0):
        super().__init__(message)
        self.headers = {"Retry-After": str(max(1, min(LONGEST_PAUSE, round(seconds))))}


class WorkerFailed(RequestError):
    """A worker ended, or has a fault."""

    status = 500


class ServerStopping(RequestError):
    """The server ends."""

    status = 503
    headers = {"Retry-After": "5"}


class GatewayTimeout(RequestError):
    """The client would give up soon."""

    status = 504


def error_body(message: str, **more: object) -> dict:
    """Return the JSON object that every client can show: ``message`` for people and newer Hops, ``errors`` for Hops."""
    return {"message": message, "values": [], "errors": [message], "warnings": [], **more}


def no_function(message: str) -> dict:
    """Return what an error has besides where Hops asks for the description of a function: it reads these before the error."""
    return {"Description": message, "InputNames": [], "OutputNames": [], "Inputs": [], "Outputs": []}
