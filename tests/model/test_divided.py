"""A problem with short edges along its lines has the supports, creases, regions and targets of the problem."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Rise
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import face_normals
from compas_cgc.model.divided import with_halved_edges
from compas_cgc.model.divided import with_short_lines
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL


@pytest.fixture
def problem():
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    mesh.set_supports([*range(7), 3 * 7 + 2, 4 * 7 + 2])
    mesh.set_creases([[7 * 5 + k for k in range(7)], [3, 7 + 3, 14 + 3]])
    mesh.set_target(0.02)
    mesh.set_target(0.03, region=1)
    return mesh.to_problem().with_goals([Rise(2.0)])


@pytest.mark.parametrize("longest, parts", [(1.0, 1), (0.6, 2), (0.5, 2), (0.2, 8)])
def test_lines_are_divided_and_the_surface_stays_the_same(problem, longest, parts):
    fine = with_short_lines(problem, longest)
    n, m = len(problem.vertices), len(problem.faces)
    lines = 4 * 6 + len(problem.creases) + 1
    assert (fine.vertices[:n] == problem.vertices).all() and fine.goals == problem.goals
    assert len(fine.vertices) == n + lines * (parts - 1)
    edges = edge_faces(fine.faces)
    rim = edges[edges[:, 3] < 0, :2]
    for own in (rim, fine.creases):
        assert np.linalg.norm(fine.vertices[own[:, 1]] - fine.vertices[own[:, 0]], axis=1) == pytest.approx(1.0 / parts)
    assert (face_normals(fine.vertices, fine.faces)[:, 2] > 0.0).all()
    areas = [np.bincount(own.regions(), face_areas(own.vertices, own.faces)) for own in (problem, fine)]
    assert areas[1] == pytest.approx(areas[0]) and (fine.regions()[:m] == problem.regions()).all()


def test_roles_and_targets_are_those_of_the_edges(problem):
    fine = with_short_lines(problem, 0.5)
    n = len(problem.vertices)
    assert (fine.roles[:n] == problem.roles).all()
    held = fine.vertices[n:][fine.roles[n:] == FIXED]
    assert sorted(map(tuple, held[:, :2].tolist())) == sorted([*((0.0, k + 0.5) for k in range(6)), (3.5, 2.0)])
    assert len(fine.creases) == 2 * len(problem.creases) and (fine.roles[n:] == CREASE).sum() == len(problem.creases)
    assert (fine.roles[n:] == FREE).sum() == 3 * 6
    assert fine.region_targets() == problem.region_targets() == [0.02, 0.03]


def test_with_all_edges_halved_each_face_is_four_and_lines_stay_lines(problem):
    fine = with_halved_edges(problem)
    n, edges = len(problem.vertices), edge_faces(problem.faces)
    assert len(fine.vertices) == n + len(edges) and len(fine.faces) == 4 * len(problem.faces)
    assert face_areas(fine.vertices, fine.faces) == pytest.approx(1.0 / 8.0)
    short = with_short_lines(problem, 0.5)
    for role in (FIXED, FREE, CREASE):
        assert {tuple(own) for own in fine.vertices[fine.roles == role]} == {tuple(own) for own in short.vertices[short.roles == role]}
    assert (fine.roles[n:] == INTERNAL).sum() == len(edges) - (len(short.vertices) - n)
    assert fine.region_targets() == problem.region_targets() and fine.goals == problem.goals


def test_edges_from_crease_to_crease_across_a_corner_have_the_target_of_their_region():
    mesh = CGCMesh.from_meshgrid(dx=8.0, nx=8)
    mesh.set_creases([[9 * i + 4 for i in range(9)], [9 * 4 + i for i in range(9)]])
    for region, K in enumerate([0.02, -0.02, -0.02, 0.02]):
        mesh.set_target(K, region=region)
    problem = mesh.to_problem()
    ends = problem.roles[np.sort(edge_faces(problem.faces)[:, :2], axis=1)] == CREASE
    assert ends.all(axis=1).sum() > len(problem.creases), "some edges cross a corner"
    assert with_halved_edges(problem).region_targets() == problem.region_targets() == [0.02, -0.02, -0.02, 0.02]


def test_within_faces_that_are_held_whole_nothing_is_divided():
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    mesh.set_supports(range(3 * 7))
    mesh.set_target(0.02)
    fine = with_short_lines(mesh.to_problem(), 0.1)
    added = fine.vertices[7 * 7 :]
    on_rim = np.isclose(np.abs(added[:, :2] - 3.0).max(axis=1), 3.0)
    assert on_rim.sum() == 4 * 6 * 15 and np.isclose(added[~on_rim, 0], 2.0).all() and (~on_rim).sum() == 6 * 15
