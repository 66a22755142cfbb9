"""Harmonic morphing: a crease or some supports of a drawing moved, and the rest of its mesh drawn along.

Displacements are linear along the lines of the drawing, between vertices that move and those that stay, and harmonic between
the lines (Laplace's equation with the weights of edges, one over their length), so that the mesh keeps its faces.
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
from ..meshing.closest_points import nearest_on_polyline
from ..meshing.polyline import arc_lengths
from ..model.problem import CGCProblem

__all__ = ["moved_along", "straight_on"]

STRAIGHT = 0.87  # cosine between two creases in turn, 30 degrees, from which they are one line
TURNED = 0.1  # cosine between the normals of a face before and after, below which the mesh is too much distorted


def moved_along(problem: CGCProblem, moving: Indices, direction: FloatArray, on_edge: bool) -> Callable[[float], CGCProblem]:
    """Return the function that moves vertices by a distance along a direction and draws the mesh along.

    Parameters
    ----------
    problem
        The drawing.
    moving
        ``(k,)`` vertices that are moved, by their positions.
    direction
        ``(3,)`` of which the length counts too: a distance of 1 moves by it [L].
    on_edge
        What of the moving vertices lies on an open edge stays on the line that the edge is drawn along, as the ends of a crease do.

    Raises
    ------
    CGCError
        If there is nothing to move; the function raises it where faces would turn over.
    """
    if not len(moving):
        raise CGCError("there is nothing to move; name a crease of the drawing, or vertices")
    loops = boundary_loops(problem.faces)
    weights = _influence(problem, moving, loops)
    V, before = problem.vertices, face_normals(problem.vertices, problem.faces)
    sliding = [loop for loop in loops if on_edge and np.isin(loop, moving).any()]

    def moved(distance: float) -> CGCProblem:
        places = V + distance * weights[:, None] * direction
        # Where the ends of a crease go along an edge, the rest of that edge slides on its own line too.
        for loop in sliding:
            places[loop] = np.where((weights[loop] != 0.0)[:, None], nearest_on_polyline(places[loop], V[loop], closed=True)[0], V[loop])
        after = face_normals(places, problem.faces)
        flipped = np.einsum("ij,ij->i", before, after) < TURNED
        if flipped.any():
            raise CGCError(f"moved by {distance:g}, {int(flipped.sum())} faces of the drawing turn over; move it less far")
        return problem.with_vertices(places)

    return moved


def straight_on(problem: CGCProblem, number: int) -> Indices:
    """Return the vertices of a crease and of those that go straight on from it where creases cross: a line as it was drawn (k,).

    Raises
    ------
    CGCError
        If there is no such crease.
    """
    paths = problem.crease_paths()
    if not 0 <= number < len(paths):
        raise CGCError(f"there is no crease {number}; the drawing has {len(paths)}, from 0 on")
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
    """Return the part of the move that every vertex makes (n,): 1 for those that are moved, 0 for those that stay."""
    n = len(problem.vertices)
    part = np.full(n, np.nan)
    paths = [np.array(path, dtype=np.int64) for path in problem.crease_paths()]
    for path in paths:
        # Where creases end or cross they stay; closed ones stay as a whole.
        part[path if path[0] == path[-1] else path[[0, -1]]] = 0.0
    on_loops = np.concatenate(loops) if loops else np.empty(0, np.int64)
    supports = problem.supports
    if len(np.setdiff1d(on_loops, supports)):
        # Supports that stand apart stay; along an edge that is held as a whole they may slide.
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
    """Return the parts (b,) along a closed line (b, 3), linear between those that are known."""
    known = np.flatnonzero(np.isfinite(part))
    if not len(known) or not part[known].any():
        return np.where(np.isfinite(part), part, 0.0)
    at = arc_lengths(np.vstack([points, points[:1]]))
    total = at[-1]
    if part[known].all():
        # Nothing of this line stays: the place farthest from what moves does.
        away = np.abs(at[:-1, None] - at[known])
        far = int(np.argmax(np.minimum(away, total - away).min(axis=1)))
        part = part.copy()
        part[far], known = 0.0, np.sort(np.append(known, far))
    return np.interp(at[:-1], at[known], part[known], period=total)
