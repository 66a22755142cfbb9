"""Harmonic morphing: moves a crease or supports of a drawing, and deforms the mesh accordingly.

Displacements are linear along the lines of the drawing, between moved and fixed vertices, and harmonic between the lines (Laplace's
equation with inverse edge lengths as weights), so that the faces of the mesh remain.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import Vectors
from ..discrete.harmonic import spread_values
from ..errors import CGCError
from ..meshing import boundary_loops
from ..meshing import named_supports
from ..meshing.closest_points import feet_on_polyline
from ..meshing.polyline import arc_lengths
from ..model.problem import CGCProblem

__all__ = ["moved_along", "straight_on"]

STRAIGHT = 0.87  # cosine (30 degrees) above which consecutive creases form one line
MIN_COSINE = 0.1  # cosine between the normals of a face before and after, below which the distortion is too large


def moved_along(problem: CGCProblem, moving: Indices, direction: FloatArray, on_edge: bool) -> Callable[[float], CGCProblem]:
    """Return a function that moves vertices by a distance along a direction and deforms the mesh.

    Parameters
    ----------
    problem
        The drawing.
    moving
        ``(k,)`` indices of the moved vertices.
    direction
        ``(3,)`` displacement for a distance of 1 [L].
    on_edge
        Whether moved vertices on an open edge slide along that edge, as for the ends of a crease.

    Raises
    ------
    CGCError
        If there are no vertices to move. The returned function raises it if faces would flip.
    """
    if not len(moving):
        raise CGCError("there are no vertices to move; give a crease of the drawing, or vertices")
    loops = boundary_loops(problem.faces)
    weights = _influence(problem, moving, loops)
    V, before = problem.vertices, face_normals(problem.vertices, problem.faces)
    sliding = [loop for loop in loops if on_edge and np.isin(loop, moving).any()]

    def moved(distance: float) -> CGCProblem:
        places = V + distance * weights[:, None] * direction
        # If the ends of a crease slide along an edge, the other vertices of that edge also slide on it.
        for loop in sliding:
            places[loop] = np.where((weights[loop] != 0.0)[:, None], feet_on_polyline(places[loop], V[loop], closed=True)[0], V[loop])
        after = face_normals(places, problem.faces)
        flipped = np.einsum("ij,ij->i", before, after) < MIN_COSINE
        if flipped.any():
            raise CGCError(f"moving by {distance:.3g} flips {int(flipped.sum())} faces of the drawing; reduce the distance")
        return problem.with_vertices(places)

    return moved


def straight_on(problem: CGCProblem, number: int) -> Indices:
    """Return the vertices (k,) of a crease and its straight continuations beyond crossings: one line of the drawing.

    Raises
    ------
    CGCError
        If the crease does not exist.
    """
    paths = problem.crease_paths()
    if not 0 <= number < len(paths):
        raise CGCError(f"there is no crease {number}; the drawing has {len(paths)} creases, counted from 0")
    line, left = list(paths[number]), [path for k, path in enumerate(paths) if k != number]
    for _ in range(2):
        while True:
            further = [own for path in left for own in (path, path[::-1]) if own[0] == line[-1]]
            along = [_cosine(problem.vertices, line[-2:], own[:2]) for own in further]
            if not further or max(along) < STRAIGHT:
                break
            best = further[int(np.argmax(along))]
            left = [path for path in left if path not in (best, best[::-1])]
            line += best[1:]
        line.reverse()
    return np.unique(line).astype(np.int64)


def _cosine(V: Vectors, one: list[int], other: list[int]) -> float:
    a, b = V[one[1]] - V[one[0]], V[other[1]] - V[other[0]]
    return float(a @ b / max(np.linalg.norm(a) * np.linalg.norm(b), np.finfo(float).tiny))


def _influence(problem: CGCProblem, moving: Indices, loops: list[Indices]) -> FloatArray:
    """Return the relative displacement of every vertex (n,): 1 for moved vertices, 0 for fixed ones."""
    n = len(problem.vertices)
    part = np.full(n, np.nan)
    paths = [np.array(path, dtype=np.int64) for path in problem.crease_paths()]
    for path in paths:
        # Ends and crossings of other creases are fixed; closed creases are fixed as a whole.
        part[path if path[0] == path[-1] else path[[0, -1]]] = 0.0
    on_loops = np.concatenate(loops) if loops else np.empty(0, np.int64)
    supports = problem.supports
    if len(np.setdiff1d(on_loops, supports)):
        # Isolated supports are fixed; supports along a fully supported edge may slide.
        part[supports] = 0.0
    else:
        part[np.setdiff1d(supports, on_loops)] = 0.0
    if loops:
        part[named_supports(problem.vertices, problem.faces, "corners")] = 0.0
    part[moving] = 1.0
    for path in paths:
        known = np.isfinite(part[path])
        at = arc_lengths(problem.vertices[path])
        part[path] = np.interp(at, at[known], part[path][known])
    for loop in loops:
        part[loop] = _around(problem.vertices[loop], part[loop])
    return spread_values(problem.vertices, problem.faces, part, np.isfinite(part))


def _around(points: Vectors, part: FloatArray) -> FloatArray:
    """Return the relative displacements (b,) along a closed line (b, 3), linear between known values."""
    known = np.flatnonzero(np.isfinite(part))
    if not len(known) or not part[known].any():
        return np.where(np.isfinite(part), part, 0.0)
    at = arc_lengths(np.vstack([points, points[:1]]))
    total = at[-1]
    if part[known].all():
        # No vertex of this line is fixed: fix the one farthest from the moved vertices.
        away = np.abs(at[:-1, None] - at[known])
        far = int(np.argmax(np.minimum(away, total - away).min(axis=1)))
        part = part.copy()
        part[far], known = 0.0, np.sort(np.append(known, far))
    return np.interp(at[:-1], at[known], part[known], period=total)
