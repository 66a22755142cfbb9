"""Surfaces of least energy are minima: symmetric stationary ones are left, and rounding decides nothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from compas_cgc import CGCMesh
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.polish.negative_curvature import negative_curvature
from compas_cgc.solvers.polish.optimiser import _more_convex
from compas_cgc.solvers.polish.polisher import polish

from ...support.shapes import alternating
from ...support.shapes import grid


def test_a_symmetric_surface_that_is_no_minimum_is_left_for_one_that_is():
    """Squares with alternating diagonals: their symmetric saddle has .02 % more energy, and took 47 to 89 steps to reach or to leave."""
    n = 16
    problem = CGCProblem(grid(n, 15.0)[0], alternating(n)).with_supports("corners").with_targets(-0.01)
    found = polish(problem)
    assert found.status == "converged" and found.iterations < 30
    x, y = problem.vertices[:, :2].T / 15.0
    for push in (np.sin(3.0 * x + y), np.cos(2.0 * x - 4.0 * y)):
        start = found.vertices + 0.02 * push[:, None] * [0.0, 0.0, 1.0] * problem.movable[:, None]
        again = polish(problem, start=start)
        assert again.branches[0].energy == pytest.approx(found.branches[0].energy, rel=1e-6)


def test_from_beside_a_symmetric_surface_the_search_goes_downhill():
    """Nine regions over four corners: along the direction of least curvature the energy first rose, and 100 steps were not enough."""
    n = 15
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=n)
    mesh.set_supports("corners")
    lines = [[n // 3 * k * (n + 1) + i for i in range(n + 1)] for k in (1, 2)]
    mesh.set_creases(lines + [[i * (n + 1) + n // 3 * k for i in range(n + 1)] for k in (1, 2)])
    mesh.set_target(0.005)
    found = polish(mesh.to_problem())
    assert found.status == "converged" and found.verdict.fair and found.iterations < 40


def lifted_square(vertices, faces, twist):
    """Return a sheet, K = 0, on the corners of a square of half width 1, two of which are lifted by the twist, and two lowered."""
    x, y = vertices[:, :2].T
    return CGCProblem(np.column_stack([x, y, twist * x * y]), faces).with_supports("corners").with_targets(0.0)


@pytest.mark.parametrize("mesh", ["diagonals", "alternating", "random"])
def test_a_sheet_over_lifted_corners_bends_along_one_diagonal_or_the_other(mesh):
    """Both corners of a diagonal lie as high, and the sheet is a cylinder about it, z = +-t (1 - (x -+ y)² / 2), to leading order."""
    V, F = grid(17, 2.0)
    V = V - [1.0, 1.0, 0.0]
    F = alternating(17) if mesh == "alternating" else F
    if mesh == "random":
        V[:, :2] += np.random.default_rng(4).uniform(-0.02, 0.02, (len(V), 2)) * (np.abs(V[:, :2]).max(axis=1) < 1.0)[:, None]
    twist = 0.01
    found = polish(lifted_square(V, F, twist))
    assert found.status == "converged" and found.verdict.fair and found.max_error < 1e-10
    assert len(found.branches) == 2
    x, y = V[:, :2].T
    about = {1.0: twist * (1.0 - (x - y) ** 2 / 2.0), -1.0: -twist * (1.0 - (x + y) ** 2 / 2.0)}
    assert {min(about, key=lambda side: np.abs(branch.vertices[:, 2] - about[side]).max()) for branch in found.branches} == {1.0, -1.0}
    for branch in found.branches:
        assert min(np.abs(branch.vertices[:, 2] - z).max() for z in about.values()) < 0.05 * twist
        assert branch.energy == pytest.approx(4.0 * (2.0 * twist) ** 2, rel=0.05)


def test_k_zero_is_met_to_rounding_in_a_few_steps_from_a_flat_spot():
    """Derivatives of K vanish where a sheet is flat: with a constant regularisation it took 55 steps, and 1e-11 were left."""
    V, F = grid(13, 2.0)
    problem = lifted_square(V - [1.0, 1.0, 0.0], F, 0.1)
    found = polish(problem, start=problem.vertices)
    assert found.status == "converged" and found.iterations <= 30 and found.max_error < 1e-14


def test_second_derivatives_that_are_not_convex_are_halved_then_left_out_and_then_shifted():
    taken = [(1.0, 0.0)]
    while taken[-1][1] < 1e-3:
        taken.append(_more_convex(*taken[-1]))
    shares, shifts = zip(*taken)
    assert shares == (1.0, 0.5, 0.25, 0.125, 0.0625, 0.0, 0.0, 0.0) and shifts == (0.0,) * 6 + (1e-4, 1e-3)


def test_the_direction_of_negative_curvature_obeys_the_equations():
    """W = diag(3, -2, -1, 5) on x0 + x1 + x2 + x3 = 0, made positive by A = 4: the least second derivative is that of the projection."""
    W, ones = np.diag([3.0, -2.0, -1.0, 5.0]), np.ones((4, 1))
    added = 4.0 * np.eye(4)
    saddle = np.block([[W + added, ones], [ones.T, np.zeros((1, 1))]])

    def responses(load):
        return np.append(np.linalg.solve(saddle, load)[:4], 0.0)

    whole = [sparse.csr_matrix(np.pad(own, ((0, 1), (0, 1)))) for own in (W, added)]
    places = np.arange(12.0).reshape(4, 3) / 7.0
    direction, curvature = negative_curvature(responses, *whole, places)
    basis = np.linalg.svd(ones.T)[2][1:]
    least = np.linalg.eigvalsh(basis @ W @ basis.T)[0]
    assert abs(direction.sum()) < 1e-12 and np.abs(direction).max() == pytest.approx(1.0)
    assert curvature / (direction @ direction) == pytest.approx(least, rel=0.05)
    # Without a negative one there is none.
    assert negative_curvature(responses, whole[1], whole[0] * 0.0, places) is None
