"""Access control: known host names, no requests from other sites, and the key if one is set."""

from __future__ import annotations

import hashlib
import hmac
from collections.abc import Sequence
from typing import Optional
from typing import Union
from urllib.parse import urlsplit

from flask import current_app
from flask import request

from .errors import RequestError

__all__ = ["Forbidden", "Misdirected", "Unauthorized", "client_name", "guard", "hostname", "is_loopback", "key_among", "keys_of"]

LOOPBACK = ("127.0.0.1", "localhost", "::1")


class Unauthorized(RequestError):
    """The key is missing or wrong."""

    status = 401
    headers = {"WWW-Authenticate": "Bearer"}


class Forbidden(RequestError):
    """The request comes from a page of another site."""

    status = 403


class Misdirected(RequestError):
    """The Host header does not name this server."""

    status = 421


def is_loopback(host: str) -> bool:
    """Check whether an address to listen on can be reached from this machine only."""
    return host in LOOPBACK


def guard() -> None:
    """Check the headers of a request before its body is read.

    Web pages can send requests to this machine. Such requests carry the Origin of the page or, after
    DNS rebinding, its Host.
    """
    name = hostname(request.headers.get("Host", ""))
    if name not in LOOPBACK and name not in current_app.config["HOSTS"]:
        raise Misdirected("this server does not accept that host name; use the address it printed at the start, or start it with --name")
    origin = request.headers.get("Origin")
    if origin is not None and origin.rstrip("/") not in (f"http://{request.headers['Host']}", f"https://{request.headers['Host']}"):
        raise Forbidden("requests from pages of other sites are not allowed")
    # GET requests carry Sec-Fetch-Site instead of Origin; links to the page are allowed from any site.
    if request.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin") and not _is_link_to_page():
        raise Forbidden("requests from pages of other sites are not allowed")
    if current_app.config["KEYS"] and not _is_open() and _given_key() is None:
        raise Unauthorized(
            "the key is missing or wrong; send the server's key as RhinoComputeKey (in Hops: Preferences, Solver, Hops, API key)"
        )


def _is_link_to_page() -> bool:
    visits = request.headers.get("Sec-Fetch-Mode") == "navigate" and request.headers.get("Sec-Fetch-Dest") == "document"
    return visits and request.method == "GET" and request.path == "/"


def _is_open() -> bool:
    """Check whether the address needs no key: descriptions, health and version, which Hops requests without a key."""
    return request.method in ("GET", "HEAD", "OPTIONS") and not request.path.startswith("/api/")


def keys_of(key: Union[str, Sequence[str], None]) -> tuple[str, ...]:
    """Return the keys of a server as a tuple."""
    return () if not key else (key,) if isinstance(key, str) else tuple(key)


def client_name() -> str:
    """Return the name of the client for limits per client: derived from its key if there are several, else its address."""
    keys = current_app.config["KEYS"]
    key = _given_key() if len(keys) > 1 else None
    # Keys must not be stored in plain text.
    return (request.remote_addr or "") if key is None else f"key:{hashlib.sha256(key.encode()).hexdigest()[:16]}"


def _given_key() -> Optional[str]:
    """Return the key of the server that the request carries, None if it carries none."""
    return key_among(current_app.config["KEYS"], request.headers.get("RhinoComputeKey", ""), request.headers.get("Authorization", ""))


def key_among(keys: Sequence[str], compute: str, authorization: str) -> Optional[str]:
    """Return the key in the header RhinoComputeKey or Authorization, None if neither holds one of the keys."""
    scheme, _, bearer = authorization.partition(" ")
    given = [compute, bearer.strip() if scheme.lower() == "bearer" else ""]
    # Compare all keys, so that the time reveals nothing.
    found = [key for key in keys for text in given if hmac.compare_digest(text.encode(), key.encode())]
    return found[0] if found else None


def hostname(host: str) -> str:
    """Return the name in a Host header, in lower case and without port; empty if there is none."""
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return ""
