"""Supports that no surface of K > 0 passes through are told beforehand, and others are not."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import check
from compas_cgc.discrete import boundary_vertices
from compas_cgc.model.bulging import two_sided_supports
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL

from ..support.shapes import grid

CORNERS = [(0, 0, 3), (8, 0, 3), (8, 8, 3), (0, 8, 3)]


def columns(*places, target=0.01, corner=False, creases=()):
    """A square of 8, or an L of which a quarter is missing, on columns at (x, y, z)."""
    vertices, faces = grid(8, 8.0)
    if corner:
        middle = vertices[faces].mean(axis=1)
        faces = faces[~((middle[:, 0] > 4) & (middle[:, 1] > 4))]
        used = np.unique(faces)
        vertices, faces = vertices[used], np.searchsorted(used, faces)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    for x, y, z in places:
        at = int(np.argmin(np.hypot(vertices[:, 0] - x, vertices[:, 1] - y)))
        vertices[at, 2], roles[at] = z, FIXED
    along = [np.flatnonzero(vertices[:, 0] == x).tolist() for x in creases]
    return CGCProblem(vertices, faces, roles, target, creases=along)


@pytest.mark.parametrize(
    "inner, words",
    [
        ([(4, 4, 4)], None),
        ([(4, 4, 2)], None),
        ([(2, 4, 4), (6, 4, 2)], "(a dome)"),
        ([(4, 4, 3)], "lies on the straight line or plane through the supports"),
    ],
)
def test_columns_within_a_square(inner, words):
    said = two_sided_supports(columns(*CORNERS, *inner))
    assert said == [] if words is None else len(said) == 1 and words in said[0]
    assert two_sided_supports(columns(*CORNERS, *inner, target=-0.01)) == [], "with K < 0 there is no such side"


def test_a_crease_through_them_lets_each_side_bulge_as_it_likes():
    places = (*CORNERS, (2, 4, 4), (6, 4, 2))
    assert two_sided_supports(columns(*places)) and not two_sided_supports(columns(*places, creases=[4.0]))


def test_a_free_edge_that_must_not_leave_its_line_is_one_of_the_lines():
    places = (*CORNERS, (4, 0, 4), (4, 8, 2))
    loose = columns(*places)
    assert not two_sided_supports(loose), "an edge may move off the line"
    (said,) = two_sided_supports(loose.with_goals([EdgeInPlan()]))
    assert "(a dome)" in said and "(a bowl)" in said
    level = columns(*CORNERS, (4, 0, 3)).with_goals([EdgeInPlan()])
    assert not two_sided_supports(level), "a straight edge is as a straight rim is: the surface may be singular there"


def test_columns_along_a_free_edge_over_its_line_are_named_and_walls_are_not():
    (said,) = two_sided_supports(columns(*CORNERS, (4, 0, 3)), over_lines=True)
    assert "its support at vertex 36 lies on the straight line" in said and "vertices 0 and 72" in said
    assert not two_sided_supports(columns(*CORNERS, (4, 0, 4)), over_lines=True)
    wall = [(x, 0, 3) for x in range(1, 8)]
    assert not two_sided_supports(columns(*CORNERS, *wall), over_lines=True)


@pytest.mark.parametrize("height, words", [(3, "vertex 30 lies on the straight line or plane"), (4, None)])
def test_columns_between_a_wall_and_others(height, words):
    """Columns as high as a wall behind them and the columns in front of them, and ones that are higher."""
    wall = [(0, y, 3) for y in range(9)]
    said = two_sided_supports(columns(*wall, (7, 2, 3), (7, 6, 3), (3, 3, height), (3, 5, height)))
    assert said == [] if words is None else len(said) == 1 and words in said[0]
    assert two_sided_supports(columns(*wall, (7, 2, 3), (7, 6, 3))) == []


def test_lines_through_a_court_are_none():
    """The way between the two ends of an L leads over its court, where there is no surface."""
    ends = columns((8, 0, 3), (0, 8, 3), (3, 3, 2), (0, 0, 3), corner=True)
    assert two_sided_supports(ends) == []
    assert two_sided_supports(columns((0, 0, 3), (8, 0, 3), (0, 4, 3), (2, 2, 4), (4, 1, 1), corner=True))


def test_check_says_so_and_refuses_nothing():
    said = [one for one in check(columns(*CORNERS, (4, 4, 3))) if "never straight" in one]
    assert len(said) == 1 and not said[0].fatal
