"""Errors of the client, each with a sentence to show."""

from __future__ import annotations

__all__ = ["ClientError", "Failed", "Refused", "ServerUnavailable"]


class ClientError(Exception):
    """Base of all errors of the client."""


class ServerUnavailable(ClientError):
    """No server answers, or what answers is not one of this package."""


class Refused(ClientError):
    """The server does not take the request.

    Attributes
    ----------
    status
        HTTP status code.
    message
        What the server said.
    """

    def __init__(self, message: str, status: int):
        super().__init__(message)
        self.status = status


class Failed(ClientError):
    """The solve failed or was cancelled.

    Attributes
    ----------
    state
        ``failed`` or ``cancelled``.
    message
        What the server or the solver said.
    """

    def __init__(self, message: str, state: str = "failed"):
        super().__init__(message)
        self.state = state
