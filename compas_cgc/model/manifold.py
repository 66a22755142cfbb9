"""Manifold problem from one whose parts meet in points or at edges of more than two faces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..meshing.orient import orient
from ..meshing.splitting import split_vertices
from .problem import CGCProblem

__all__ = ["as_manifold"]


def as_manifold(problem: CGCProblem) -> CGCProblem:
    """Return a problem in which parts that meet in a point, or at an edge of more than two faces, have vertices of their own.

    Copies of a vertex are supports like it and have its values; goals refer to the first copy. Creases remain where two faces meet.
    """
    n = len(problem.vertices)
    split = split_vertices(problem.faces, n)
    if len(split.source) == n:
        return problem
    faces = orient(split.faces).faces
    sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    drawn = np.sort(split.source[edges], axis=1) @ [n, 1]
    made = CGCProblem(
        problem.vertices[split.source],
        faces,
        **{name: getattr(problem, name)[split.source] for name in ("targets", "s", "e")},
        creases=edges[(count == 2) & np.isin(drawn, np.sort(problem.creases, axis=1) @ [n, 1])],
        goals=problem.goals,
        drawing=problem.drawing,
    )
    regions, first = np.unique(made.regions(), return_index=True)
    before = problem.regions()[first]
    laws = {int(region): problem.laws[int(old)] for region, old in zip(regions, before) if int(old) in problem.laws}
    supports = np.flatnonzero(np.isin(split.source, problem.supports))
    return replace(made, laws=laws).with_supports(supports.tolist())
