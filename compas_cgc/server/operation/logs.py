"""Logs of a server: lines of text or JSON with UTC times and the id of the request."""

from __future__ import annotations

import json
import logging
import re
import secrets
import sys
import time
from datetime import datetime
from datetime import timezone
from typing import Optional

from flask import Response
from flask import g
from flask import has_request_context
from flask import request

from ..security import caller
from ..security import client_name

__all__ = ["FORMATS", "JSONLines", "begin_request", "log_request", "log_to_stderr", "request_id"]

FORMATS = ("text", "json")
HEADER = "X-Request-ID"
_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
requests = logging.getLogger("compas_cgc.server.requests")


class JSONLines(logging.Formatter):
    """Format each record as one line of JSON; fields given as ``extra={"fields": {...}}`` are added."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line."""
        line = {
            "time": _time(record.created),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **getattr(record, "fields", {}),
        }
        if has_request_context():
            line["request"] = request_id()
        if record.exc_info:
            line["trace"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False, default=str)


class _Lines(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        own = f" [{request_id()}]" if has_request_context() else ""
        # Clients choose paths and names: no control characters, one line for each record except for the trace.
        text = "".join(sign if sign.isprintable() else " " for sign in record.getMessage())
        trace = "\n" + self.formatException(record.exc_info) if record.exc_info else ""
        return f"{_time(record.created)} {record.levelname.lower()}{own} {text}{trace}"


def log_to_stderr(form: Optional[str]) -> None:
    """Send the logs of this process to standard error.

    Parameters
    ----------
    form
        ``"text"`` or ``"json"``: with all requests and jobs. None: warnings only, as text.
    """
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JSONLines() if form == "json" else _Lines())
    logging.getLogger().addHandler(handler)
    logging.getLogger("compas_cgc").setLevel(logging.INFO if form else logging.WARNING)


def request_id() -> str:
    """Return the id of the request: that of the header X-Request-ID if it is valid, or a random one."""
    if "request_id" not in g:
        given = request.headers.get(HEADER, "")
        g.request_id = given if _ID.fullmatch(given) else secrets.token_hex(8)
    return g.request_id


def begin_request() -> None:
    """Note the start of a request."""
    g.started = time.perf_counter()


def log_request(response: Response) -> float:
    """Log a request, add its id to the response, and return its duration [s]."""
    response.headers[HEADER] = request_id()
    seconds = time.perf_counter() - g.get("started", time.perf_counter())
    # Tokens of links are secrets.
    path = request.url_rule.rule if request.url_rule is not None and "token" in (request.view_args or {}) else request.path
    fields = {
        "request": request_id(),
        "client": client_name(),
        "owner": g.get("acting_for", caller().name),
        "method": request.method,
        "path": path,
        "status": response.status_code,
        "seconds": round(seconds, 4),
        "bytes_in": request.content_length or 0,
        "bytes_out": response.content_length,
    }
    who = f"{client_name()} for {g.acting_for}" if "acting_for" in g else client_name()
    requests.info("%s %s %s: %d", who, request.method, path, response.status_code, extra={"fields": fields})
    return seconds


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, timezone.utc).isoformat(timespec="milliseconds").replace("+00:00", "Z")
