"""Dummy mesh: one ring of faces outside the free edges, so that K can be prescribed on them (Section 4.1)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete import boundary_vertices
from ..meshing import dummy_ring
from .problem import CGCProblem
from .problem import Names
from .roles import DUMMY
from .roles import FREE
from .roles import INTERNAL

__all__ = ["with_dummy_ring"]


def with_dummy_ring(problem: CGCProblem) -> CGCProblem:
    """Return the problem with dummy faces along its free edges, which then have targets too.

    The dummy vertices come last. A problem without movable boundary vertices is returned unchanged.
    """
    rim = boundary_vertices(problem.vertices, problem.faces)
    if not (rim & problem.movable).any():
        return problem
    vertices, faces, inner = dummy_ring(problem.vertices, problem.faces, problem.movable)
    nothing = np.full(len(inner), np.nan)
    unnamed = np.full(len(inner), -1), np.full(len(faces) - len(problem.faces), -1)
    return replace(
        problem,
        vertices=vertices,
        faces=faces,
        roles=np.concatenate([np.where(problem.roles == FREE, INTERNAL, problem.roles), np.full(len(inner), DUMMY)]),
        targets=np.concatenate([problem.targets, nothing]),
        s=np.concatenate([problem.s, nothing]),
        e=np.concatenate([problem.e, nothing]),
        names=Names(*(np.concatenate(pair) for pair in zip(problem.names, unnamed))),
    )
