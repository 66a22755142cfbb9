"""Access control: known host names, no requests from other sites, and the key if one is set."""

from __future__ import annotations

import logging
from typing import Optional
from urllib.parse import urlsplit

from flask import current_app
from flask import g
from flask import request

from .errors import RequestError
from .keys import LOCAL
from .keys import NAME
from .keys import OPERATOR
from .keys import Key

__all__ = ["Forbidden", "Misdirected", "TooManyKeys", "Unauthorized", "caller", "client_name", "guard", "hostname", "is_loopback", "owner"]

LOOPBACK = ("127.0.0.1", "localhost", "::1")
OPERATOR_PATHS = ("/metrics",)
SHARED_PATH = "/api/v1/shared/"  # whoever has the random token that follows may read the design
OWNER_HEADER = "CGC-Owner"
log = logging.getLogger(__name__)


class Unauthorized(RequestError):
    """The key is missing or wrong."""

    status = 401
    headers = {"WWW-Authenticate": "Bearer"}


class TooManyKeys(RequestError):
    """An address tried too many wrong keys."""

    status = 429

    def __init__(self, seconds: float):
        super().__init__(f"too many wrong keys came from this address; try again in {seconds:.0f} s")
        self.headers = {"Retry-After": str(max(1, round(seconds)))}


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
    g.caller = _identified()
    if g.caller is None and not _is_open():
        raise Unauthorized(
            "the key is missing or wrong; send the server's key as RhinoComputeKey (in Hops: Preferences, Solver, Hops, API key)"
        )
    if request.path in OPERATOR_PATHS and (g.caller is None or g.caller.role != OPERATOR):
        raise (Unauthorized if g.caller is None else Forbidden)("this address requires the key of an operator")


def _identified() -> Optional[Key]:
    """Return the key of a request, None if it is missing or wrong, or if the address sent too many wrong keys."""
    keys, throttle = current_app.config["KEYS"], current_app.extensions["throttle"]
    if not keys:
        return LOCAL
    given = request.headers.get("RhinoComputeKey", ""), request.headers.get("Authorization", "")
    if not any(given):
        return None
    address = request.remote_addr or ""
    pause = throttle.pause(address)
    if pause > 0:
        raise TooManyKeys(pause)
    found = keys.find(*given)
    if found is None:
        throttle.add(address)
        log.warning("a wrong key came from %s for %s %s", address, request.method, request.path)
    return found


def _is_link_to_page() -> bool:
    visits = request.headers.get("Sec-Fetch-Mode") == "navigate" and request.headers.get("Sec-Fetch-Dest") == "document"
    return visits and request.method == "GET" and request.path == "/"


def _is_open() -> bool:
    """Check whether the address needs no key: a link, and descriptions, health and version, which Hops requests without a key."""
    open_path = request.path.startswith(SHARED_PATH) or not request.path.startswith("/api/")
    return request.method in ("GET", "HEAD", "OPTIONS") and open_path


def caller() -> Key:
    """Return the key of the request, that of the local owner on a server without keys."""
    return g.get("caller") or LOCAL


def owner() -> str:
    """Return the name of the owner whose jobs the request may see: its own, or the one that an operator names.

    Raises
    ------
    Forbidden
        If the request names an owner without the key of an operator.
    """
    own, named = caller(), request.headers.get(OWNER_HEADER)
    if named is None:
        return own.name
    if own.role != OPERATOR or not (named == "" or NAME.fullmatch(named)):
        raise Forbidden(f"only an operator may send the header {OWNER_HEADER}")
    g.acting_for = named
    return named


def client_name() -> str:
    """Return the client to which limits apply: the owner, or the address if there is only one owner."""
    return f"key:{caller().name}" if caller().name else request.remote_addr or ""


def hostname(host: str) -> str:
    """Return the name in a Host header, in lower case and without port; empty if there is none."""
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return ""
