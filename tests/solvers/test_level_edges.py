"""Level edges that end at supports are as high as these: there is nothing left to find along them."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Level
from compas_cgc import ProblemError
from compas_cgc import Rise
from compas_cgc import solve
from compas_cgc.model.goals.binding import with_level_edges_held


def roof(n=16, supports="corners", K=0.003, creased=False):
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=n)
    mesh.set_supports(supports)
    if creased:
        mesh.set_creases([[n // 2 * (n + 1) + i for i in range(n + 1)]])
    mesh.set_target(K)
    return mesh


@pytest.mark.parametrize("goals", [[], [Rise(3.0)]])
def test_they_are_held_edges_on_every_mesh(goals):
    crowns = []
    for n in (15, 16, 24):
        unknown = "all" if goals else ()
        level = solve(roof(n), goals=[Level(), *goals], unknown=unknown)
        held = solve(roof(n, "boundary"), goals=goals, unknown=unknown)
        assert level.verdict.fair and np.array_equal(level.vertices, held.vertices), level.message
        K = level.problem.region_targets()[0]
        assert np.nanmax(np.abs(level.curvature - K)) < 1e-9 * K, "read as it was solved"
        assert level.problem.roles.tolist() == roof(n).to_problem().roles.tolist(), "the corners alone are supports"
        crowns.append(level.vertices[:, 2].max())
    assert np.ptp(crowns) < 0.01 * crowns[0]


def test_they_stay_level_across_the_end_of_a_crease():
    result = solve(roof(creased=True), goals=[Level()])
    rim = np.unique(np.concatenate([np.asarray(loop) for loop in result.mesh.vertices_on_boundaries()]))
    assert result.verdict.fair and np.ptp(result.vertices[rim, 2]) < 1e-12


def test_a_saddle_within_level_edges_is_told_to_be_none():
    result = solve(roof(K=-0.003), goals=[Level()])
    assert (
        not result.converged and "no surface has K < 0 within this edge, because the whole edge is supported in a plane" in result.message
    )


def test_supports_of_two_heights_on_one_level_edge_are_refused():
    mesh = roof()
    mesh.vertex_attribute(next(iter(mesh.vertices())), "z", 1.0)
    with pytest.raises(ProblemError, match="level edge"):
        solve(mesh, goals=[Level()])


def test_without_supports_at_their_ends_nothing_is_held():
    problem = roof().to_problem().with_goals([Level()])
    assert with_level_edges_held(problem) is not problem
    free = problem.with_supports([40])
    assert with_level_edges_held(free) is free
