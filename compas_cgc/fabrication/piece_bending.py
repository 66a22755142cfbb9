"""Radii to which the pieces of a pattern are bent in position, and the sides to which they bend."""

from __future__ import annotations

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from .bending import corner_operators
from .figures import on_most_of_the_area
from .patterns import Patterns
from .shape_operators import principal_curvatures

__all__ = ["pieces_in_position"]


def pieces_in_position(patterns: Patterns) -> list[tuple[float, str]]:
    """Return the least bending radius [L] of every piece, and the sides to which it bends.

    Unrolled pieces bend across their rulings. Pieces that were flattened have the larger principal curvature of the surface, on 95 % of
    their area. A piece bends ``away`` from a viewer who sees it from outside, ``towards`` that viewer, or ``away towards``, in the two
    principal directions or in different parts of it. A piece without rulings has an infinite radius and no side.
    """
    unrolled = {own.region for own in patterns.unrollings if own.unrolled}
    flattened = any(piece.region not in unrolled for piece in patterns.pieces)
    curvatures = _principal(patterns) if flattened else np.empty((0, 2))
    found = []
    for number, piece in enumerate(patterns.pieces):
        if piece.region in unrolled:
            bends = np.array([ruling.bending for ruling in patterns.rulings if ruling.piece == number and ruling.bending])
            most = float(np.abs(bends).max(initial=0.0))
        else:
            own = patterns.patchwork.piece == number
            bends = curvatures[patterns.patchwork.parent[own]]
            areas = face_areas(patterns.patchwork.space, patterns.patchwork.faces[own])
            most = on_most_of_the_area(np.abs(bends).max(axis=1), areas)
            bends = bends.mean(axis=0)
        sides = [side for side, there in (("away", (bends > 0.0).any()), ("towards", (bends < 0.0).any())) if there]
        found.append((1.0 / most if most else np.inf, " ".join(sides)))
    return found


def _principal(patterns: Patterns) -> FloatArray:
    """Return the principal curvatures of the surface on every mesh face (m, 2) [1/L]."""
    problem = patterns.problem
    mean = corner_operators(problem).mean(axis=1)
    own = principal_curvatures(mean, face_normals(problem.vertices, problem.faces))
    return np.column_stack([own.larger, own.smaller])
