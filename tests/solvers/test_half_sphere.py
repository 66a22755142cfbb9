"""What is said where K is far too large for the plan, far too small for a rise, or the surface hardly held."""

from __future__ import annotations

import re

import pytest

from compas_cgc import CGCMesh
from compas_cgc import Rise
from compas_cgc import solve


def plan(K, supports="corners"):
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=8)
    mesh.set_supports(supports)
    mesh.set_target(K)
    return mesh


@pytest.mark.parametrize("method", ["flow", "newton", "projection"])
def test_a_target_rounder_than_a_half_sphere_is_held_against_that(method):
    message = solve(plan(5.0), method=method).message
    assert "K̄ = 5 is that of a sphere of radius 0.447, and a half sphere over the width of 10 has K = 0.04" in message
    assert "mu0" not in message


def test_what_the_supports_carry_is_not_held_against_it():
    assert "sphere" not in solve(plan(0.04)).message


@pytest.mark.nightly
def test_a_rise_that_K_does_not_have_is_told_with_the_K_that_has():
    """The K that is said is that which is found where K is left open, nearly."""
    message = solve(plan(1e-8, "boundary"), goals=[Rise(2.0)]).message
    told = float(re.search(r"K = ([0-9.e-]+) meets this goal", message).group(1))
    left_open = solve(plan(0.01, "boundary"), goals=[Rise(2.0)], unknown="all")
    assert left_open.converged
    assert told == pytest.approx(left_open.problem.targets[left_open.problem.asked][0], rel=0.4)
    assert "not even" not in message


def test_a_cap_of_the_rise_is_told_where_edges_are_free():
    """Over eight points on its edges, through which no cylinder passes that rises as much."""
    points = plan(1e-8, [0, 4, 8, 36, 44, 72, 76, 80])
    assert "a cap that rises 2 over the width of 10 has K = 0.019" in solve(points, goals=[Rise(2.0)]).message


@pytest.mark.parametrize("supports, loose", [([0], True), ([0, 80], True), ([0, 4, 8], True), ([0, 40, 80], True), ([0, 8, 80], False)])
def test_what_hangs_on_one_line_is_said_to_turn(supports, loose):
    assert (f"supported at {len(supports)} of 81 vertices only, about which it can rotate" in solve(plan(0.01, supports)).message) == loose
