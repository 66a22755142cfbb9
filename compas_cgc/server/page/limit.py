"""What supports can carry, for the marks on the sliders of the page."""

from __future__ import annotations

import json

from ...errors import CGCError
from ...solvers.limits import largest_target
from ..api.requests import READERS
from ..api.wording import in_request_words
from ..errors import Unprocessable
from ..limits import Limits

__all__ = ["limit_of"]

SOLVES = 16  # the mark on a slider is a few pixels wide
TOLERANCE = 0.05
VERTICES = 500


def limit_of(content: bytes, limits: Limits) -> bytes:
    """Return the largest targets of an accepted request, all in the ratio asked for, as JSON.

    Raises
    ------
    Unprocessable
        Where there is nothing to look for, such as without targets.
    """
    try:
        problem = READERS["json"]({}, content, limits).problem
        found = largest_target(problem, tolerance=TOLERANCE, solves=SOLVES, vertices=VERTICES)
    except (CGCError, ValueError) as error:
        raise Unprocessable(in_request_words(error)) from None
    return json.dumps({name: value for name, value in found.to_dict().items() if name != "verdict"}, allow_nan=False).encode("utf-8")
