"""Held edges that step are named by the place; those that climb are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import edge_faces
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.model.stepped_edges import stepped_edges

from ..support.shapes import grid


def square(height, target: float = -0.05, scale: float = 1.0) -> CGCProblem:
    """A square of side 4, held all round at heights that follow its sides."""
    vertices, faces = grid(8, 4.0)
    rim = boundary_vertices(vertices, faces)
    vertices[rim, 2] = height(*vertices[rim, :2].T)
    return CGCProblem(scale * vertices, faces, np.where(rim, FIXED, INTERNAL), target / scale**2)


def stepped(x, y):
    """The side y = 0 level with its corner, half a metre under the side x = 0."""
    return np.where(y == 0.0, 0.0, 0.5)


@pytest.mark.parametrize("target", [-0.05, 0.05])
@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_a_step_at_a_corner_is_named_with_its_height(target, scale):
    problem = square(stepped, target, scale)
    (said,) = stepped_edges(problem)
    assert f"a step of {0.5 * scale:.3g} in height" in said and "in planes 90 degrees apart" in said
    turned = CGCProblem(problem.vertices, problem.faces[:, ::-1], problem.roles, target / scale**2)
    assert len(stepped_edges(turned)) == 1


@pytest.mark.parametrize(
    "height",
    [
        lambda x, y: 0.0 * x,
        lambda x, y: 0.5 * (x + y),
        lambda x, y: np.minimum(0.5, 0.25 * y),
        lambda x, y: 0.3 * np.cos(np.pi * x / 2),
        lambda x, y: np.maximum(0.0, 1.0 - np.abs(x - 2.0)),
    ],
    ids=["level", "tilted", "climbing", "waves", "gable"],
)
def test_edges_that_climb_over_several_edges_are_not(height):
    assert stepped_edges(square(height)) == []


def test_a_step_whose_ends_are_free_or_both_on_creases_is_not():
    problem = square(stepped)
    x, y = problem.vertices[:, :2].T
    one, other = ((x == at) & (y <= 0.5) for at in (0.0, 4.0))
    assert len(stepped_edges(problem)) == 1
    freed = replace(problem, roles=np.where(other, FREE, problem.roles))
    (said,) = stepped_edges(freed)
    assert f"vertex {np.flatnonzero(one)[1]} " in said
    edges = edge_faces(problem.faces)
    led = edges[(edges[:, 3] >= 0) & one[edges[:, :2]].any(axis=1), :2]
    assert len(stepped_edges(freed.with_creases(led[:1].tolist()))) == 1
    assert stepped_edges(freed.with_creases(led.tolist())) == []


def test_a_rough_solve_names_the_step():
    problem = square(stepped)
    result = solve(problem)
    assert not (result.converged and result.verdict.fair)
    assert stepped_edges(problem)[0] in result.message
