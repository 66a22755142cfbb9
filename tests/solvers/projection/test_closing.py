"""The last digits of K come from moves across the surface, and a looser tolerance leaves them out."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import ProjectionSettings
from compas_cgc import Rise
from compas_cgc import solve
from compas_cgc.discrete import vertex_normals
from compas_cgc.linalg import SingularMatrixError
from compas_cgc.solvers.projection.closing import Closing
from compas_cgc.solvers.projection.closing import along
from compas_cgc.solvers.projection.closing import is_bound_by_k_alone
from compas_cgc.solvers.projection.gauss_newton import descend
from compas_cgc.solvers.projection.optimality import optimality
from compas_cgc.solvers.projection.projector import Projector
from compas_cgc.solvers.projection.strategies import ways_from_near
from compas_cgc.solvers.projection.system import System

WIDTH = 6.0


def roof(K, supports="corners"):
    mesh = CGCMesh.from_meshgrid(dx=WIDTH, nx=16)
    mesh.set_supports(supports)
    mesh.set_target(K)
    return mesh


def solved(K, supports, off):
    """Return the system, the equations and a shape beside the solution, off by a part of the width."""
    problem = roof(K, supports).to_problem()
    projector = Projector(problem)
    local = projector.posed(problem.targets, projector.solve().vertices)
    system = System(local, ProjectionSettings())
    equations = system.equations(local.targets)
    vertices = local.vertices.copy()
    vertices[system.columns] += off * system.size * np.random.default_rng(3).uniform(-1.0, 1.0, (len(system.columns), 3))
    return system, equations, system.at(vertices, equations)


@pytest.mark.parametrize("K, supports", [(0.02, "corners"), (0.02, "boundary"), (-0.02, "corners")])
def test_moves_across_bring_k_to_rounding_in_three_steps_of_next_to_no_length(K, supports):
    system, equations, near = solved(K, supports, 1e-7)
    assert is_bound_by_k_alone(system, equations)
    ways = list(descend(Closing(system, near.vertices), equations, near))[:3]
    assert system.missing(system.at(ways[-1].vertices, equations), equations) < 1e-11
    moves = ways[-1].vertices - near.vertices
    assert np.abs(moves).max() < 1e-4 * system.size
    normals = vertex_normals(near.vertices, system.faces)
    across = np.einsum("ij,ij->i", moves, normals)
    assert np.abs(moves - across[:, None] * normals).max() < 1e-15


def test_derivatives_across_are_those_along_the_normals():
    system, equations, near = solved(0.02, "corners", 1e-3)
    normals = vertex_normals(near.vertices, system.faces)[system.columns]
    J = system.jacobian(near, equations)
    heights = np.random.default_rng(5).standard_normal(len(normals))
    np.testing.assert_allclose(along(normals, J) @ heights, J @ (heights[:, None] * normals).ravel(), atol=1e-12)


def test_from_farther_away_other_moves_go_on_where_those_across_have_to_be_shortened():
    system, equations, near = solved(0.02, "corners", 1e-2)
    *_, last = ways_from_near(system, equations, near, ProjectionSettings(measure="defect"))
    assert system.missing(system.at(last.vertices, equations), equations) < 1e-11


def test_where_more_than_k_is_asked_for_nothing_is_closed_across():
    projector = Projector(roof(0.02).to_problem().with_goals([Rise(0.5)]))
    system = projector._system
    assert not is_bound_by_k_alone(system, system.equations(projector.posed().targets))


def test_a_tolerance_says_how_far_a_surface_comes_to_rest():
    first = solve(roof(0.02), method="projection")
    other = first.problem.with_targets(0.0206)
    exact, near = (solve(other, settings=ProjectionSettings(tolerance=tolerance)) for tolerance in (1e-12, 1e-5))
    assert near.status == exact.status == "converged" and near.verdict.fair
    assert near.iterations < exact.iterations
    assert 0.0 < np.abs(near.vertices - exact.vertices).max() < 1e-5 * WIDTH
    assert near.max_error <= 1e-5 * 0.0206


def test_a_shape_that_is_lost_is_no_reason_to_crash():
    """SuperLU may leave its memory where a matrix is not finite."""
    system, equations, point = solved(0.02, "corners", 0.0)
    with pytest.raises(SingularMatrixError, match="not finite"):
        optimality(system, point, equations, np.full(len(system.leading), np.nan))
