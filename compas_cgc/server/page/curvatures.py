"""Curvatures of a surface that the page shows before and during a solve, and those of fitted quadrics."""

from __future__ import annotations

import json

from ...analysis import quadric_curvatures
from ...model.measures import measured_curvature
from ..api.decoding import packed
from ..api.requests import READERS
from ..api.wording import in_request_words
from ..errors import Unprocessable
from ..limits import Limits

__all__ = ["curvatures"]


def curvatures(body: bytes, limits: Limits) -> bytes:
    """Return the curvatures of the surface in a request for a solve, as JSON with packed arrays (n,), NaN where no K is prescribed.

    Parameters
    ----------
    body
        The checked request, whose vertices are on the surface.
    limits
        Limits of the server.

    Raises
    ------
    Unprocessable
        If the request is not a valid problem.
    """
    try:
        problem = READERS["json"]({}, body, limits).problem
        fits = quadric_curvatures(problem.vertices, problem.faces, problem.asked, problem.asked)
        found = {"curvature": measured_curvature(problem), **fits._asdict()}
    except ValueError as error:
        raise Unprocessable(in_request_words(error)) from None
    return json.dumps({name: packed(values) for name, values in found.items()}).encode()
