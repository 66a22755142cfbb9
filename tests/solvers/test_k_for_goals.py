"""A goal in the place of a target: K of one region is found for it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from compas_cgc import Above
from compas_cgc import CGCMesh
from compas_cgc import Height
from compas_cgc import ProblemError
from compas_cgc import Rise
from compas_cgc import Volume
from compas_cgc import solve
from compas_cgc.model.problem import CGCProblem

from ..system.fairness_study import plan_mesh


def plan(supports):
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=12)
    mesh.set_supports(supports)
    return mesh


@pytest.mark.parametrize("supports", ["boundary", "corners"])
def test_a_rise_is_enough(supports):
    result = solve(plan(supports), goals=[Rise(2.5)])
    assert result.converged and result.verdict.fair and abs(np.ptp(result.vertices[:, 2]) - 2.5) <= 1e-9
    named = solve(plan(supports), goals=[Rise(2.5)], unknown="all")
    assert np.array_equal(result.vertices, named.vertices) and result.problem.region_targets() == named.problem.region_targets()


@pytest.mark.parametrize("goal", [Height("crown", 1.5), Volume(100.0)])
def test_so_are_other_goals_of_the_whole(goal):
    assert solve(plan("boundary"), goals=[goal]).problem.region_targets()[0] > 0.0


def test_a_target_that_is_there_stays_and_bounds_fix_no_curvature():
    mesh = plan("boundary")
    with pytest.raises(ProblemError, match="no target curvature is set"):
        solve(mesh, goals=[Above(0.0)])
    mesh.set_creases([[13 * i + 6 for i in range(13)]])
    with pytest.raises(ProblemError, match="no target curvature is set"):
        solve(mesh, goals=[Rise(2.5)])
    corners = plan("corners")
    corners.set_target(0.004)
    result = solve(corners, goals=[Rise(2.5)])
    assert result.problem.region_targets()[0] == 0.004


def test_over_a_rim_the_k_that_is_found_is_that_of_the_surface_which_meets_the_goal():
    """On these triangles the smooth measure follows no shape whose K is sought, and the K of angle defects is 4 % off."""
    _, vertices, faces, _ = plan_mesh(np.random.default_rng(70013), ("annulus", "square", "disc", "blob", "ellipse", "L"), (150, 250))
    problem = CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.27)
    known = solve(problem)
    assert known.measure == "smooth" and known.verdict.fair
    found = solve(problem.with_targets(0.19), goals=[Rise(float(known.vertices[:, 2].max()))], unknown="all")
    assert found.converged and found.problem.region_targets()[0] == pytest.approx(0.27, rel=1e-6)
    assert found.vertices == pytest.approx(known.vertices, abs=1e-6)


@cache
def canopy():
    drawn = plan("corners")
    drawn.set_target(0.03)
    return drawn, solve(drawn, goals=[Rise(2.0)], unknown="all")


@pytest.mark.parametrize("again", [False, True], ids=["at once", "from the result"])
def test_the_exact_measure_takes_the_k_that_was_found(again):
    drawn, found = canopy()
    start, more = (found.mesh, {}) if again else (drawn, {"goals": [Rise(2.0)], "unknown": "all"})
    exact = solve(start, settings={"measure": "exact"}, **more)
    K = found.problem.region_targets()[0]
    assert exact.converged and exact.verdict.fair and exact.measure == "exact" and "solved for" in exact.summary
    assert exact.problem.region_targets()[0] == pytest.approx(K, rel=5e-3) and K < 0.01
    assert exact.curvature[exact.problem.asked] == pytest.approx(exact.problem.region_targets()[0], rel=1e-9)
    assert np.ptp(exact.vertices[:, 2]) == pytest.approx(2.0, abs=1e-9)
    assert np.abs(exact.vertices - found.vertices).max() < 0.02


@pytest.mark.parametrize("n", [2, 3])
def test_a_rise_is_met_on_a_mesh_too_coarse_to_estimate_its_layout_error(n):
    mesh = CGCMesh.from_meshgrid(dx=4.0, nx=n)
    mesh.set_supports("boundary")
    mesh.set_target(0.02)
    result = solve(mesh, goals=[Rise(1.0)], unknown="all")
    assert result.converged and result.vertices[:, 2].max() == pytest.approx(1.0, abs=1e-9)


def test_regions_of_one_vertex_each_whose_unknown_K_meets_every_equation_end_with_a_result():
    mesh = CGCMesh.from_meshgrid(dx=16.0, nx=8, dy=4.0, ny=2)
    mesh.set_supports("boundary")
    mesh.set_creases([[6 * k + j for j in range(3)] for k in (1, 2, 3)])
    for region in range(4):
        mesh.set_target(-0.02, region=region)
    result = solve(mesh, method="projection", goals=[Rise(1.0)], unknown="all")
    assert result.status in ("converged", "infeasible", "stalled") and np.isfinite(result.vertices).all()
