"""Example 6: a free-form plan, bounded by a closed quadratic Bezier curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import sparse

from ...datastructures import CGCMesh
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...solvers.flow import FlowSettings
from .grids import PAPER

__all__ = ["closed_bezier", "example6", "hexagonal_disk", "plan_dome"]

CONTROL_POINTS = (
    (5.6, 0.0),
    (4.1, 3.1),
    (1.4, 5.0),
    (-1.6, 4.7),
    (-3.8, 2.8),
    (-4.6, 0.0),
    (-4.0, -3.0),
    (-1.8, -4.9),
    (1.6, -4.4),
    (4.0, -2.7),
)


def closed_bezier(control: FloatArray, count: int) -> FloatArray:
    """Return `count` points (count, 2), evenly spaced along the closed quadratic Bezier curve of a control polygon."""
    corner = np.asarray(control, dtype=np.float64)[:, None]
    start, end = 0.5 * (np.roll(corner, 1, axis=0) + corner), 0.5 * (corner + np.roll(corner, -1, axis=0))
    t = np.linspace(0, 1, 400, endpoint=False)[:, None]
    curve = ((1 - t) ** 2 * start + 2 * t * (1 - t) * corner + t**2 * end).reshape(-1, 2)
    curve = np.concatenate([curve, curve[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    at = np.linspace(0, length[-1], count, endpoint=False)
    return np.column_stack([np.interp(at, length, curve[:, 0]), np.interp(at, length, curve[:, 1])])


def hexagonal_disk(rings: int) -> tuple[IntArray, IntArray, IntArray]:
    """Return faces (6 rings^2, 3), ring (n,) and position in the ring (n,) of a disk whose inner vertices have valence 6."""
    first = np.concatenate([[0], 1 + 3 * np.arange(rings + 1) * np.arange(1, rings + 2)])
    faces = []
    for r in range(1, rings + 1):
        inside, outside = max(1, 6 * (r - 1)), 6 * r
        for side in range(6):
            for k in range(r):
                a = first[r - 1] + (side * (r - 1) + k) % inside
                b, c = first[r] + side * r + k, first[r] + (side * r + k + 1) % outside
                faces.append([a, b, c])
                if k < r - 1:
                    faces.append([a, c, first[r - 1] + (side * (r - 1) + k + 1) % inside])
    ring = np.repeat(np.arange(rings + 1), [1] + [6 * r for r in range(1, rings + 1)])
    return np.array(faces), ring, np.arange(len(ring)) - first[ring]


def plan_dome(control: FloatArray, rings: int, height: float) -> CGCMesh:
    """Return a low dome over a plan: a hexagonal disk, relaxed in plan, with its boundary fixed.

    Parameters
    ----------
    control
        ``(c, 2)`` control points of the boundary [L].
    rings
        Number of rings of vertices around the centre.
    height
        Height of the dome [L].
    """
    faces, ring, place = hexagonal_disk(rings)
    rim = closed_bezier(control, 6 * rings)
    part = ring / rings
    at = place * np.divide(rings, ring, out=np.zeros(len(ring)), where=ring > 0)
    low = np.floor(at).astype(int)
    plan = part[:, None] * (rim[low % len(rim)] + (at - low)[:, None] * (rim[(low + 1) % len(rim)] - rim[low % len(rim)]))
    plan = _relaxed(plan, faces, ring == rings)
    z = height * (1 - part**2) ** 0.6
    mesh = CGCMesh.from_vertices_and_faces(np.column_stack([plan, z]), faces)
    mesh.set_supports("boundary")
    return mesh


def _relaxed(points: FloatArray, faces: IntArray, fixed: Mask, rounds: int = 30) -> FloatArray:
    n = len(points)
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    adjacency = sparse.csr_matrix((np.ones(2 * len(u)), (np.r_[u, v], np.r_[v, u])), shape=(n, n))
    adjacency.data[:] = 1.0
    valence = np.asarray(adjacency.sum(axis=1))
    for _ in range(rounds):
        points = np.where(fixed[:, None], points, (adjacency @ points) / valence)
    return points


def example6() -> tuple[CGCMesh, FlowSettings]:
    """Return the counterpart of Example 6: K̄ = 0.03 over a free-form plan, 625 vertices with dummies.

    The paper shows the control points and the initial mesh (648 vertices) in a picture only.
    The initial dome is as high as the solution: with such a small filter, curvature spreads
    over only a few edges per hundred steps, too slowly for a flat initial mesh.

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> example6()[0].number_of_vertices()
    625
    """
    mesh = plan_dome(np.array(CONTROL_POINTS), rings=13, height=2.4)
    mesh.set_target(0.03)
    mesh.add_dummy_ring()
    return mesh, replace(PAPER, steps=500, mu0=2.0, filter_radius=1.0)
