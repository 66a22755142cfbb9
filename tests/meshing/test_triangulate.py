"""Polygons become triangles without new vertices, quads all at once."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc.meshing.triangulate import triangles_of
from compas_cgc.meshing.triangulate import triangulate

GRID = st.integers(-3, 3).map(float)  # of few places, so that corners coincide and lie on lines


@given(st.data())
def test_many_polygons_are_split_as_each_of_them(data):
    points = data.draw(st.lists(st.tuples(GRID, GRID, GRID), min_size=4, max_size=9))
    corner = st.integers(0, len(points) - 1)
    faces = data.draw(st.lists(st.lists(corner, min_size=3, max_size=5), min_size=1, max_size=6))
    one_by_one = [triangulate(points, face) for face in faces]
    for vertices in (points, np.array(points), dict(enumerate(points))):
        triangles, owner = triangles_of(vertices, faces)
        assert triangles.tolist() == [triangle for part in one_by_one for triangle in part]
        assert owner.tolist() == [i for i, part in enumerate(one_by_one) for _ in part]


@pytest.mark.parametrize(
    ("fourth", "diagonal"),
    [((0, 1, 0), {0, 2}), ((0.9, 0.1, 0), {1, 3}), ((0.4, 0.8, 0), {0, 2})],
    ids=["a square", "concave at the fourth", "nearly a square"],
)
def test_a_quad_is_split_within(fourth, diagonal):
    triangles, owner = triangles_of([(0, 0, 0), (1, 0, 0), (1, 1, 0), fourth], [[0, 1, 2, 3]])
    assert set(triangles[0]) & set(triangles[1]) == diagonal and owner.tolist() == [0, 0]
