"""A looser tolerance leaves out the last digits of a surface."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import ProjectionSettings
from compas_cgc import solve
from compas_cgc.linalg import SingularMatrixError
from compas_cgc.solvers.projection.optimality import optimality
from compas_cgc.solvers.projection.projector import Projector
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
