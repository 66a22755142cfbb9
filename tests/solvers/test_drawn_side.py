"""Roofs over a whole rim go to the side that a drawing says, and along their normals where it says none."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.solvers.drawn_side import is_drawn_below

WIDTH, K = 12.0, 0.003


def bowl(height):
    return lambda x, y: 16.0 * height * x * (WIDTH - x) * y * (WIDTH - y) / WIDTH**4


def roof(shape, creases=()):
    rim = np.array([[0.0, 0.0], [WIDTH, 0.0], [WIDTH, WIDTH], [0.0, WIDTH]])
    mesh = CGCMesh.from_outline(rim, edge_length=1.2, creases=[np.array(line) for line in creases])
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", shape(x, y))
    mesh.set_supports("boundary")
    mesh.set_target(K)
    return mesh


@pytest.mark.parametrize("creases", [(), [[[0.0, 4.0], [WIDTH, 4.0]], [[0.0, 8.0], [WIDTH, 8.0]]]], ids=["smooth", "folded"])
@pytest.mark.parametrize("turned", [pytest.param(False, marks=pytest.mark.nightly), True], ids=["faces up", "faces down"])
def test_a_bowl_stays_on_the_side_that_it_is_drawn_on(creases, turned):
    for height in (0.5, -0.5):
        mesh = roof(bowl(height), creases)
        if turned:
            mesh.flip()
        result = solve(mesh)
        assert result.verdict.fair, result.message
        heights = np.sign(height) * result.vertices[:, 2]
        assert heights.min() > -1e-9 and heights.max() > 0.3
        assert ("rises against the normals" in result.message) is ((height < 0) is not turned)


def test_what_says_no_side_goes_along_its_normals():
    for shape in (bowl(0.0), bowl(-0.01), lambda x, y: 0.2 * x):
        up, down = roof(shape), roof(shape)
        down.flip()
        rise = [float((solve(mesh).vertices[:, 2] - mesh.to_problem().vertices[:, 2]).mean()) for mesh in (up, down)]
        assert rise[0] > 0.3 and rise[1] < -0.3


def test_a_rim_alone_says_no_side():
    assert not is_drawn_below(roof(lambda x, y: 0.02 * (x - 6.0) ** 2 - 0.02 * (y - 6.0) ** 2).to_problem())
