"""The triangles of a drawing laid out evenly over a surface that is far from it."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..discrete.corners import corner_angles
from ..discrete.laplacian import cotangent_laplacian
from ..linalg import SingularMatrixError
from ..linalg import factorise
from ..meshing.carry_over import CarryOver
from ..model.goals.wholes import is_of_whole
from ..model.problem import CGCProblem
from ..model.roles import DUMMY
from ..model.roles import FIXED
from .coarse import plan_of

__all__ = ["evened", "pulled_taut", "taut"]

GAIN = 2.0  # factor by which the smallest angle must grow for a new layout; a smaller gain is not worth the moves of all vertices


def evened(problem: CGCProblem, surface: FloatArray) -> Optional[FloatArray]:
    """Return the vertices (n, 3) at harmonic places on a surface (n, 3), with supports, creases and boundary where they are there.

    A harmonic map of the drawing keeps the shapes of its triangles where it can: that of a half sphere to a disk is conformal.

    Parameters
    ----------
    problem
        With the vertices of the drawing.
    surface
        ``(n, 3)`` vertices of a surface with the same faces, whose triangles are stretched [L].

    Returns
    -------
    ndarray or None
        None where the surface has no plan, goals name places of it, or triangles would not gain.

    References
    ----------
    Pinkall and Polthier, doi:10.1080/10586458.1993.10504266.
    """
    seen = plan_of(surface, problem.faces)
    if seen is None or problem.goals or (problem.roles == DUMMY).any():
        return None
    plan, _ = seen
    held = boundary_vertices(surface, problem.faces) | (problem.roles == FIXED)
    held[problem.creases] = True
    places = _harmonic(problem, plan, held)
    result = surface.copy()
    labels = problem.regions()
    for region in np.unique(labels):
        here = np.unique(problem.faces[labels == region])
        inner = here[~held[here]]
        result[inner] += CarryOver(plan[here], places[inner])(surface[here]) - surface[inner]
    if plan_of(result, problem.faces) is None:
        return None
    before, after = (float(corner_angles(V, problem.faces).min()) for V in (surface, result))
    return result if after > GAIN * before else None


def pulled_taut(problem: CGCProblem) -> Optional[FloatArray]:
    """Return the drawing (n, 3) pulled taut over its boundary, None where goals name places of it, or triangles would not gain.

    Where a drawing is steep, its triangles are needles in plan, or overlap there, although they are even in space.
    """
    if not all(is_of_whole(goal) for goal in problem.goals) or (problem.roles == DUMMY).any():
        return None
    try:
        result = taut(problem)
    except SingularMatrixError:  # All faces around a vertex have no area.
        return None
    normal = face_areas(problem.vertices, problem.faces) @ face_normals(problem.vertices, problem.faces)
    along = np.linalg.svd(normal[None])[2][1:]
    before, after = (float(corner_angles(V, problem.faces).min()) for V in (problem.vertices @ along.T @ along, result))
    return result if after > GAIN * before else None


def taut(problem: CGCProblem) -> FloatArray:
    """Return the drawing (n, 3) with vertices other than supports and boundary at the mean of those around them, weighted as drawn."""
    return _harmonic(problem, problem.vertices, (problem.roles == FIXED) | boundary_vertices(problem.vertices, problem.faces))


def _harmonic(problem: CGCProblem, places: FloatArray, held: Mask) -> FloatArray:
    """Return places (n, k) that are harmonic on the drawing but for those that are held (n,)."""
    stiffness = cotangent_laplacian(problem.vertices, problem.faces)[~held]
    result = places.copy()
    result[~held] = factorise(stiffness[:, ~held].tocsr(), symmetric=True).solve(-(stiffness[:, held] @ places[held]))
    return result
