"""A roof hardly knows which way the diagonals of its mesh run."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.model.measures import read_across
from compas_cgc.model.roles import FIXED

N = 40
WAYS = {
    "one way": lambda i, j: np.ones_like(i, dtype=bool),
    "in turns": lambda i, j: (i + j) % 2 == 0,
    "in turns, the others": lambda i, j: (i + j) % 2 == 1,
    "row by row": lambda i, j: j % 2 == 0,
    "in quarters": lambda i, j: (i < N / 2) == (j < N / 2),
    "by chance": lambda i, j: np.random.default_rng(3).random(i.shape) < 0.5,
}


def square(way, n=N):
    """Return a unit square of quads split one way or the other."""
    j, i = (axis.ravel() for axis in np.mgrid[:n, :n])
    a = (n + 1) * j + i
    b, c, d = a + 1, a + n + 2, a + n + 1
    up = WAYS[way](i, j)[:, None]
    quads = np.stack([a, b, c, d], axis=1)
    faces = np.concatenate([np.where(up, quads[:, [0, 1, 2]], quads[:, [0, 1, 3]]), np.where(up, quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])])
    y, x = np.mgrid[: n + 1, : n + 1] / n
    return np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1), faces


def roof(way, target=2.0, n=N):
    vertices, faces = square(way, n)
    mesh = CGCMesh.from_vertices_and_faces(vertices.tolist(), faces.tolist())
    mesh.set_supports("boundary")
    mesh.set_target(target)
    return mesh


def height(way, measure, target=2.0):
    found = solve(roof(way, target), settings={"measure": measure})
    assert found.converged and found.verdict.fair and found.measure == "smooth"
    assert np.nanmax(np.abs(found.curvature - target)) <= 1e-8
    return found.vertices[len(found.vertices) // 2, 2]


@pytest.mark.parametrize("measure", ["auto", pytest.param("smooth", marks=pytest.mark.nightly)])
def test_a_square_roof_is_as_high_whichever_way_its_diagonals_run(measure):
    heights = {way: height(way, measure) for way in WAYS}
    # To where angle defects of 26,000 and 58,000 vertices tend, whichever way their diagonals run, those that cut corners off included.
    assert all(abs(found / 0.3744 - 1.0) <= 4e-3 for found in heights.values()), heights
    evenly = [heights[way] for way in ("one way", "in turns", "in turns, the others")]
    assert max(evenly) <= 1.003 * min(evenly)


@pytest.mark.nightly
@pytest.mark.parametrize("target", [0.3, 1.0, 2.3])
def test_so_it_is_for_other_curvatures(target):
    heights = [height(way, "auto", target) for way in ("one way", "in turns", "in turns, the others", "in quarters")]
    assert max(heights) <= 1.005 * min(heights)


@pytest.mark.nightly
def test_what_is_read_in_the_corners_tends_to_what_finer_meshes_say_by_defects():
    """The heights of angle defects fall short by less and less; those of fits do not move."""
    coarse, fine = (solve(roof("one way", 1.0, n)) for n in (40, 60))
    finest = solve(roof("one way", 1.0, 160), settings={"measure": "defect"})
    tops = [found.vertices[:, 2].max() for found in (coarse, fine, finest)]
    assert coarse.measure == fine.measure == "smooth"
    assert abs(tops[0] / tops[1] - 1.0) <= 1e-3 and 0.99 * tops[1] <= tops[2] <= tops[1]


def test_held_rims_are_solved_by_one_measure_on_every_mesh():
    tops = [solve(roof("one way", 1.5, n)).vertices[:, 2].max() for n in (12, 24, 48)]
    # The limit of angle defects on triangles graded to the rim is .2840. Angle defects on these meshes end at .2644, .2739 and .2788.
    assert np.abs(np.array(tops) / 0.2840 - 1.0).max() < 0.01
    assert max(tops[1:]) / min(tops[1:]) - 1.0 < 0.005


def test_creases_and_faces_with_a_vertex_that_moves_are_left_alone():
    problem = roof("one way").to_problem()
    assert (read_across(problem) != problem.faces).any(axis=1).sum() == 4
    corner = problem.faces[(problem.roles == FIXED)[problem.faces].all(axis=1)]
    inner = [[u, v] for a, b, c in corner.tolist() for u, v in ((a, b), (b, c), (c, a)) if abs(u - v) not in (1, N + 1)]
    assert (read_across(problem.with_creases(inner)) == problem.faces).all()
    loose = problem.with_supports([0, N, N * (N + 1), N * (N + 2)])
    assert (read_across(loose) == loose.faces).all()
