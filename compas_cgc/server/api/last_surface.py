"""Last surface of the same drawing: an initial guess for other targets, sent by the client because the server is stateless."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...model.problem import CGCProblem
from ...model.problem import Origin
from ...model.problem import Targets
from ..errors import Unprocessable
from ..limits import Limits
from .decoding import vertex_array
from .options import check_targets
from .options import read_targets

__all__ = ["LastSurface", "check_last", "gone_on", "read_last"]


class LastSurface(NamedTuple):
    """Surface of an earlier solve, and its targets."""

    vertices: FloatArray  # (n, 3) [L]
    targets: Targets  # [1/L^2]


def check_last(value: object, count: Optional[int], limits: Limits) -> None:
    """Check the last surface in a request for a mesh of `count` vertices (None: not known yet).

    Raises
    ------
    Unprocessable
        If the last surface is malformed or does not match the mesh.
    """
    if value is None:
        return
    if count is None:
        raise Unprocessable("'last' requires 'vertices' and 'faces'; send the mesh as these, or leave 'last' out")
    if not isinstance(value, Mapping) or set(value) != {"vertices", "targets"}:
        raise Unprocessable("'last' must be an object with the 'vertices' of the last surface and its 'targets'")
    try:
        vertices = vertex_array(value["vertices"], limits)
        if len(vertices) != count:
            raise Unprocessable(f"the surface has {len(vertices)} vertices, but the mesh has {count}; send a surface of the same mesh")
        if value["targets"] is None:
            raise Unprocessable("'targets' is null; send the targets of the last surface")
        check_targets(value["targets"], count)
    except Unprocessable as error:
        raise Unprocessable(f"last: {error}") from None


def read_last(value: Optional[Mapping], limits: Limits) -> Optional[LastSurface]:
    """Return the last surface of a checked request, None if the request has none."""
    return None if value is None else LastSurface(vertex_array(value["vertices"], limits), read_targets(value["targets"]))


def gone_on(problem: CGCProblem, last: Optional[LastSurface]) -> CGCProblem:
    """Return a problem with the last surface as its initial guess; the unchanged problem if there is none."""
    if last is None:
        return problem
    before = replace(problem, targets=np.full(len(problem.vertices), np.nan)).with_targets(last.targets)
    return replace(problem, vertices=last.vertices, origin=Origin(before, last.vertices))
