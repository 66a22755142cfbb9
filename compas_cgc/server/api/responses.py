"""Responses in JSON."""

from __future__ import annotations

import json
from typing import Optional

from flask import Response

__all__ = ["respond"]


def respond(body: object, status: int = 200, headers: Optional[dict] = None) -> Response:
    """Return a JSON response; NaN or infinity in the body raises an error."""
    return Response(json.dumps(body, ensure_ascii=False, allow_nan=False), status, headers, mimetype="application/json")
