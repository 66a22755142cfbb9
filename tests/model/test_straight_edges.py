"""Straight held edges twist a surface of K < 0 by the angle that Beltrami and Enneper name, or its corners are not smooth."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from compas_cgc import check
from compas_cgc import solve
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.model.straight_edges import twisted_edges

from ..support.shapes import grid


def three_sides(lift: float, K: float, n: int = 14) -> CGCProblem:
    """Return a hypar over the unit square, of which three straight sides are held, the middle one along x."""
    vertices, faces = grid(n, 1.0)
    x, y = vertices[:, 0].copy(), vertices[:, 1].copy()
    vertices[:, 2] = lift * x * y
    held, rim = (x == 0.0) | np.isclose(x, 1.0) | (y == 0.0), (x == 0.0) | np.isclose(x, 1.0) | (y == 0.0) | np.isclose(y, 1.0)
    roles = np.where(held, FIXED, np.where(rim, FREE, INTERNAL))
    return CGCProblem(vertices, faces, roles, K)


@pytest.mark.parametrize("lift", [0.4, 0.7, 1.0])
def test_the_k_that_fits_is_the_square_of_the_twist_per_length(lift):
    twist = np.arctan(lift)
    assert not twisted_edges(three_sides(lift, -(twist**2)))
    for factor in (0.3, 3.0):
        (said,) = twisted_edges(three_sides(lift, -factor * twist**2))
        assert float(re.search(r"or set K = (\S+) there", said)[1]) == pytest.approx(-(twist**2), rel=1e-2)
        assert f"by {np.degrees(np.sqrt(factor) * twist):.0f} degrees" in said and f"require {np.degrees(twist):.0f} degrees:" in said


def test_whole_turns_more_and_the_other_way_round_fit_too():
    for turns in (2.0 * np.pi - np.arctan(0.5), 2.0 * np.pi + np.arctan(0.5)):
        assert not twisted_edges(three_sides(0.5, -(turns**2)))


@pytest.mark.parametrize("size", [0.01, 1.0, 300.0])
def test_neither_units_nor_the_place_nor_the_side_matter(size):
    plain, turn = three_sides(0.5, -1.0), Rotation.from_euler("xyz", [0.4, 1.0, -2.0])
    moved = CGCProblem(size * (turn.apply(plain.vertices) + [3.0, -2.0, 1.0]), plain.faces, plain.roles, -1.0 / size**2)
    for problem in (moved, moved.flipped()):
        (said,) = twisted_edges(problem)
        assert "by 57 degrees" in said and "require 27 degrees:" in said


def test_nothing_is_said_of_edges_that_are_free_curved_or_not_asked_to_twist():
    plain = three_sides(0.5, -2.0)
    rim = plain.roles != INTERNAL
    x, y, _ = plain.vertices.T
    free = plain.roles.copy()
    free[(x == 0.0) & (y > 0.0)] = FREE
    curved = plain.vertices + np.column_stack([0.0 * x, -0.05 * np.sin(np.pi * x) * rim * (y == 0.0), 0.0 * x])
    assert twisted_edges(plain)
    assert not twisted_edges(CGCProblem(plain.vertices, plain.faces, free, -2.0))
    assert not twisted_edges(CGCProblem(curved, plain.faces, plain.roles, -2.0))
    assert not twisted_edges(plain.with_targets(0.0)) and not twisted_edges(plain.with_targets(2.0))


def test_an_inward_corner_turns_the_way_in_around():
    """Past it the edge that comes before lies behind the side that follows."""
    vertices, faces = grid(12, 1.0)
    x, y = vertices[:, 0].copy(), vertices[:, 1].copy()
    outside = (x > 0.5) & (y > 0.5)
    keep = ~outside[faces].any(axis=1) & ~((vertices[faces].mean(axis=1)[:, :2] > 0.5).all(axis=1))
    used, local = np.unique(faces[keep], return_inverse=True)
    V, F = vertices[used], local.reshape(-1, 3)
    x, y = V[:, :2].T
    notch = (np.isclose(x, 0.5) & (y > 0.49)) | (np.isclose(y, 0.5) & (x > 0.49)) | np.isclose(x, 1.0)
    rim = notch | (x == 0.0) | (y == 0.0) | np.isclose(y, 1.0)
    problem = CGCProblem(V, F, np.where(notch, FIXED, np.where(rim, FREE, INTERNAL)), -4.0)
    (said,) = twisted_edges(problem)
    assert "length 0.5" in said and "by 57 degrees" in said and "require 0 degrees:" in said


@pytest.mark.nightly
def test_it_is_said_before_a_solve_and_of_a_rough_surface_and_the_k_it_names_is_fair():
    rough = three_sides(0.6, -0.08)
    (said,) = [one for one in check(rough) if "twists by" in one]
    assert not said.fatal
    result = solve(rough)
    assert not result.verdict.fair and "twists by 16 degrees" in result.message
    K = float(re.search(r"or set K = (\S+) there", said)[1])
    assert solve(rough.with_targets(K)).verdict.fair
