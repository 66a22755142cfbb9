"""Surfaces of least energy are minima: symmetric stationary ones are left, and rounding decides nothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

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
