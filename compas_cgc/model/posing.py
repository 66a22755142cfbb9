"""What is asked of a problem of arrays: the methods of CGCMesh as functions, each of which returns a new problem.

Examples
--------
>>> import numpy as np
>>> from compas_cgc import CGCProblem, solve_problem
>>> from compas_cgc.model.posing import set_supports, set_target
>>> i, j = np.divmod(np.arange(100), 10)
>>> vertices = np.column_stack([i, j, 0 * i])
>>> a = np.array([k for k in range(90) if k % 10 < 9])
>>> faces = np.vstack([np.column_stack([a, a + 10, a + 11]), np.column_stack([a, a + 11, a + 1])])
>>> problem = CGCProblem(vertices, faces)
>>> problem = set_target(set_supports(problem, "boundary"), 0.01)
>>> solve_problem(problem).status
'converged'
"""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import replace
from typing import Optional
from typing import Union

import numpy as np

from ..discrete import boundary_vertices
from ..meshing import lost_edges
from ..meshing import named_supports
from ..meshing import path_edges
from .problem import CREASE
from .problem import DUMMY
from .problem import FIXED
from .problem import FREE
from .problem import INTERNAL
from .problem import CGCProblem

__all__ = ["flip", "set_creases", "set_supports", "set_target"]


def set_supports(problem: CGCProblem, supports: Union[str, Iterable[int]]) -> CGCProblem:
    """Fix vertices, and no others.

    Parameters
    ----------
    problem
        Vertices and faces.
    supports
        Positions of vertices, ``"boundary"`` for every vertex on an open edge, or ``"corners"`` for those where an
        open edge turns by more than 30 degrees.

    Raises
    ------
    ValueError
        If there is no such vertex.
    """
    if isinstance(supports, str):
        fixed = named_supports(problem.vertices, problem.faces[problem.real_faces], supports)
    else:
        fixed = np.array([_known(problem, v) for v in supports], dtype=np.int64)
    roles = np.where(problem.roles == DUMMY, DUMMY, INTERNAL)
    roles[fixed] = FIXED
    return _placed(problem, roles)


def set_creases(problem: CGCProblem, creases: Iterable[Sequence[int]]) -> CGCProblem:
    """Let the surface fold along edges, and no others.

    Parameters
    ----------
    problem
        Vertices and faces.
    creases
        Edges ``(u, v)`` or paths ``[u, v, w, ...]`` of positions of vertices.

    Raises
    ------
    ValueError
        If two vertices that follow each other are not joined by an edge.
    """
    edges = np.array(path_edges([[_known(problem, v) for v in path] for path in creases]), dtype=np.int64).reshape(-1, 2)
    lost = lost_edges(problem.faces, edges)
    if lost.any():
        a, b = edges[np.argmax(lost)].tolist()
        raise ValueError(f"the crease from vertex {a} to {b} does not follow an edge; lead it along edges of the mesh")
    return _placed(replace(problem, creases=edges), problem.roles)


def set_target(problem: CGCProblem, K: float, region: Optional[int] = None) -> CGCProblem:
    """Ask for a Gaussian curvature [1/L^2], everywhere or in a region.

    Raises
    ------
    ValueError
        If there is no such region.
    """
    own = np.ones(len(problem.vertices), bool)
    if region is not None:
        label = problem.regions()
        count = int(label[problem.real_faces].max(initial=-1)) + 1
        if not 0 <= region < count:
            raise ValueError(f"there is no region {region}; the mesh has {count}, from 0 to {count - 1}")
        own[:] = False
        own[problem.faces[label == region]] = True
        own &= problem.roles != CREASE
    return replace(problem, targets=np.where(own, K, problem.targets))


def flip(problem: CGCProblem) -> CGCProblem:
    """Turn all faces over, so that the other side is the outside."""
    return replace(problem, faces=problem.faces[:, ::-1])


def _placed(problem: CGCProblem, roles: np.ndarray) -> CGCProblem:
    """Give every vertex that is neither fixed nor dummy the role that its place calls for."""
    creased = np.zeros(len(roles), bool)
    creased[problem.creases] = True
    place = np.where(creased, CREASE, np.where(boundary_vertices(problem.vertices, problem.faces), FREE, INTERNAL))
    return replace(problem, roles=np.where(np.isin(roles, (FIXED, DUMMY)), roles, place))


def _known(problem: CGCProblem, v: int) -> int:
    if not 0 <= v < len(problem.vertices):
        raise ValueError(f"there is no vertex {v!r} in the mesh")
    return int(v)
