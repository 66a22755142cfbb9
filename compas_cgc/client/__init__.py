"""A client of the compute server that requires only the standard library of Python 3.9."""

from __future__ import annotations

from .client import Client
from .errors import ClientError
from .errors import Failed
from .errors import Refused
from .errors import ServerUnavailable
from .server_process import ensure_server

__all__ = ["Client", "ClientError", "Failed", "Refused", "ServerUnavailable", "ensure_server"]
