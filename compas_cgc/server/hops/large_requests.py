"""Large requests: parsed by the worker that answers them, as the server itself would keep everybody waiting."""

from __future__ import annotations

import json
from typing import NamedTuple
from typing import Optional

from ..errors import TooLarge
from ..limits import Limits
from .data_tree import read_values
from .endpoints import REPEATABLE
from .endpoints import endpoint
from .functions import run_function
from .protocol import context_of
from .protocol import read_body
from .protocol import uri_of
from .reply import Reply

__all__ = ["Answered", "job_body", "run_request_body"]


class Answered(NamedTuple):
    """What a worker makes of a request."""

    uri: str
    reply: Optional[Reply]  # None where a job is to be submitted
    job: Optional[bytes]  # the request of that job
    kept: bool  # the client wants the answer kept for the next time


def run_request_body(content: bytes, limits: Limits) -> Answered:
    """Parse a request and run the function that it names.

    Raises
    ------
    RequestError
        If it is none.
    """
    body = read_body(content, limits)
    uri, values, context = uri_of(body), body.get("values"), context_of(body)
    if uri == "cgc/fetch":
        raise TooLarge("cgc/fetch takes the id of a job, which is short")
    if uri == "cgc/submit":
        return Answered(uri, None, job_body(values, context), False)
    return Answered(uri, run_function(uri, values, context, limits), None, body.get("cachesolve") is True and uri in REPEATABLE)


def job_body(values: object, context: dict) -> bytes:
    """Return the inputs of ``cgc/submit``, checked, as the request of a job."""
    read_values(endpoint("cgc/submit"), values)
    return json.dumps({"values": values, "context": context}).encode()
