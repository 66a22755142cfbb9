"""Errors of the client; every message is one sentence for the user."""

from __future__ import annotations

__all__ = ["ClientError", "Failed", "Refused", "ServerUnavailable"]


class ClientError(Exception):
    """Base class of all errors of the client."""


class ServerUnavailable(ClientError):
    """No server responds, or the address belongs to another program."""


class Refused(ClientError):
    """The server rejected the request.

    Attributes
    ----------
    status
        HTTP status code.
    message
        Message of the server.
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
        Message of the server or the solver.
    """

    def __init__(self, message: str, state: str = "failed"):
        super().__init__(message)
        self.state = state
