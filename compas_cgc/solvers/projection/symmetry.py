"""Which vertices are mirror images of which."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ...discrete import edge_faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import ProblemError
from ...model.constraints import Mirror
from ...model.constraints import unit
from ...model.problem import CGCProblem
from ...model.tolerances import NEGLIGIBLE

__all__ = ["Image", "images", "keep_faces", "tears_faces", "together"]

REACH = 0.5  # distance of an image from its vertex in edge lengths; beyond half an edge another vertex is nearer
MOST = 48  # images of a vertex; the symmetries of a cube


class Image(NamedTuple):
    """One symmetry: vertex i goes to ``turn @ x_i + shift``, the place of vertex ``to[i]``."""

    to: IntArray  # (n,)
    turn: FloatArray  # (3, 3)
    shift: FloatArray  # (3,)


def images(vertices: FloatArray, edge: float, mirrors: Sequence[Mirror]) -> list[Image]:
    """Return all symmetries that a few mirrors make together, the identity first.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates of the start [L].
    edge
        Mean length of an edge [L].
    mirrors
        The mirrors.

    Raises
    ------
    ProblemError
        If a vertex has no image, or the mirrors make no end of images.
    """
    return together([_reflection(vertices, edge, mirror) for mirror in mirrors], len(vertices))


def together(generators: Sequence[Image], count: int) -> list[Image]:
    """Return all symmetries of `count` vertices that a few make together, the identity first."""
    found = [Image(np.arange(count), np.eye(3), np.zeros(3))]
    for image in found:
        for other in generators:
            new = Image(other.to[image.to], other.turn @ image.turn, other.turn @ image.shift + other.shift)
            if not any(_same(new, known) for known in found):
                found.append(new)
            if len(found) > MOST:
                raise ProblemError([f"the mirrors make more than {MOST} images of a vertex; use planes that meet at 90 or 45 degrees"])
    return found


def _same(one: Image, other: Image) -> bool:
    near = [np.allclose(a, b, rtol=0, atol=NEGLIGIBLE) for a, b in ((one.turn, other.turn), (one.shift, other.shift))]
    return np.array_equal(one.to, other.to) and all(near)


def keep_faces(faces: IntArray, symmetries: Sequence[Image]) -> bool:
    """Return whether the symmetries take every face (m, 3) to a face."""

    def sorted_faces(to: IntArray) -> IntArray:
        corners = np.sort(to[faces], axis=1)
        return corners[np.lexsort(corners.T)]

    first = sorted_faces(symmetries[0].to)
    return all(np.array_equal(first, sorted_faces(image.to)) for image in symmetries[1:])


def tears_faces(problem: CGCProblem) -> bool:
    """Return whether mirrors are asked for that take some face of a problem to none, whose K is then asked for twice over."""
    mirrors = [constraint for constraint in problem.goals if isinstance(constraint, Mirror)]
    if not mirrors:
        return False
    V, edges = problem.vertices, edge_faces(problem.faces)
    edge = float(np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1).mean())
    return not keep_faces(problem.faces, images(V, edge, mirrors))


def _reflection(vertices: FloatArray, edge: float, mirror: Mirror) -> Image:
    normal = unit(mirror.normal, "the normal of a mirror")
    turn = np.eye(3) - 2.0 * np.outer(normal, normal)
    shift = 2.0 * float(normal @ np.asarray(mirror.point, float)) * normal
    distance, to = cKDTree(vertices).query(vertices @ turn + shift)
    lost = np.flatnonzero((distance > REACH * edge) | (to[to] != np.arange(len(to))))
    if len(lost):
        raise ProblemError(
            [f"vertex {lost[0]} has no mirror image of its own; make the mesh symmetric about the mirror, or move the mirror"]
        )
    return Image(to, turn, shift)
