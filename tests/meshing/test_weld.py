"""Meshes as they come to meshes that curvature can be measured on."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc.errors import MeshError
from compas_cgc.meshing import triangulate
from compas_cgc.meshing.cleanup import tidy
from compas_cgc.meshing.orient import orient
from compas_cgc.meshing.weld import clean_faces
from compas_cgc.meshing.weld import split_quads
from compas_cgc.meshing.weld import weld

from ..support.rhino_models import quads
from ..support.shapes import grid
from ..support.shapes import icosphere


def test_a_welded_mesh_comes_out_bit_for_bit():
    vertices, faces = icosphere(3)
    welded = weld(vertices, faces, 1e-6)
    assert np.array_equal(welded.vertices, vertices) and np.array_equal(welded.faces, faces)
    assert np.array_equal(welded.index, np.arange(len(vertices)))


def test_vertices_that_no_face_uses_join_nobody():
    """Chains of near vertices become one, but not through one that is not part of the mesh."""
    vertices = np.array([[0, 0, 0], [5, 0, 0], [0, 5, 0], [0.9, 0, 0], [1.8, 0, 0], [5, 5, 0]], float)
    faces = np.array([[0, 1, 2], [4, 1, 5]])
    welded = weld(vertices, faces, 1.0)
    assert welded.index.tolist() == [0, 1, 2, -1, 3, 4] and np.array_equal(welded.vertices, vertices[[0, 1, 2, 4, 5]])
    used = np.vstack([faces, [[3, 1, 5]]])
    assert weld(vertices, used, 1.0).index.tolist() == [0, 1, 2, 0, 0, 3]


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.9))
def test_faces_that_fell_apart_are_joined_again(seed, noise):
    vertices, faces = icosphere(2)
    random = np.random.default_rng(seed)
    loose = vertices[faces].reshape(-1, 3)
    # Copies of a vertex are at most the tolerance apart.
    loose = loose + noise * 1e-6 / np.sqrt(12) * random.uniform(-1, 1, loose.shape)
    welded = weld(loose, np.arange(len(loose)).reshape(-1, 3), 1e-6)
    assert len(welded.vertices) == len(vertices)
    assert np.allclose(welded.vertices[welded.faces], vertices[faces], atol=1e-6)
    # The first of each group keeps every bit.
    assert all((point == loose).all(axis=1).any() for point in welded.vertices)


def test_vertices_of_no_face_go_and_do_not_attract_others():
    vertices = np.array([[9, 9, 9], [0, 0, 0], [1, 0, 0], [0, 1, 0], [1e-9, 0, 0]], float)
    welded = weld(vertices, np.array([[1, 2, 3]]), 1e-6)
    assert np.array_equal(welded.vertices, vertices[1:4]) and welded.faces.tolist() == [[0, 1, 2]]
    assert welded.index.tolist() == [-1, 0, 1, 2, -1]


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=4, max_size=4))
def test_quads_are_split_as_the_mesh_class_splits_them(corners):
    vertices = np.array([[*corner, 0.0] for corner in corners])
    whole = triangulate(vertices, [0, 1, 2, 3])
    split, owner = split_quads(vertices, np.array([[0, 1, 2, 3]]))
    assert owner.tolist() == [0, 0]
    if len({tuple(sorted(t)) for t in whole} & {(0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3)}) == 2 and _simple(vertices):
        assert {tuple(sorted(t)) for t in split.tolist()} == {tuple(sorted(t)) for t in whole}


def _simple(P):
    """Tell whether a quad has exactly one reflex corner at most, clearly, and does not cross itself."""
    turns = [np.cross(P[i] - P[i - 1], P[(i + 1) % 4] - P[i])[2] for i in range(4)]
    return min(map(abs, turns)) > 1e-3 and abs(np.sign(turns).sum()) >= 2


def test_rhino_triangles_repeat_a_corner_wherever():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2, 2], [0, 0, 1, 2], [0, 1, 1, 2], [2, 0, 1, 2], [0, 1, 2, 3]])
    split, owner = split_quads(vertices, faces)
    assert owner.tolist() == [0, 1, 2, 3, 4, 4]
    turned = [tuple(np.roll(t, -int(np.argmin(t)))) for t in split.tolist()]
    assert turned[:4] == [(0, 1, 2)] * 4 and turned[4:] == [(0, 1, 2), (0, 2, 3)]


def test_what_is_no_face_is_dropped_and_counted():
    faces = np.array([[0, 1, 2], [1, 1, 2], [2, 0, 1], [1, 3, 2], [0, 2, 1]])
    cleaned = clean_faces(faces)
    assert cleaned.faces.tolist() == [[0, 1, 2], [1, 3, 2]] and cleaned.kept.tolist() == [0, 3]
    assert (cleaned.degenerate, cleaned.duplicate) == (1, 2)


@given(st.integers(0, 2**32 - 1))
def test_as_few_faces_as_possible_are_turned(seed):
    _, faces = icosphere(2)
    wrong = np.random.default_rng(seed).random(len(faces)) < 0.3
    mixed = np.where(wrong[:, None], faces[:, [0, 2, 1]], faces)
    oriented = orient(mixed)
    assert oriented.orientable and np.array_equal(oriented.turned, wrong) and np.array_equal(oriented.faces, faces)


def test_every_piece_is_oriented_by_itself_and_ties_go_to_the_first_face():
    two = np.array([[0, 1, 2], [1, 2, 3], [4, 5, 6], [5, 7, 6], [5, 6, 8]])
    oriented = orient(two)
    assert oriented.turned.tolist() == [False, True, False, False, True] or oriented.turned.tolist() == [False, True, False, False, False]
    assert oriented.faces[1].tolist() == [1, 3, 2]


def test_a_moebius_strip_stays_as_it_is():
    n = 6
    a = np.arange(n)
    top = np.where(a + 1 < n, a + 1, n)  # the last joins the first one turned over
    bottom = np.where(a + 1 < n, n + a + 1, 0)
    faces = np.concatenate([np.column_stack([a, top, n + a]), np.column_stack([top, bottom, n + a])])
    oriented = orient(faces)
    assert not oriented.orientable and np.array_equal(oriented.faces, faces)


def test_all_of_it_at_once_with_a_list_of_what_was_done():
    vertices, faces = quads(4)
    loose = vertices[faces].reshape(-1, 3)
    own = np.arange(len(loose)).reshape(-1, 4)
    own[5] = own[5][::-1]
    own = np.concatenate([own, own[:1], [[0, 0, 1, 1]]])
    loose = np.concatenate([loose, [[7.0, 7.0, 7.0]]])
    clean = tidy(loose, own, 1e-6, " m")
    assert len(clean.vertices) == 25 and len(clean.faces) == 32
    text = "\n".join(clean.notes)
    for words in ("welded to others within 1e-06 m", "without a face", "split", "duplicate", "fewer than three", "turned over"):
        assert words in text
    assert clean.index[-1] == -1 and clean.owner.max() == 15


def test_a_tolerance_larger_than_the_mesh_does_not_swallow_it():
    vertices, faces = quads(4, width=1e-3)
    clean = tidy(vertices, faces, 1.0)
    assert np.array_equal(clean.vertices, vertices)
    with pytest.raises(MeshError, match="no face with three different corners"):
        tidy(np.zeros((3, 3)), np.array([[0, 1, 2, 2]]), 1.0)


def test_polygons_of_any_number_of_corners():
    angle = np.arange(7) / 7 * 2 * np.pi
    vertices = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(7)])
    clean = tidy(vertices, [[0, 1, 2, 3, 4, 5, 6]], 0.0)
    assert len(clean.faces) == 5 and (clean.owner == 0).all()
    _, triangles = grid(2)
    assert np.array_equal(tidy(*grid(2), 0.0).faces, triangles)
