"""Roofs that are held all round and may fold: one height, whatever the mesh."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve

SQUARE = [[0.0, 0.0], [15.0, 0.0], [15.0, 15.0], [0.0, 15.0]]
TURN = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
OVAL = np.column_stack([9.0 * np.cos(TURN), 6.0 * np.sin(TURN)])
STRIPS = [[[0.0, y], [15.0, y]] for y in (5.0, 10.0)]
BAYS = [[[x, -6.0 * np.sqrt(1 - (x / 9.0) ** 2)], [x, 6.0 * np.sqrt(1 - (x / 9.0) ** 2)]] for x in (-3.0, 3.0)]


def roof(outline, creases, length: float, K: float) -> CGCMesh:
    mesh = CGCMesh.from_outline(np.array(outline), edge_length=length, creases=[np.array(line) for line in creases])
    mesh.set_supports("boundary")
    mesh.set_target(K)
    return mesh


@pytest.mark.parametrize(
    "outline, creases, lengths",
    [pytest.param(SQUARE, STRIPS, (1.0, 0.9), marks=pytest.mark.nightly), (OVAL, BAYS, (1.4, 1.1))],
    ids=["square", "oval"],
)
def test_a_folded_roof_over_a_whole_rim_is_fair_and_as_high_on_every_mesh(outline, creases, lengths):
    drawn = [roof(outline, creases, length, 1.0).to_problem() for length in lengths]
    for K in (0.002, 0.004):
        found = [solve(problem.with_targets(K)) for problem in drawn]
        assert all(result.converged and result.verdict.fair for result in found), [str(result.verdict) for result in found]
        heights = [np.ptp(result.vertices[:, 2]) for result in found]
        assert max(heights) < 1.1 * min(heights)
        assert all(result.vertices[:, 2].min() > -1e-9 for result in found)


def test_where_the_shape_of_the_drawing_is_kept_no_other_is_put_over_it():
    mesh = roof(SQUARE, STRIPS, 1.3, 0.002)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", -0.01 * x * (15.0 - x) * (1.0 - (y / 7.5 - 1.0) ** 2))
    result = solve(mesh, settings={"keep": "shape"})
    assert "dome" not in result.message and result.vertices[:, 2].max() < 0.1
