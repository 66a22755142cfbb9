"""Surfaces far from their drawings: triangles are laid out evenly before the surface is judged."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import Rise
from compas_cgc import solve
from compas_cgc.discrete.corners import corner_angles
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.solvers.evened import evened
from compas_cgc.solvers.evened import taut

from ..support.tiers import push_only
from ..system.fairness_study import mesh


def half_sphere(layout="irregular", count=300, seed=3):
    """A unit half sphere whose triangles are even on it, and stand upright at the rim."""
    t = 2 * np.pi * np.arange(720) / 720
    V, F = mesh([np.column_stack([np.cos(t), np.sin(t)])], layout, count, np.random.default_rng(seed))
    r = np.hypot(*V[:, :2].T)
    angle = 0.5 * np.pi * r / r.max()
    V = np.column_stack([V[:, :2] / np.maximum(r, 1e-300)[:, None] * np.sin(angle)[:, None], np.cos(angle)])
    return CGCProblem(V, F).with_supports("boundary")


@pytest.mark.parametrize("K", push_only([0.9, 0.5, 0.1, 0.01], 0.5))
def test_a_half_sphere_becomes_the_cap_that_is_asked_for(K):
    problem = half_sphere().with_targets(K)
    result = solve(problem)
    assert result.verdict.fair, result.message
    radius = K**-0.5
    centre = [0.0, 0.0, -np.sqrt(radius**2 - 1.0)]
    assert np.linalg.norm(result.vertices - centre, axis=1) == pytest.approx(radius, abs=1e-3)
    rim = problem.vertices[:, 2] < 1e-9
    assert (result.vertices[rim] == problem.vertices[rim]).all() and result.vertices[:, 2].max() > 0.0
    again = solve(result, targets=0.9 * K)
    assert again.verdict.fair, "and a slider goes on from there"


@pytest.mark.parametrize("K", push_only([0.9, 0.5, 0.2], 0.5))
def test_the_larger_cap_over_the_rim_of_a_half_sphere_is_a_branch(K):
    """Two caps of a sphere of radius R go through a circle; both bend with the energy 2 K A, the area A = 2 pi R h."""
    result = solve(half_sphere().with_targets(K))
    radius, caps = K**-0.5, result.branches
    assert [cap.fair for cap in caps] == [True, True] and (caps[0].vertices == result.vertices).all()
    for cap, side in zip(caps, (-1.0, 1.0)):
        away = side * np.sqrt(radius**2 - 1.0)
        assert np.linalg.norm(cap.vertices - [0.0, 0.0, away], axis=1) == pytest.approx(radius, rel=0.05)
        assert cap.energy == pytest.approx(4.0 * np.pi * (radius + away) / radius, rel=0.08)


def test_a_drawing_that_does_not_stand_upright_on_its_rim_leads_to_one_surface():
    drawn = half_sphere()
    assert solve(drawn.with_vertices(drawn.vertices * [1.0, 1.0, 0.5]).with_targets(0.5)).branches == ()


def test_triangles_of_a_half_sphere_laid_out_over_its_plan_are_similar():
    """The harmonic map of a half sphere to the disk is the stereographic projection, which is conformal."""
    problem = half_sphere("regular")
    flat = problem.vertices * [1.0, 1.0, 0.0]
    even = evened(problem, flat)
    r, rho = np.hypot(*problem.vertices[:, :2].T), np.hypot(*even[:, :2].T)
    assert rho == pytest.approx(r / (1.0 + problem.vertices[:, 2]), abs=0.01) and np.abs(even[:, 2]).max() == 0.0
    assert corner_angles(flat, problem.faces).min() < np.radians(5) < np.radians(25) < corner_angles(even, problem.faces).min()


@pytest.mark.parametrize("K", push_only([0.5, 0.1, 0.01], 0.5))
@pytest.mark.parametrize("layout", push_only([("irregular", 600, 4), ("irregular", 300, 7), ("delaunay", 900, 5)], ("irregular", 600, 4)))
def test_needles_in_plan_hide_no_cap(layout, K):
    """Over their plan triangles have angles down to a fraction of a degree, in which Newton's method from the drawing gets stuck."""
    drawn = half_sphere(*layout)
    assert np.degrees(corner_angles(drawn.vertices * [1.0, 1.0, 0.0], drawn.faces).min()) < 2.0
    result = solve(drawn.with_targets(K))
    assert result.verdict.fair, result.message
    assert np.linalg.norm(result.vertices + [0.0, 0.0, np.sqrt(1.0 / K - 1.0)], axis=1) == pytest.approx(K**-0.5, abs=1e-3)


@pytest.mark.parametrize("count", push_only([4, 6], 4))
def test_the_shape_of_a_half_sphere_hides_no_cap_on_points_of_its_rim(count):
    """The rim is free between the points, and stays over its circle: the crown is within 2 % of that over a flat disk."""
    drawn = half_sphere()
    rim = np.flatnonzero(drawn.roles == FIXED)
    angle = np.arctan2(drawn.vertices[rim, 1], drawn.vertices[rim, 0])
    points = rim[[np.argmin(np.abs(np.angle(np.exp(1j * (angle - 2.0 * np.pi * k / count))))) for k in range(count)]]
    bare = CGCProblem(drawn.vertices, drawn.faces).with_supports(points.tolist()).with_targets(0.1)
    results = [solve(own) for own in (bare, bare.with_vertices(taut(drawn)))]
    assert [result.verdict.fair for result in results] == [True, True], results[0].message
    crowns = [float(np.ptp(result.vertices[:, 2])) for result in results]
    assert crowns[0] == pytest.approx(crowns[1], rel=0.02)


def test_a_rise_of_a_half_sphere_is_that_of_a_lower_cap():
    result = solve(half_sphere("irregular", 600, 4), goals=[Rise(0.3)], unknown="all", targets=0.5)
    assert result.verdict.fair, result.message
    assert result.problem.targets[result.problem.asked] == pytest.approx((2 * 0.3 / (1 + 0.3**2)) ** 2, rel=5e-3)


def test_a_flat_drawing_is_taut():
    drawn = half_sphere()
    flat = drawn.with_vertices(drawn.vertices * [1.0, 1.0, 0.0])
    assert taut(flat) == pytest.approx(flat.vertices, abs=1e-12)


def test_triangles_that_would_not_gain_stay():
    problem = half_sphere("regular")
    even = evened(problem, problem.vertices * [1.0, 1.0, 0.0])
    assert evened(problem.with_vertices(even), even) is None
