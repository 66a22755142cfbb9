"""Errors of requests, each with its HTTP status."""

from __future__ import annotations

__all__ = [
    "BadRequest",
    "WorkerFailed",
    "Busy",
    "Conflict",
    "Gone",
    "GatewayTimeout",
    "NoRoom",
    "NotFound",
    "RequestError",
    "ServerStopping",
    "TooLarge",
    "Unprocessable",
    "UnsupportedEncoding",
    "error_body",
    "no_function",
]


LONGEST_PAUSE = 60  # upper limit of the Retry-After header [s]


class RequestError(Exception):
    """A request that cannot be served. The message is one sentence for the client.

    Attributes
    ----------
    status
        HTTP status code.
    headers
        Further headers of the response.
    """

    status = 400
    headers: dict[str, str] = {}


class BadRequest(RequestError):
    """The request is malformed (400)."""


class NotFound(RequestError):
    """The requested resource does not exist (404)."""

    status = 404


class Conflict(RequestError):
    """The request conflicts with the present state (409)."""

    status = 409


class Gone(RequestError):
    """The requested resource no longer exists (410)."""

    status = 410


class TooLarge(RequestError):
    """The request exceeds a limit of the server (413)."""

    status = 413


class UnsupportedEncoding(RequestError):
    """The body is compressed, which is not supported (415)."""

    status = 415


class Unprocessable(RequestError):
    """The request is well formed, but its content is invalid (422)."""

    status = 422


class Busy(RequestError):
    """The queue is full.

    Parameters
    ----------
    message
        A sentence for the client.
    seconds
        Estimated time until a retry can succeed [s].
    """

    status = 429

    def __init__(self, message: str, seconds: float = 1.0):
        super().__init__(message)
        self.headers = {"Retry-After": str(max(1, min(LONGEST_PAUSE, round(seconds))))}


class WorkerFailed(RequestError):
    """A worker process ended unexpectedly or raised an unexpected error (500)."""

    status = 500


class NoRoom(RequestError):
    """The disk, or the budget of an owner, is full."""

    status = 507


class ServerStopping(RequestError):
    """The server is shutting down (503)."""

    status = 503
    headers = {"Retry-After": "5"}


class GatewayTimeout(RequestError):
    """The request exceeded its time limit (504)."""

    status = 504


def error_body(message: str, **more: object) -> dict:
    """Return the JSON object of an error: ``message`` for people and recent Hops, ``errors`` for older Hops."""
    return {"message": message, "values": [], "errors": [message], "warnings": [], **more}


def no_function(message: str) -> dict:
    """Return the additional fields of an error in the description of a function; Hops reads them before the error."""
    return {"Description": message, "InputNames": [], "OutputNames": [], "Inputs": [], "Outputs": []}
