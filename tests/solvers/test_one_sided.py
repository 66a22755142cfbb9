"""Which columns keep a surface of K > 0 from bulging to one side, found before any surface is."""

from __future__ import annotations

import re

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.discrete import angle_defects
from compas_cgc.discrete.fit_operators import second_derivatives
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.one_sided import one_sided

from ..support.shapes import grid

K = 0.004


def ell(places, heights, n=16, size=12.0) -> CGCProblem:
    """An L of two arms half as wide as long, on columns."""
    vertices, faces = grid(n, size)
    centres = vertices[faces].mean(axis=1)
    faces = faces[(centres[:, :2] < size / 2).any(axis=1)]
    used = np.unique(faces)
    number = np.full(len(vertices), -1)
    number[used] = np.arange(len(used))
    vertices, faces = vertices[used], number[faces]
    columns = [int(np.argmin(np.hypot(*(vertices[:, :2] - place).T))) for place in places]
    vertices[columns, 2] = heights
    return CGCProblem(vertices, faces, targets=K).with_supports(columns)


CORNERS = [(0, 0), (12, 0), (12, 6), (6, 12), (0, 12)]
MIDDLES = [(9, 6), (6, 9)]


def cap(places, radius=K**-0.5):
    """Heights of the sphere of that curvature over places, its top at 0."""
    return [float(np.sqrt(radius**2 - (x - 4) ** 2 - (y - 4) ** 2) - radius) for x, y in places]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_columns_that_stand_under_a_sphere_are_in_nobodys_way(side):
    places = CORNERS + MIDDLES
    problem = ell(places, side * np.array(cap(places)))
    found = one_sided(problem, np.flatnonzero(problem.roles == 1)[-2:].tolist(), 2)
    assert found is not None and found.columns == []
    assert angle_defects(np.column_stack([problem.vertices[:, :2], found.heights]), problem.faces)[problem.asked].sum() > 0.0


@pytest.mark.parametrize("which", [0, 1])
def test_the_column_that_was_lowered_is_the_one_that_is_named(which):
    places = CORNERS + MIDDLES
    heights = cap(places)
    heights[5 + which] -= 2.5
    problem = ell(places, heights)
    middles = [int(np.argmin(np.hypot(*(problem.vertices[:, :2] - place).T))) for place in MIDDLES]
    found = one_sided(problem, middles, 2)
    assert found is not None and found.columns == [middles[which]]
    assert abs(found.heights[middles[which]] - heights[5 + which] - 2.5) < 0.8
    turned = problem.vertices[:, [1, 0, 2]] * [-1.0, 1.0, 1.0] + [30.0, -7.0, 2.0]
    again = one_sided(problem.with_vertices(turned), middles, 2)
    assert again is not None and again.columns == found.columns
    assert np.abs(again.heights - 2.0 - found.heights).max() < 1e-6


def test_second_derivatives_of_cubics_are_exact():
    vertices, faces = grid(8, 4.0)
    rng = np.random.default_rng(3)
    interior = np.flatnonzero(((vertices[:, :2] > 0.6) & (vertices[:, :2] < 3.4)).all(axis=1))
    vertices[interior, :2] += rng.uniform(-0.1, 0.1, (len(interior), 2))
    x, y = vertices[:, 0], vertices[:, 1]
    found = (second_derivatives(vertices, faces, interior, np.ones(len(x), bool)) @ (x**3 - 2 * x * y**2 + y * x)).reshape(-1, 3)
    expected = np.column_stack([6 * x, 1 - 4 * y, -4 * x])[interior]
    assert np.abs(found - expected).max() < 1e-9


@pytest.mark.nightly
def test_level_columns_along_the_arms_of_an_l_are_named_with_heights_that_are_fair():
    problem = ell(CORNERS + MIDDLES, np.zeros(7))
    result = solve(problem)
    assert not result.verdict.fair
    said = re.findall(r"vertex (\d+), stands \S+ under where a surface of K = 0.004 runs without it, at (\d+\.\d+)", result.message)
    assert len(said) == 2
    raised = problem.vertices.copy()
    for vertex, height in said:
        raised[int(vertex), 2] = float(height)
    assert solve(problem.with_vertices(raised)).verdict.fair, "what the sentence says can be had"
