"""Held edges that turn inwards are named where K > 0 cannot pass them, and others are not."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import edge_faces
from compas_cgc.model.inward_edges import dividing_creases
from compas_cgc.model.inward_edges import inward_edges
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL

from ..support.shapes import grid


def plan(cut: str, heights=lambda x, y: 0 * x, held=lambda x, y: x == x, target: float = 0.3, n: int = 12) -> CGCProblem:
    """A square of side 4 without a quarter or a hole in its middle, held along parts of its edge at some height."""
    vertices, faces = grid(n, 4.0)
    x, y = vertices[faces].mean(axis=1)[:, :2].T - 2.0
    gone = {"none": x > 9, "corner": (x > 0) & (y > 0), "hole": (abs(x) < 1) & (abs(y) < 1)}[cut]
    used, faces = np.unique(faces[~gone], return_inverse=True)
    vertices, faces = vertices[used] - [2.0, 2.0, 0.0], faces.reshape(-1, 3)
    rim = boundary_vertices(vertices, faces)
    roles = np.where(rim, np.where(held(*vertices[:, :2].T), FIXED, FREE), INTERNAL)
    vertices[:, 2] = np.where(roles == FIXED, heights(*vertices[:, :2].T), 0.0)
    return CGCProblem(vertices, faces, roles, target)


@pytest.mark.parametrize("cut, words", [("none", None), ("corner", "of 90 degrees at vertex"), ("hole", "of 90 degrees at vertex")])
def test_a_level_edge_is_named_where_it_turns_inwards(cut, words):
    said = inward_edges(plan(cut))
    assert said == [] if words is None else len(said) == 1 and words in said[0] and "on a straight line with the supported edges" in said[0]
    assert inward_edges(plan(cut, target=-0.3)) == []
    turned = plan(cut)
    assert inward_edges(turned) == inward_edges(CGCProblem(turned.vertices, turned.faces[:, ::-1], turned.roles, 0.3))


def test_the_remedy_is_a_crease_from_the_corner_straight_on_to_the_boundary():
    (said,) = inward_edges(plan("corner"))
    (remedy,) = said.remedies
    ((start, end),) = remedy.value
    assert remedy.field == "creases" and start == [0.0, 0.0] and sorted(end) == [-2.0, 0.0]
    (around,) = inward_edges(plan("hole"))
    assert len(around.remedies[0].value) == 4
    # A corner with a free side is divided too, one between free sides is not.
    half = plan("corner", held=lambda x, y: (x < 1e-9) | (y < -1.9))
    assert [own.field for own in dividing_creases(half)] == ["creases"]
    assert dividing_creases(plan("corner", held=lambda x, y: (x < -1.9) | (y < -1.9))) == []
    assert dividing_creases(plan("corner", target=-0.3)) == []


def test_the_corner_is_named_by_its_place_in_any_unit():
    millimetres = plan("corner")
    (said,) = inward_edges(CGCProblem(1000 * millimetres.vertices, millimetres.faces, millimetres.roles, 3e-7))
    assert "(0, 0)" in said and "(-2000, 2000)" in said


def test_a_corner_whose_edges_are_free_may_go_where_it_likes():
    assert inward_edges(plan("corner", held=lambda x, y: (x < -1.9) | (y < -1.9))) == []


def test_a_dome_holds_at_an_inward_corner_and_a_wave_around_a_hole_does_not():
    assert inward_edges(plan("corner", heights=lambda x, y: -0.1 * (x**2 + y**2))) == []
    assert inward_edges(plan("hole", heights=lambda x, y: -0.1 * (x**2 + y**2))) == []
    (said,) = inward_edges(plan("hole", heights=lambda x, y: 0.1 * x * (x**2 + y**2)))
    assert "(a dome)" in said and "(a bowl)" in said


def test_a_corner_between_straight_parts_is_named_where_creases_lie_across():
    problem = plan("corner", n=16)
    x, y = problem.vertices[problem.faces].mean(axis=1)[:, :2].T
    edges, side = edge_faces(problem.faces), np.maximum(abs(x), abs(y)) < 1.0
    inner = edges[edges[:, 3] >= 0]
    around = inner[side[inner[:, 2]] != side[inner[:, 3]], :2]
    creased = problem.with_creases(around.tolist())
    (said,) = inward_edges(creased)
    assert "(0, 0) between straight parts" in said
    parted = (abs(x) < 1.0) & (abs(y) < 1.0) & (x < y)  # and a crease leads to the corner from within
    side = side.astype(int) + parted
    led = problem.with_creases(inner[side[inner[:, 2]] != side[inner[:, 3]], :2].tolist())
    assert inward_edges(led) == []
    bent = plan("corner", heights=lambda x, y: -0.1 * (x**2 + y**2), n=16).with_creases(around.tolist())
    assert inward_edges(bent) == []


def test_a_rough_solve_names_the_corner():
    problem = plan("corner", target=0.1, n=10)
    result = solve(problem)
    assert not (result.converged and result.verdict.fair)
    assert inward_edges(problem)[0] in result.message
