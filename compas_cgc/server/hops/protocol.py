"""Protocol of Hops: function, values and units of a request from any client."""

from __future__ import annotations

import base64
import binascii
from typing import Any
from urllib.parse import urlsplit

from ..api.decoding import read_json
from ..errors import BadRequest
from ..errors import NotFound
from ..limits import Limits
from .endpoints import endpoints

__all__ = ["context_of", "known", "read_body", "uri_of"]


def read_body(content: bytes, limits: Limits) -> dict:
    """Return the request; one enclosing list is allowed.

    Raises
    ------
    BadRequest
        If the request is not a JSON object.
    """
    value = read_json(content, limits)
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if not isinstance(value, dict):
        raise BadRequest("the request must be a JSON object with 'pointer' and 'values'")
    return value


def uri_of(body: dict) -> str:
    """Return the path of the requested function; an address in the request is parsed, never opened.

    Raises
    ------
    NotFound
        If the function does not exist; the message lists all functions.
    """
    pointer, algo = body.get("pointer"), body.get("algo")
    if pointer is None and isinstance(algo, str):
        try:
            pointer = base64.b64decode(algo[:400], validate=True).decode()
        except (binascii.Error, ValueError):
            pointer = None
    if not isinstance(pointer, str) or not pointer:
        raise NotFound(f"the request does not name a function; the functions are {', '.join(endpoints())}")
    # The path may begin with the prefix under which a proxy publishes the server.
    return known("/".join(_path(pointer).strip("/").split("/")[-2:]))


def known(path: str) -> str:
    """Return the function at a path.

    Raises
    ------
    NotFound
        If the function does not exist; the message lists all functions.
    """
    uri = path.strip("/").lower()
    if uri not in endpoints():
        raise NotFound(f"there is no function {uri[:60]!r}; the functions are {', '.join(endpoints())}")
    return uri


def context_of(body: dict) -> dict:
    """Return units and tolerance [L] of the document, ``""`` and 0 if unknown."""
    units: Any = body.get("modelunits")
    tolerance: Any = body.get("absolutetolerance")
    known = isinstance(tolerance, (int, float)) and not isinstance(tolerance, bool) and 0 < tolerance < 1e12
    return {
        "modelunits": units[:40] if isinstance(units, str) and units.isascii() else "",
        "absolutetolerance": float(tolerance) if known else 0.0,
    }


def _path(pointer: str) -> str:
    try:
        return urlsplit(pointer).path if "://" in pointer else pointer.split("?")[0]
    except ValueError:
        return ""
