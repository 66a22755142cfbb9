"""Valences brought to 6 where points lie without order."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from compas_cgc.meshing.boundary import boundary_loops
from compas_cgc.meshing.edge_flips import valences
from compas_cgc.meshing.relaxation import plane_angles
from compas_cgc.meshing.relaxation import relaxed
from compas_cgc.meshing.valence_annealing import annealed


def even(points):
    return np.ones(len(points))


@pytest.fixture(scope="module")
def square():
    """Return points, faces, held points and kept edges of a square of side 10 with a crease in the middle and points anywhere."""
    t = np.arange(11.0)
    rim = np.concatenate(
        [np.column_stack(side) for side in ((t, 0 * t), (t, 0 * t + 10), (0 * t[1:-1], t[1:-1]), (0 * t[1:-1] + 10, t[1:-1]))]
    )
    crease = np.column_stack([t[1:-1], 0 * t[1:-1] + 5.0])
    inner = np.random.default_rng(0).uniform(0.7, 9.3, (75, 2))
    inner = inner[abs(inner[:, 1] - 5) > 0.6]
    plan = np.concatenate([rim, crease, inner])
    faces = Delaunay(plan).simplices.astype(np.int64)
    a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
    faces = np.where((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0)[:, None], faces[:, [0, 2, 1]], faces)
    held = np.arange(len(plan)) < len(rim) + len(crease)
    line = len(rim) + np.arange(len(crease))
    kept = np.column_stack([line[:-1], line[1:]])
    return *relaxed(plan, faces, held, kept, even), held, kept


def regular(plan, faces):
    inner = np.setdiff1d(np.arange(len(plan)), np.concatenate(boundary_loops(faces)))
    return np.mean(valences(len(plan), faces)[inner] == 6)


def test_more_valences_are_6_and_angles_stay_wide(square):
    plan, faces, held, kept = square
    points, triangles = annealed(plan, faces, held, kept, even)
    assert regular(points, triangles) > regular(plan, faces) + 0.1
    assert np.degrees(plane_angles(points, triangles).min()) >= min(28.0, np.degrees(plane_angles(plan, faces).min())) - 1e-9


def test_what_is_held_stays_and_the_area_is_covered_once(square):
    plan, faces, held, kept = square
    points, triangles = annealed(plan, faces, held, kept, even)
    count = np.count_nonzero(held)
    assert (points[:count] == plan[:count]).all()  # bit for bit, in their order
    sides = {tuple(sorted(side)) for face in triangles.tolist() for side in zip(face, face[1:] + face[:1])}
    assert all(tuple(edge) in sides for edge in kept.tolist())
    corners = points[triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert area.min() > 0.0 and area.sum() == pytest.approx(100.0, rel=1e-12)
    assert len(points) - len(sides) + len(triangles) == 1


def test_the_same_again_and_nothing_where_fans_meet_in_a_vertex(square):
    first, second = (annealed(*square, even) for _ in range(2))
    assert all((one == other).all() for one, other in zip(first, second))
    bow = np.array([[0.0, 0], [-1, -1], [-1, 1], [1, -1], [1, 1]]), np.array([[0, 2, 1], [0, 3, 4]])
    same = annealed(*bow, np.ones(5, bool), np.empty((0, 2), np.int64), even)
    assert same[0] is bow[0] and same[1] is bow[1]
