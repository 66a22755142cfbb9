"""A roof hardly knows which way the diagonals of its mesh run."""

from __future__ import annotations

import numpy as np

from compas_cgc import CGCMesh
from compas_cgc import check
from compas_cgc import solve
from compas_cgc.model.measures import read_across
from compas_cgc.model.roles import FIXED

N = 40
WAYS = {
    "one way": lambda i, j: np.ones_like(i, dtype=bool),
    "in turns": lambda i, j: (i + j) % 2 == 0,
    "in turns, the others": lambda i, j: (i + j) % 2 == 1,
    "row by row": lambda i, j: j % 2 == 0,
    "by chance": lambda i, j: np.random.default_rng(3).random(i.shape) < 0.5,
}


def square(way):
    """Return a unit square of quads split one way or the other."""
    j, i = (axis.ravel() for axis in np.mgrid[:N, :N])
    a = (N + 1) * j + i
    b, c, d = a + 1, a + N + 2, a + N + 1
    up = WAYS[way](i, j)[:, None]
    quads = np.stack([a, b, c, d], axis=1)
    faces = np.concatenate([np.where(up, quads[:, [0, 1, 2]], quads[:, [0, 1, 3]]), np.where(up, quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])])
    y, x = np.mgrid[: N + 1, : N + 1] / N
    return np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1), faces


def roof(way):
    vertices, faces = square(way)
    mesh = CGCMesh.from_vertices_and_faces(vertices.tolist(), faces.tolist())
    mesh.set_supports("boundary")
    mesh.set_target(2.0)
    return mesh


def height(way):
    found = solve(roof(way), settings={"measure": "smooth"})
    assert found.converged and found.verdict.fair
    assert np.nanmax(np.abs(found.curvature - 2.0)) <= 1e-8
    return found.vertices[len(found.vertices) // 2, 2]


def test_a_square_roof_is_as_high_whichever_way_its_diagonals_run():
    heights = {way: height(way) for way in WAYS}
    # To where angle defects of 26,000 and 58,000 vertices tend, whichever way their diagonals run, those that cut corners off included.
    assert all(abs(found / 0.3744 - 1.0) <= 4e-3 for found in heights.values()), heights
    evenly = [heights[way] for way in ("one way", "in turns", "in turns, the others")]
    assert max(evenly) <= 1.003 * min(evenly)


def test_faces_that_cut_corners_off_are_named_where_they_count():
    (said,) = [remark for remark in check(roof("one way")) if "flat in corners" in remark]
    assert not said.fatal and "2 faces" in said and "measure='smooth'" in said
    # There auto reads K into the corners.
    assert not any("flat in corners" in remark for remark in check(roof("in turns, the others")))


def test_creases_and_faces_with_a_vertex_that_moves_are_left_alone():
    problem = roof("one way").to_problem()
    assert (read_across(problem) != problem.faces).any(axis=1).sum() == 4
    corner = problem.faces[(problem.roles == FIXED)[problem.faces].all(axis=1)]
    inner = [[u, v] for a, b, c in corner.tolist() for u, v in ((a, b), (b, c), (c, a)) if abs(u - v) not in (1, N + 1)]
    assert (read_across(problem.with_creases(inner)) == problem.faces).all()
    loose = problem.with_supports([0, N, N * (N + 1), N * (N + 2)])
    assert (read_across(loose) == loose.faces).all()
