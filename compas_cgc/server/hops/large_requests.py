"""Large requests, which are parsed in the worker so that they do not block the server."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

from ..limits import Limits
from .data_tree import passed_over
from .data_tree import read_values
from .endpoints import REPEATABLE
from .endpoints import endpoint
from .functions import run_function
from .protocol import context_of
from .protocol import read_body
from .protocol import uri_of
from .reply import Reply

__all__ = ["Answered", "job_asked_for", "job_body", "run_request_body"]


class Answered(NamedTuple):
    """Result of a large request in the worker."""

    uri: str
    reply: Optional[Reply] = None  # reply of the function, if one was run
    kept: bool = False  # whether to cache the response
    job: Optional[bytes] = None  # request of a job to submit
    id: str = ""  # id of a job to fetch
    warnings: Sequence[str] = ()  # warnings on the inputs


def run_request_body(content: bytes, limits: Limits) -> Answered:
    """Parse a request and run the function that it names.

    Raises
    ------
    RequestError
        If the request is malformed.
    """
    body = read_body(content, limits)
    uri, values, context = uri_of(body), body.get("values"), context_of(body)
    if uri == "cgc/submit":
        return Answered(uri, job=job_body(values, context), warnings=passed_over(endpoint(uri), values))
    if uri == "cgc/fetch":
        return Answered(uri, id=job_asked_for(values), warnings=passed_over(endpoint(uri), values))
    return Answered(uri, run_function(uri, values, context, limits), body.get("cachesolve") is True and uri in REPEATABLE)


def job_asked_for(values: object) -> str:
    """Return the job id in the values of ``cgc/fetch``."""
    return str(read_values(endpoint("cgc/fetch"), values)["Job"])


def job_body(values: object, context: dict) -> bytes:
    """Return the checked inputs of ``cgc/submit`` as the request of a job."""
    read_values(endpoint("cgc/submit"), values)
    return json.dumps({"values": values, "context": context}).encode()
