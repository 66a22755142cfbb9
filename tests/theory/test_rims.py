"""Rims that are held all round, up to nearly the K that they carry, from flat meshes."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import face_areas
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.limits import largest_target

from ..support.shapes import grid
from ..support.tiers import push_only
from ..system.fairness_study import mesh
from ..system.fairness_study import outline

NEARLY = 0.95
CIRCLE = 2.0 * np.pi * np.arange(720) / 720


def loops(plan: str) -> list[np.ndarray]:
    if plan == "ellipse":
        return [np.column_stack([np.cos(CIRCLE), 0.6 * np.sin(CIRCLE)])]
    if plan == "hexagon":
        corners = np.column_stack([np.cos(CIRCLE[::120]), np.sin(CIRCLE[::120])])
        along = np.linspace(0.0, 1.0, 120, endpoint=False)[:, None]
        return [np.vstack([p + (q - p) * along for p, q in zip(corners, np.roll(corners, -1, axis=0))])]
    return outline(plan, np.random.default_rng(1))


def held(plan: str, layout: str) -> CGCProblem:
    vertices, faces = mesh(loops(plan), layout, 200, np.random.default_rng(1))
    return CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), 1.0)


def folded_L(n: int) -> CGCProblem:
    """An L held all round, with a crease from its inward corner: K > 0 cannot turn around that."""
    at = {(i, j): None for i in range(2 * n + 1) for j in range(2 * n + 1) if i <= n or j <= n}
    number = {place: k for k, place in enumerate(at)}
    squares = [(i, j) for i in range(2 * n) for j in range(2 * n) if i < n or j < n]
    corners = [[number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]] for i, j in squares]
    faces = np.array([triangle for a, b, c, d in corners for triangle in ((a, b, c), (a, c, d))])
    vertices = np.column_stack([np.array(list(at)) / n - 1.0, np.zeros(len(at))])
    roles = np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL)
    return CGCProblem(vertices, faces, roles, 1.0).with_creases([[number[k, k], number[k + 1, k + 1]] for k in range(n)])


@pytest.mark.parametrize("layout", push_only(["regular", "delaunay"], "delaunay"))
@pytest.mark.parametrize("plan", push_only(["disc", "square", "hexagon", "ellipse"], "disc", "square"))
def test_nearly_all_that_a_rim_carries_is_solved_from_a_flat_mesh(plan, layout):
    problem = held(plan, layout)
    most = largest_target(problem, tolerance=0.01).factor
    area = float(face_areas(problem.vertices, problem.faces).sum())
    # The normals of a graph cover at most a half sphere, and those of a dome over a disc all of it.
    assert most * area <= 1.05 * np.pi
    assert most * area >= (0.98 if plan == "disc" else 0.75) * np.pi
    result = solve(problem.with_targets(NEARLY * most))
    assert result.converged and result.verdict.fair, str(result.verdict)


def test_on_triangles_graded_towards_a_straight_rim_the_height_is_of_order_1_5():
    heights = []
    for n in (12, 24, 48):
        across = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, n + 1)))
        vertices, faces = grid(n)
        vertices[:, :2] = across[np.rint(n * vertices[:, :2]).astype(int)]
        result = solve(CGCProblem(vertices, faces).with_supports("boundary").with_targets(1.5))
        assert result.verdict.fair and result.method == "newton", result.message
        heights.append(result.vertices[:, 2].max())
    coarse, fine = np.diff(heights)
    assert np.log2(coarse / fine) > 1.5


@pytest.mark.nightly
def test_an_L_with_a_crease_from_its_inward_corner_is_solved_as_far():
    problem = folded_L(8)
    most = largest_target(problem, tolerance=0.01).factor
    # The Gauss map of a graph over either half of the L, whose area is 1.5, covers less than the projected half sphere.
    assert 0.1 < most < np.pi / 1.5
    for part in (0.5, 0.8, NEARLY):
        result = solve(problem.with_targets(part * most))
        assert result.converged and result.verdict.fair, str(result.verdict)
    whole = solve(problem.with_creases([]))
    assert not whole.verdict.fair and "the supported boundary has a reentrant corner of 90 degrees" in whole.message
