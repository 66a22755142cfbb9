"""Every part between creases gets vertices of its own, in which K can be prescribed."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import face_areas
from compas_cgc.meshing.halving import with_inner_vertices
from compas_cgc.meshing.outline import mesh_from_outline
from compas_cgc.meshing.regions import face_regions

from ..support.shapes import grid


def inner_vertices(vertices, faces, creases):
    """Return how many vertices every region has of its own."""
    regions = face_regions(faces, creases)
    outside = boundary_vertices(vertices, faces)
    outside[np.unique(creases)] = True
    return [len(np.setdiff1d(faces[regions == region], np.flatnonzero(outside))) for region in np.unique(regions)]


@pytest.mark.parametrize("line", [1, 5])
def test_a_strip_of_one_row_of_squares_is_halved_and_the_rest_is_left(line):
    vertices, faces = grid(6)
    creases = np.array([(7 * line + k, 7 * line + k + 1) for k in range(6)])
    assert 0 in inner_vertices(vertices, faces, creases)
    more, parts = with_inner_vertices(vertices, faces, creases)
    assert min(inner_vertices(more, parts, creases)) == 11, "the middles of five rungs and six diagonals"
    assert np.array_equal(more[: len(vertices)], vertices) and len(more) == len(vertices) + 11
    assert face_areas(more, parts).sum() == pytest.approx(1.0, abs=1e-14)
    assert (face_areas(more, parts) > 0.0).all() and len(np.unique(face_regions(parts, creases))) == 2


def test_a_part_of_one_triangle_gets_its_centroid():
    vertices, faces = grid(4)
    creases = np.array([(3, 9)])
    regions = face_regions(faces, creases)
    assert np.bincount(regions).min() == 1
    more, parts = with_inner_vertices(vertices, faces, creases)
    assert len(more) == len(vertices) + 1 and min(inner_vertices(more, parts, creases)) == 1
    assert face_areas(more, parts).sum() == pytest.approx(1.0, abs=1e-14)


def test_a_drawing_with_a_narrow_strip_has_vertices_in_it():
    pytest.importorskip("compas_cgal")
    outline = [(0, 0, 0), (4, 0, 0), (4, 3, 0), (0, 3, 0), (0, 0, 0)]
    made = mesh_from_outline(np.array(outline, float), [], [np.array([(0, 0.2, 0), (4, 0.2, 0)], float)], 0.4, 1e-3)
    creases = np.column_stack([made.creases[0][:-1], made.creases[0][1:]])
    assert min(inner_vertices(made.vertices, made.faces, creases)) >= 1
    assert np.allclose(made.vertices[made.creases[0], 1], 0.2)
