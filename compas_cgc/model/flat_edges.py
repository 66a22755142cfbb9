"""Check of regions with K < 0 whose edge is held in a plane."""

from __future__ import annotations

import numpy as np

from ..errors import Remedy
from ..errors import Sentence
from ..meshing import boundary_loops
from ..meshing.existence import plane_of
from .problem import CGCProblem
from .roles import FIXED
from .tolerances import NEGLIGIBLE

__all__ = ["saddle_in_flat_edge"]


def saddle_in_flat_edge(problem: CGCProblem) -> list[Sentence]:
    """Return a sentence if K < 0 everywhere and the whole edge is held in a plane, which no surface satisfies.

    A surface with K < 0 has no tangent plane on one side of which it lies, so that it stays within the convex hull of its edge.
    """
    types = problem.types[problem.asked]
    loops = boundary_loops(problem.faces)
    if not len(types) or not (types < 0).all() or len(problem.creases) or not loops:
        return []
    edge = np.concatenate(loops)
    if not (problem.roles[edge] == FIXED).all() or plane_of(problem.vertices[edge])[1] > NEGLIGIBLE:
        return []
    text = (
        "no surface has K < 0 within this edge, because the whole edge is supported in a plane, and a surface with K < 0 lies within the "
        "convex hull of its edge; free a part of the edge, lift a part of it, or use K > 0"
    )
    return [Sentence(text, [Remedy("scale", -1.0)])]
