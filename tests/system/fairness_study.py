"""How many of a few hundred random problems end fair, class by class.

Run as ``python -m tests.system.fairness_study [problems] [measure]``; every problem can be had again by its number.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial import Delaunay
from scipy.spatial import cKDTree

from compas_cgc.analysis import verdict
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete.arrays import FloatArray
from compas_cgc.discrete.arrays import IntArray
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection import ProjectionSettings
from compas_cgc.solvers.projection import project

PLANS = ("disc", "ellipse", "square", "L", "blob", "annulus")
LAYOUTS = ("regular", "delaunay", "graded", "anisotropic")
SUPPORTS = ("points", "heights", "part", "rim")


class Case(NamedTuple):
    """A random problem."""

    name: str
    group: str
    problem: CGCProblem


def outline(plan: str, rng: np.random.Generator) -> list[FloatArray]:
    """Return the loops (p, 2) around a plan of about unit radius, the outer one first."""
    t = 2 * np.pi * np.arange(720) / 720
    circle = np.column_stack([np.cos(t), np.sin(t)])
    if plan == "ellipse":
        return [circle * [1.0, rng.uniform(0.5, 0.9)]]
    if plan == "blob":
        return [circle * (1 + 0.12 * np.cos(2 * t + rng.uniform(0, 6)) + 0.07 * np.cos(3 * t + rng.uniform(0, 6)))[:, None]]
    if plan == "annulus":
        return [circle, rng.uniform(0.3, 0.5) * circle[::-1]]
    corners = {"square": [(-1, -1), (1, -1), (1, 1), (-1, 1)], "L": [(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)]}
    if plan in corners:
        c = np.array(corners[plan], float)
        return [np.vstack([p + (q - p) * np.linspace(0, 1, 120, endpoint=False)[:, None] for p, q in zip(c, np.roll(c, -1, axis=0))])]
    return [circle]


def within(points: FloatArray, loops: list[FloatArray]) -> np.ndarray:
    """Return which points (k, 2) lie inside, by the turns that the loops make around them."""
    turns = np.zeros(len(points))
    for loop in loops:
        a = loop[None] - points[:, None]
        b = np.roll(a, -1, axis=1)
        turns += np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=2)).sum(axis=1)
    return turns > np.pi


def resampled(loop: FloatArray, step: float) -> FloatArray:
    """Return points on a loop, about a step apart."""
    closed = np.vstack([loop, loop[:1]])
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    at = np.linspace(0, along[-1], max(8, round(along[-1] / step)), endpoint=False)
    return np.column_stack([np.interp(at, along, closed[:, k]) for k in (0, 1)])


def mesh(loops: list[FloatArray], layout: str, count: int, rng: np.random.Generator) -> tuple[FloatArray, IntArray]:
    """Return a triangle mesh of a plan."""
    step = np.sqrt(2.6 / count)
    stretch = np.array([1.0, 3.0]) if layout == "anisotropic" else np.ones(2)
    loops = [loop * stretch for loop in loops]
    step *= np.sqrt(stretch.prod())
    rim = np.vstack([resampled(loop, step) for loop in loops])
    row, column = np.meshgrid(np.arange(-4 / step, 4 / step) * 0.87, np.arange(-4 / step, 4 / step), indexing="ij")
    inner = step * np.column_stack([(column + 0.5 * (np.arange(len(row)) % 2)[:, None]).ravel(), row.ravel()])
    if layout != "regular":
        inner = inner + rng.uniform(-0.3, 0.3, inner.shape) * step
    inner = inner[within(inner, loops)]
    inner = inner[cKDTree(rim).query(inner)[0] > 0.6 * step]
    if layout == "graded":
        inner = inner[rng.uniform(size=len(inner)) < np.clip(1.1 - 0.7 * np.hypot(*(inner - [0.6, 0.4]).T), 0.12, 1)]
    points = np.vstack([rim, inner])
    faces = Delaunay(points).simplices.astype(np.int64)
    faces = faces[within(points[faces].mean(axis=1), loops)]
    a, b = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    faces[area < 0] = faces[area < 0][:, ::-1]
    faces = faces[np.abs(area) > 1e-3 * np.abs(area).mean()]
    used, faces = np.unique(faces, return_inverse=True)
    return np.column_stack([points[used] / stretch, np.zeros(len(used))]), faces.reshape(-1, 3)


def case(number: int) -> Case:
    """Return one random problem."""
    rng = np.random.default_rng(number)
    plan, layout, supports = (str(rng.choice(kinds)) for kinds in (PLANS, LAYOUTS, SUPPORTS))
    vertices, faces = mesh(outline(plan, rng), layout, int(rng.integers(150, 500)), rng)
    rim = np.flatnonzero(boundary_vertices(vertices, faces))
    rim = rim[np.argsort(np.arctan2(*vertices[rim, :2].T))]
    sign = 1.0 if supports == "rim" else float(rng.choice([-1.0, 1.0]))
    fixed = rim
    if supports in ("points", "heights"):
        n = int(rng.integers(3, 7))
        fixed = rim[(np.arange(n) * len(rim) // n + int(rng.integers(len(rim)))) % len(rim)]
    if supports == "part":
        fixed = rim[: int(len(rim) * rng.uniform(0.3, 0.6))]
    if supports == "heights":
        vertices[fixed, 2] = rng.uniform(0, 0.5, len(fixed))
    roles = np.full(len(vertices), INTERNAL)
    roles[rim] = FREE
    roles[fixed] = FIXED
    target = sign * float(rng.uniform(0.1, 0.7))
    group = "rim" if supports == "rim" else "heights" if supports == "heights" else f"{supports}, K {'>' if sign > 0 else '<'} 0"
    return Case(
        f"{number}: {plan}, {layout}, {supports}, {len(vertices)} vertices, K = {target:.3f}",
        group,
        CGCProblem(vertices, faces, roles, target),
    )


def main(count: int = 60, measure: str = "defect") -> None:
    """Solve and judge; print every surface that is not fair, and the classes."""
    groups: dict[str, list[tuple[bool, bool, float, float]]] = defaultdict(list)
    for number in range(count):
        one = case(number)
        solution = project(one.problem, settings=ProjectionSettings(measure=measure))
        judged = verdict(replace(one.problem, vertices=solution.vertices), one.problem.vertices)
        done = solution.status == "converged"
        groups[one.group].append((done, done and judged.fair, judged.fit_median or 0.0, judged.sharpest_fold))
        if not (done and judged.fair):
            print(f"{one.name}: {solution.status} in {solution.iterations}, {judged}", flush=True)
    print(f"{'class':16s} {'n':>3s} converged fair  median fit  median fold")
    for group, rows in sorted(groups.items()):
        done, fair, fit, fold = np.array(rows, float).T
        print(f"{group:16s} {len(rows):3d} {int(done.sum()):9d} {int(fair.sum()):4d} {np.median(fit):11.3f} {np.median(fold):10.0f}°")


if __name__ == "__main__":
    main(*(int(word) if word.isdigit() else word for word in sys.argv[1:]))
