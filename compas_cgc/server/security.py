"""Who may ask: known hosts, no foreign pages, and the key where one is set."""

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
    """Another site asks."""

    status = 403


class Misdirected(RequestError):
    """The request was meant for another host."""

    status = 421


def is_loopback(host: str) -> bool:
    """Tell whether an address to listen on can be reached from this machine only."""
    return host in LOOPBACK


def guard() -> None:
    """Check a request before anything of it is read.

    A web page can send requests to this machine: those carry its Origin, or after DNS
    rebinding a Host of its own.
    """
    name = hostname(request.headers.get("Host", ""))
    if name not in LOOPBACK and name not in current_app.config["HOSTS"]:
        raise Misdirected("this server does not answer to that host name; use the address that it printed, or start it with --name")
    origin = request.headers.get("Origin")
    if origin is not None and origin.rstrip("/") not in (f"http://{request.headers['Host']}", f"https://{request.headers['Host']}"):
        raise Forbidden("requests of pages of other sites are refused")
    # Their GETs carry no Origin, but whose they are; a link to the page may be anywhere.
    if request.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin") and not _is_link_to_page():
        raise Forbidden("requests of pages of other sites are refused")
    if current_app.config["KEYS"] and not _is_open() and _given_key() is None:
        raise Unauthorized(
            "the key is missing or wrong; send the server's key as RhinoComputeKey (in Hops: Preferences, Solver, Hops, API key)"
        )


def _is_link_to_page() -> bool:
    visits = request.headers.get("Sec-Fetch-Mode") == "navigate" and request.headers.get("Sec-Fetch-Dest") == "document"
    return visits and request.method == "GET" and request.path == "/"


def _is_open() -> bool:
    """Tell whether the address may be read without a key: descriptions, health and version, as Hops asks for them without."""
    return request.method in ("GET", "HEAD", "OPTIONS") and not request.path.startswith("/api/")


def keys_of(key: Union[str, Sequence[str], None]) -> tuple[str, ...]:
    """Return the keys of a server as a list, whether it has none, one or several."""
    return () if not key else (key,) if isinstance(key, str) else tuple(key)


def client_name() -> str:
    """Return who asks, as far as limits for one client go: the owner of one of several keys, or else an address."""
    keys = current_app.config["KEYS"]
    key = _given_key() if len(keys) > 1 else None
    # The store is no place for keys.
    return (request.remote_addr or "") if key is None else f"key:{hashlib.sha256(key.encode()).hexdigest()[:16]}"


def _given_key() -> Optional[str]:
    """Return that of the server's keys that a request has."""
    return key_among(current_app.config["KEYS"], request.headers.get("RhinoComputeKey", ""), request.headers.get("Authorization", ""))


def key_among(keys: Sequence[str], compute: str, authorization: str) -> Optional[str]:
    """Return that of the keys which the headers RhinoComputeKey or Authorization have, None if they have none."""
    scheme, _, bearer = authorization.partition(" ")
    given = [compute, bearer.strip() if scheme.lower() == "bearer" else ""]
    # All are compared, so that the time tells nothing.
    found = [key for key in keys for text in given if hmac.compare_digest(text.encode(), key.encode())]
    return found[0] if found else None


def hostname(host: str) -> str:
    """Return the name in a Host header, in small letters and without its port; nothing where there is none."""
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return ""
