"""Columns that push or pull a surface of K > 0 out of its way: which, and what heights they may have."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial import cKDTree

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.plan import flattened
from ..linalg.work import is_spent
from ..meshing import named_supports
from ..model.constraints import OnLine
from ..model.problem import CGCProblem
from ..model.roles import FIXED
from ..model.verdict import Verdict
from .one_sided import one_sided

__all__ = ["Attempt", "column_advice"]

FREED = 3  # most columns that are taken away, one after the other
HALVINGS = 2  # of the way from the height that the surface has to that of a column
FEWEST = 3  # supports that a roof keeps
SLACK = 0.2  # share of a corner by which a place may lie beside a face: a free edge moves in plan
FAR = 0.5  # of a column from where it would have to be, against the size of the mesh, from where that is no advice
UPRIGHT = 0.1  # part of the area that is seen from above, up to which a mesh has no plan, and no columns in it
SAME = 5e-3  # difference of heights, against the size of the mesh, that is none


class Attempt(NamedTuple):
    """A surface that was found, and how fair it is."""

    vertices: FloatArray  # (n, 3) [L]
    judged: Verdict


Solve = Callable[[CGCProblem], Optional[Attempt]]


def column_advice(problem: CGCProblem, rough: Attempt, solve: Solve) -> str:
    """Return a sentence that names columns without which a surface is fair, and the heights that they may have; empty without any.

    Columns that keep a function over the plan from bulging to one side are taken away, or else the column nearest to what is rough,
    then the next, until the surface is fair. Where it runs then is a height that columns may have; from there a single one is moved
    towards where it stands as long as the surface stays fair.

    Parameters
    ----------
    problem
        A problem whose surface is rough.
    rough
        That surface.
    solve
        Returns the fairest surface of a problem, None where none is found.
    """
    columns = _columns(problem)
    if not columns:
        return ""
    size = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    taken_away = _without_those_in_the_way(problem, columns, solve) or _without_the_nearest(problem, columns, rough, solve)
    if taken_away is None:
        return ""
    freed, last = taken_away
    heights = _heights(problem, freed, last)
    if any(height is None for height in heights):
        # A free edge has gone away from under the column: where the column is to stand it is to pass, however high.
        over = solve(_without(_raised(problem, last.vertices[:, 2]), freed, over=True))
        if over is None or not over.judged.fair:
            return ""
        heights = _heights(problem, freed, over)
    off = [np.nan if height is None else float(problem.vertices[column, 2]) - height for column, height in zip(freed, heights)]
    if not np.isfinite(off).all() or not SAME * size < np.abs(off).max() <= FAR * size:
        return ""
    said = "; ".join(_said(problem, column, lift, float(height or 0.0)) for column, lift, height in zip(freed, off, heights))
    if len(freed) > 1:
        return f"without {len(freed)} of its columns the surface is fair; {said}; give them these heights, or lead a crease through them"
    height = float(heights[0] or 0.0)
    low, high = sorted((height, _farthest(problem, freed[0], height, off[0], solve)))
    to = f"heights from {low:.4g} to {high:.4g} were found fair" if high - low > SAME * size else "give it that height"
    return f"{said}; {to}, or lead a crease through it"


def _without_those_in_the_way(problem: CGCProblem, columns: Sequence[int], solve: Solve) -> Optional[tuple[list[int], Attempt]]:
    """Return the columns without which a function over the plan bulges to one side, and the surface near that, if it is fair."""
    bulging = one_sided(problem, columns, min(FREED, int((problem.roles == FIXED).sum()) - FEWEST))
    if bulging is None or not bulging.columns:
        return None
    found = solve(_without(_raised(problem, bulging.heights), bulging.columns))
    return (bulging.columns, found) if found is not None and found.judged.fair else None


def _without_the_nearest(problem: CGCProblem, columns: Sequence[int], rough: Attempt, solve: Solve) -> Optional[tuple[list[int], Attempt]]:
    """Return the columns nearest to what is rough, one after the other, without which the surface is fair, and that."""
    freed: list[int] = []
    last = rough
    while len(freed) < FREED:
        left = [column for column in columns if column not in freed]
        if not left or is_spent() or int((problem.roles == FIXED).sum()) - len(freed) <= FEWEST:
            return None
        freed.append(_blamed(last, problem.vertices, left))
        found = solve(_without(problem, freed))
        if found is None:
            return None
        last = found
        if found.judged.fair:
            return freed, found
    return None


def _raised(problem: CGCProblem, heights: FloatArray) -> CGCProblem:
    """Return the problem drawn with other heights (n,) over its plan."""
    return problem.with_vertices(np.column_stack([problem.vertices[:, :2], heights]))


def _heights(problem: CGCProblem, columns: Sequence[int], found: Attempt) -> list[Optional[float]]:
    return [_height(found.vertices, problem.faces, problem.vertices[column, :2]) for column in columns]


def _said(problem: CGCProblem, column: int, lift: float, height: float) -> str:
    x, y, _ = problem.vertices[column]
    K = float(np.max(problem.targets[np.isfinite(problem.targets)]))
    over = f"{abs(lift):.3g} {'over' if lift > 0 else 'under'}"
    name = f"the column at ({x:.4g}, {y:.4g}), vertex {problem.names.vertices[column]}"
    return f"{name}, stands {over} where a surface of K = {K:.3g} runs without it, at {height:.4g}"


def _columns(problem: CGCProblem) -> list[int]:
    """Return single supports within or along regions of K > 0, those at corners left out; none of a mesh that stands upright."""
    fixed = problem.roles == FIXED
    faces = problem.faces[problem.real_faces]
    if not _has_a_plan(problem.vertices, faces):
        return []
    edges = edge_faces(faces)[:, :2]
    beside = np.zeros(len(fixed), bool)
    positive = np.zeros(len(fixed), bool)
    above = problem.asked & (problem.targets > 0)
    for u, v in (edges.T, edges.T[::-1]):
        beside[u[fixed[v]]] = True
        positive[u[above[v]]] = True
    fixed &= ~beside & positive
    corners = named_supports(problem.vertices * [1.0, 1.0, 0.0], faces, "corners")
    # A column at an inward corner stands among the others.
    fixed[np.intersect1d(corners, np.unique(faces)[ConvexHull(problem.vertices[np.unique(faces), :2]).vertices])] = False
    return np.flatnonzero(fixed).tolist()


def _has_a_plan(vertices: FloatArray, faces: IntArray) -> bool:
    """Return whether a mesh is seen from above, as a roof is and a facade is not."""
    return bool(face_areas(flattened(vertices), faces).sum() > UPRIGHT * face_areas(vertices, faces).sum())


def _blamed(rough: Attempt, drawn: FloatArray, columns: Sequence[int]) -> int:
    """Return the column that most of what is rough lies next to; without any, the one that stands farthest off the others."""
    if not rough.judged.places:
        return columns[0]
    nearest = cKDTree(drawn[list(columns), :2]).query(rough.vertices[rough.judged.places, :2])[1]
    return columns[int(np.argmax(np.bincount(nearest, minlength=len(columns))))]


def _without(problem: CGCProblem, columns: Sequence[int], over: bool = False) -> CGCProblem:
    """Return the problem with columns taken away, and the mesh drawn where they stood as it is around; it may be kept over their places."""
    V = problem.vertices.copy()
    edges = edge_faces(problem.faces)[:, :2]
    for column in columns:
        ring = np.setdiff1d(edges[(edges == column).any(axis=1)], columns)
        V[column, 2] = V[ring, 2].mean()
    left = np.setdiff1d(np.flatnonzero(problem.roles == FIXED), columns)
    lines = [OnLine([int(column)], V[column], (0.0, 0.0, 1.0)) for column in columns] if over else []
    return problem.with_vertices(V).with_supports(problem.names.vertices[left].tolist()).with_goals(lines)


def _farthest(problem: CGCProblem, column: int, height: float, lift: float, solve: Solve) -> float:
    """Return the height of a column nearest to its own at which the surface is fair, from where it runs without it."""
    good, bad = 0.0, 1.0
    for _ in range(HALVINGS):
        if is_spent():
            break
        middle = 0.5 * (good + bad)
        V = problem.vertices.copy()
        V[column, 2] = height + middle * lift
        found = solve(problem.with_vertices(V))
        good, bad = (middle, bad) if found is not None and found.judged.fair else (good, middle)
    return height + good * lift


def _height(vertices: FloatArray, faces: IntArray, place: FloatArray) -> Optional[float]:
    """Return the height of a surface over a place in plan (2,), None beside it."""
    a, b, c = (vertices[faces[:, k], :2] - place for k in range(3))
    parts = np.array([p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b))])
    whole = parts.sum(axis=0)
    shares = parts / np.where(whole == 0.0, np.inf, whole)
    best = int(np.argmax(shares.min(axis=0)))
    if shares[:, best].min() < -SLACK:
        return None
    return float(shares[:, best] @ vertices[faces[best], 2])
