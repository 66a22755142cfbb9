"""A problem with every face divided in four has the supports, creases, regions and targets of the problem."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Rise
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import face_normals
from compas_cgc.model.divided import quartered
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED


@pytest.fixture
def problem():
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    mesh.set_supports([*range(7), 3 * 7 + 2, 4 * 7 + 2])
    mesh.set_creases([[7 * 5 + k for k in range(7)], [3, 7 + 3, 14 + 3]])
    mesh.set_target(0.02)
    mesh.set_target(0.03, region=1)
    return mesh.to_problem().with_goals([Rise(2.0)])


def test_faces_and_vertices_are_divided(problem):
    fine = quartered(problem)
    n, m = len(problem.vertices), len(problem.faces)
    assert (fine.vertices[:n] == problem.vertices).all() and len(fine.faces) == 4 * m and fine.goals == problem.goals
    areas = face_areas(fine.vertices, fine.faces).reshape(4, m)
    assert areas == pytest.approx(np.tile(face_areas(problem.vertices, problem.faces) / 4.0, (4, 1)))
    assert (face_normals(fine.vertices, fine.faces)[:, 2] > 0.0).all()
    assert (fine.regions().reshape(4, m) == problem.regions()).all()


def test_roles_and_targets_are_those_of_the_edges(problem):
    fine = quartered(problem)
    n = len(problem.vertices)
    assert (fine.roles[:n] == problem.roles).all()
    held = fine.vertices[n:][fine.roles[n:] == FIXED]
    assert sorted(map(tuple, held[:, :2].tolist())) == sorted([*((0.0, k + 0.5) for k in range(6)), (3.5, 2.0)])
    assert len(fine.creases) == 2 * len(problem.creases) and (fine.roles[n:] == CREASE).sum() == len(problem.creases)
    assert fine.region_targets() == problem.region_targets() == [0.02, 0.03]
