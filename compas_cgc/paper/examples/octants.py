"""Example 7: eight mirrored sectors between curved and straight creases."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...datastructures import CGCMesh
from ...discrete.arrays import FloatArray
from ...solvers.flow import FlowSettings
from .grids import PAPER

__all__ = ["example7", "octant"]


def octant(k: int) -> dict[tuple[int, int], FloatArray]:
    """Return the points of one octant, in k rows from the centre (0, 0) to the arc (k, 0) ... (k, k).

    The octant is bounded by the line from (0, 0, 0) to (0, 7, 0), the arc through (0, 7, 0), (3, 7, 0)
    and (5, 5, 0), and the quadratic Bezier curve with the control points (5, 5, 0),
    (2.5, 2.5, 2.5) and (0, 0, 0).
    """
    centre, radius = np.array([1.5, 3.5, 0.0]), math.sqrt(14.5)
    begin, end = math.atan2(3.5, -1.5), math.atan2(1.5, 3.5)
    points = {}
    for i in range(k + 1):
        t = i / k
        line = np.array([0.0, 7.0 * t, 0.0])
        curve = 2 * t * (1 - t) * np.array([2.5, 2.5, 2.5]) + t * t * np.array([5.0, 5.0, 0.0])
        for j in range(i + 1):
            w = j / i if i else 0.0
            angle = begin + (end - begin) * w
            arc = centre + radius * np.array([math.cos(angle), math.sin(angle), 0.0])
            chord = (1 - w) * np.array([0.0, 7.0, 0.0]) + w * np.array([5.0, 5.0, 0.0])
            points[i, j] = (1 - w) * line + w * curve + t * (arc - chord)
    return points


def mirrored(k: int) -> tuple[FloatArray, list[list[int]]]:
    """Return vertices and faces of the octant mirrored at x = y, y = 0 and x = 0."""
    points = octant(k)
    index: dict[tuple, int] = {}
    vertices: list[FloatArray] = []
    faces = []

    def vertex(point: FloatArray) -> int:
        key = tuple((np.round(point, 9) + 0.0).tolist())
        if key not in index:
            index[key] = len(vertices)
            vertices.append(point)
        return index[key]

    for x in (1, -1):
        for y in (1, -1):
            for swap in (False, True):
                place = {
                    at: vertex(np.array([x * p[swap], y * p[not swap], p[2]])) for at, p in ((at, p.tolist()) for at, p in points.items())
                }
                # Clockwise in the first octant; each mirroring reverses the faces.
                turned = (x * y < 0) == swap
                for i in range(1, k + 1):
                    for j in range(i):
                        corners = [[(i - 1, j), (i, j), (i, j + 1)]]
                        if j < i - 1:
                            corners.append([(i - 1, j), (i, j + 1), (i - 1, j + 1)])
                        faces += [[place[at] for at in (face[::-1] if turned else face)] for face in corners]
    return np.array(vertices), faces


def example7(target: float = 0.05) -> tuple[CGCMesh, FlowSettings]:
    """Return the counterpart of Example 7: creases on the four planes of symmetry, 353 vertices with dummies.

    The curves are given in the paper. Their division (389 vertices) and the supports at the
    four points (±5, ±5, 0) are taken from its pictures.

    Parameters
    ----------
    target
        Target curvature, 0.05 or 0 in the paper [1/L^2].

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> example7()[0].number_of_vertices()
    353
    """
    vertices, faces = mirrored(8)
    mesh = CGCMesh.from_vertices_and_faces(vertices, faces)
    x, y = np.abs(vertices[:, 0]), np.abs(vertices[:, 1])
    on_plane = np.minimum.reduce([x, y, np.abs(x - y)]) < 1e-9
    mesh.set_supports(np.flatnonzero((np.abs(x - 5) < 1e-9) & (np.abs(y - 5) < 1e-9)).tolist())
    # An edge is a crease if both ends lie on the same plane of symmetry.
    planes = np.column_stack([x < 1e-9, y < 1e-9, np.abs(x - y) < 1e-9])
    mesh.set_creases([(u, v) for u, v in mesh.edges() if on_plane[u] and on_plane[v] and (planes[u] & planes[v]).any()])
    mesh.set_target(target)
    mesh.add_dummy_ring()
    return mesh, replace(PAPER, steps=500, mu0=10.0, filter_radius=5.0, s=0.8)
