"""Over a convex plan of area A, K > 0 is less than pi / A: the slopes of a convex surface differ everywhere."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import vertex_areas
from compas_cgc.model.checks import check
from compas_cgc.model.convex_plans import beyond_convex_plans
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.verdict import verdict

from ..support.shapes import grid


def disc(reach: float, n: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """A cap of the unit sphere over a disc of radius `reach`."""
    vertices, faces = grid(n, 2.0)
    x, y = vertices[:, :2].T - 1.0
    radius, turn = np.maximum(np.abs(x), np.abs(y)), np.arctan2(y, x)
    plan = reach * radius[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    return np.column_stack([plan, np.sqrt(1.0 - (plan**2).sum(axis=1))]), faces


@pytest.mark.parametrize("reach", [0.5, 0.9, 0.99])
def test_a_cap_of_a_sphere_is_within_the_bound_and_one_of_a_larger_k_is_beyond(reach):
    vertices, faces = disc(reach)
    problem = CGCProblem(vertices, faces, targets=1.0).with_supports("boundary")
    assert not beyond_convex_plans(problem)
    most = np.pi / float(vertex_areas(vertices * [1.0, 1.0, 0.0], faces).sum())
    assert most == pytest.approx(1.0 / reach**2, rel=0.02)
    (said,) = beyond_convex_plans(problem.with_targets(1.01 * most))
    assert f"no surface over this convex plan has K = {most:.4g} or more" in said
    assert said in verdict(problem.with_targets(1.01 * most)).reasons and not beyond_convex_plans(problem.with_targets(0.99 * most))


def test_the_bound_moves_with_the_surface_and_holds_for_each_region():
    vertices, faces = grid(8)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    problem = CGCProblem(vertices, faces, targets=4.0).with_supports("corners")
    turn *= np.linalg.det(turn)
    assert len(beyond_convex_plans(problem)) == len(beyond_convex_plans(problem.with_vertices(vertices @ turn.T + 5.0))) == 1
    crease = [(9 * 4 + k) for k in range(9)]
    assert not beyond_convex_plans(CGCProblem(vertices, faces, targets=4.0, creases=[crease]).with_supports("corners"))
    halves = beyond_convex_plans(CGCProblem(vertices, faces, targets=6.5, creases=[crease]).with_supports("corners"))
    assert [said.split(" has K")[0][-8:] for said in halves] == ["region 0", "region 1"]


def test_the_k_of_a_small_region_counts_and_not_that_beside_it():
    vertices, faces = grid(9)
    lines = [[10 * i + k for k in range(10)] for i in (3, 6)] + [[10 * k + i for k in range(10)] for i in (3, 6)]
    problem = CGCProblem(vertices, faces, targets=1.0, creases=lines).with_supports("corners")
    for part, count in ((0.999, 0), (1.001, 1)):
        assert len(beyond_convex_plans(problem.with_targets(part * 9.0 * np.pi, region=4))) == count


def test_nothing_is_said_where_a_plan_is_not_convex_or_k_is_not_positive():
    vertices, faces = grid(8)
    middle = vertices[faces].mean(axis=1)
    inside = (middle[:, 0] < 0.5) | (middle[:, 1] < 0.5)
    assert not beyond_convex_plans(CGCProblem(vertices, faces[inside], targets=9.0).with_supports("boundary").without_dummies())
    assert not beyond_convex_plans(CGCProblem(vertices, faces, targets=-9.0).with_supports("corners"))
    assert not beyond_convex_plans(CGCProblem(vertices, faces).with_supports("corners"))


def test_a_problem_is_warned_of_before_it_is_solved_unless_its_k_is_to_be_found():
    vertices, faces = grid(8)
    over = CGCProblem(vertices, faces, targets=3.2).with_supports("corners")
    said = [text for text in check(over) if "convex plan" in text]
    assert said == beyond_convex_plans(over) and not said[0].fatal
    assert not any("convex plan" in text for text in check(over.with_goals([Rise(0.3), Unknown()])))
    # A rim that is held all round is refused, and not warned of besides.
    held = check(over.with_supports("boundary").with_targets(9.0))
    assert any(text.fatal for text in held) and not any("convex plan" in text for text in held)
