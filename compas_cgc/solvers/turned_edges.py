"""A second chance on stretched triangles and stars of three faces: the same vertices with their edges turned."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Callable
from typing import Optional

import numpy as np

from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..linalg.work import Work
from ..linalg.work import rights
from ..meshing.delaunay_flips import delaunay_turned
from ..meshing.delaunay_flips import obtuse_share
from ..meshing.delaunay_flips import turnable
from ..meshing.edge_flips import Diagonals
from ..meshing.edge_flips import flipped_to_valence
from ..model.checks import three_faced
from ..model.problem import CGCProblem
from ..model.result import Solution
from ..model.verdict import verdict

__all__ = ["on_turned_edges"]

STRETCHED, LESS = 0.1, 0.5  # part of the triangles that are obtuse from which a mesh is stretched, and how many of these may be left
FEWEST = 4  # edges of a vertex where K < 0
FIRST = 3500  # right sides that the first search may take: what has not arrived by then has waves in it already


def on_turned_edges(
    problem: CGCProblem,
    solve: Callable[[CGCProblem], Solution],
    smoothed: Callable[[CGCProblem, FloatArray, Callable[[CGCProblem], Solution]], Optional[Solution]],
) -> Optional[Solution]:
    """Return the solution with edges turned as the drawing asks, its faces with it.

    Where K < 0 angle defects of stretched triangles are off by many times the K of the surface through their vertices, so that
    a mesh of a smooth surface does not meet them, and what meets them is rough. Around a vertex of three faces nothing meets them.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    solve
        Solves a problem.
    smoothed
        Solves it from a surface (n, 3) with its waves taken out, None where that is not worth it.

    Returns
    -------
    Solution or None
        None where the mesh is none of both, or turned edges leave it so, or there is more to hold than vertices and creases.
    """
    if problem.goals or not problem.real_faces.all():
        return None
    faces, why = _less_stretched(problem), "theirs are too stretched for K < 0"
    if faces is None:
        faces, why = _of_more_faces(problem), "three around a vertex leave no room for K < 0"
    if faces is None:
        return None
    turned = replace(problem, faces=faces)
    with Work(rights(FIRST, 3 * len(problem.vertices))).counted():
        solution = solve(turned)
    if solution.faces is not None:
        return solution
    if solution.status in ("converged", "stalled") and _roughness(turned, solution) > 1.0:
        # The first search may have put in waves, which none of its steps takes out again.
        other = smoothed(turned, solution.vertices, solve)
        solution = other if other is not None and _roughness(turned, other) <= 1.0 else solution
    count = int(np.count_nonzero((faces != problem.faces).any(axis=1)))
    were = "1 face was" if count == 1 else f"{count} faces were"
    return solution._replace(faces=faces, message=f"{were} turned, as {why}; {solution.message}")


def _less_stretched(problem: CGCProblem) -> Optional[Faces]:
    """Return the faces with edges turned, None where that is not called for, or of no help."""
    share = obtuse_share(problem.vertices, problem.faces)
    if share < STRETCHED:
        return None
    faces = delaunay_turned(problem.vertices, problem.faces, problem.creases)
    return faces if obtuse_share(problem.vertices, faces) <= LESS * share else None


def _of_more_faces(problem: CGCProblem) -> Optional[Faces]:
    """Return the faces with an edge turned to every vertex of three where K < 0, None where there is none, or no edge to turn."""
    lost = three_faced(problem.faces, np.flatnonzero(problem.asked & (problem.targets < 0.0)))
    if not len(lost):
        return None
    n = len(problem.vertices)
    kept = np.sort(problem.creases, axis=1) @ np.array([n, 1])

    def allowed(triangles: Faces, edges: Diagonals) -> Mask:
        still = three_faced(triangles, lost)
        opposite = np.isin(edges.c, still) | np.isin(edges.d, still)
        return opposite & turnable(problem.vertices, triangles, edges)

    faces = flipped_to_valence(n, problem.faces, kept, allowed, FEWEST)
    return None if len(three_faced(faces, lost)) else faces


def _roughness(problem: CGCProblem, solution: Solution) -> float:
    """Return that of the verdict, infinite where the equations are not met."""
    if solution.status != "converged":
        return math.inf
    return verdict(problem.with_vertices(solution.vertices), problem.vertices).roughness
