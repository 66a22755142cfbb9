"""Roofs to build: nine regions on four columns, and irregular disks."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy.spatial import Delaunay

from compas_cgc import CGCProblem

from .shapes import grid


def nine_regions(n: int, K: float = 0.01, centre: Optional[float] = None, width: float = 15.0) -> CGCProblem:
    """Return a square plan of n by n squares on its corners, in nine regions, the middle one with a K of its own."""
    vertices, faces = grid(n, width)
    third = n // 3
    across = [[i * (n + 1) + j for j in range(n + 1)] for i in (third, 2 * third)]
    along = [[i * (n + 1) + j for i in range(n + 1)] for j in (third, 2 * third)]
    problem = CGCProblem(vertices, faces, creases=[*across, *along]).with_supports("corners").with_targets(K)
    return problem if centre is None else problem.with_targets({4: centre})


def irregular_disk(count: int, K: float = 0.01, radius: float = 7.5, seed: int = 3) -> CGCProblem:
    """Return a flat disk of a random triangulation with about a third of the triangles obtuse, fixed all around."""
    rng = np.random.default_rng(seed)
    around = max(12, round(3 * count**0.5))
    angle = 2 * np.pi * np.arange(around) / around
    spacing = 2 * np.pi / around
    points = list(np.column_stack([np.cos(angle), np.sin(angle)]))
    while len(points) < count:
        point = rng.uniform(-1, 1, 2)
        if point @ point < (1 - 0.7 * spacing) ** 2 and np.linalg.norm(np.array(points) - point, axis=1).min() > 0.45 * spacing:
            points.append(point)
    plan = radius * np.array(points)
    return _triangulated(plan).with_supports("boundary").with_targets(K)


def shaken_square(n: int, K: float, shake: float = 0.4, seed: int = 5, width: float = 15.0) -> CGCProblem:
    """Return a flat square on its corners, the points of a grid of n by n moved by up to a part of their distance and triangulated anew.

    Shaken by .4 some 28 % of the triangles are obtuse, by .5 about 35 %.
    """
    plan = grid(n, width)[0][:, :2].copy()
    inner = ((plan > 1e-9) & (plan < width - 1e-9)).all(axis=1)
    plan[inner] += np.random.default_rng(seed).uniform(-shake, shake, (int(inner.sum()), 2)) * width / n
    return _triangulated(plan).with_supports("corners").with_targets(K)


def _triangulated(plan: np.ndarray) -> CGCProblem:
    faces = Delaunay(plan).simplices.astype(np.int64)
    a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
    double = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    faces = np.where((double < 0)[:, None], faces[:, ::-1], faces)[np.abs(double) > 1e-9]
    return CGCProblem(np.column_stack([plan, np.zeros(len(plan))]), faces)


def obtuse_share(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Return the part of the triangles that are obtuse."""
    edges = vertices[np.roll(faces, -1, axis=1)] - vertices[faces]
    dots = -np.einsum("fcx,fcx->fc", edges, np.roll(edges, 1, axis=1))
    return float((dots < 0).any(axis=1).mean())
