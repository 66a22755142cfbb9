"""Curves to creases: along edges, along the best edges, or cut into the mesh."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import face_normals
from compas_cgc.meshing import face_regions
from compas_cgc.meshing.cleanup import tidy
from compas_cgc.meshing.map_matching import edge_net
from compas_cgc.meshing.point_location import face_at
from compas_cgc.meshing.polyline import nearest_on_polyline
from compas_cgc.meshing.polyline import point_at
from compas_cgc.meshing.polyline import points_along
from compas_cgc.meshing.split import split_along
from compas_cgc.meshing.split import split_path
from compas_cgc.meshing.trace import trace_curve

from ..support.rhino_models import row
from ..support.shapes import grid

N = 12


@pytest.fixture
def net():
    vertices, faces = grid(N, float(N))
    return edge_net(vertices, faces)


def circle(centre, radius, count=400):
    angle = np.linspace(0, 2 * np.pi, count)
    points = np.column_stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), 0 * angle])
    points[-1] = points[0]
    return points


def test_points_are_met_in_order_and_as_often_as_the_curve_comes_by():
    points = np.array([[3, 0, 0], [1, 0, 0], [0, 0, 0], [2, 5e-4, 0], [2, 0.1, 0]], float)
    there_and_back = np.array([[0, 0, 0], [3, 0, 0], [0, 0, 0]], float)
    assert points_along(points, there_and_back, 1e-3).tolist() == [2, 1, 3, 0, 3, 1, 2]
    distance, position = nearest_on_polyline(points[4:], there_and_back)
    assert distance == pytest.approx([0.1]) and position == pytest.approx([2.0])


def test_nearest_points_are_the_same_without_all_pairs(monkeypatch):
    random = np.random.default_rng(3)
    line = np.concatenate([circle((0, 0), 5.0, 800), 40.0 * random.normal(size=(20, 3)), [[1.0, 2.0, 0.0]] * 2])
    points = np.concatenate([4.0 * random.normal(size=(1500, 3)), circle((0, 0), 2.0, 90), line[::7]])
    expected = nearest_on_polyline(points, line)
    monkeypatch.setattr("compas_cgc.meshing.polyline.MAX_PAIRS", 0)
    found = nearest_on_polyline(points, line)
    assert np.abs(found[0] - expected[0]).max() < 1e-12
    # At equal distances, as from the centre of the circle, either place is right.
    assert np.linalg.norm(point_at(line, found[1]) - points, axis=1) == pytest.approx(expected[0], abs=1e-9)


def test_a_curve_along_edges_gives_these_edges(net):
    straight = np.array([[4, 0, 0], [4, N, 0]], float)
    trace = trace_curve(net, straight, 1e-6)
    assert trace.paths == [row(N, 4)] and trace.deviation < 1e-12 and trace.outside == 0.0
    backwards = trace_curve(net, straight[::-1], 1e-6)
    assert backwards.paths == [row(N, 4)[::-1]]


def test_a_closed_curve_along_edges_ends_where_it_begins(net):
    square = np.array([[2.5, 2, 0], [6, 2, 0], [6, 6, 0], [2, 6, 0], [2, 2, 0], [2.5, 2, 0]], float)
    (path,) = trace_curve(net, square, 1e-6).paths
    assert path[0] == path[-1] and len(path) == 17 and len(set(path)) == 16


def test_a_curve_that_crosses_itself_on_edges(net):
    eight = np.array([[2, 2, 0], [6, 2, 0], [6, 6, 0], [4, 6, 0], [4, 0, 0]], float)
    trace = trace_curve(net, eight, 1e-6)
    (path,) = trace.paths
    assert trace.deviation < 1e-12 and path.count(4 * (N + 1) + 2) == 2


def test_any_other_curve_gets_the_best_path_of_edges(net):
    trace = trace_curve(net, circle((6, 6), 4.0), 1e-6)
    (path,) = trace.paths
    assert path[0] == path[-1] and len(set(path)) == len(path) - 1
    distance, _ = nearest_on_polyline(net.vertices[path], circle((6, 6), 4.0))
    assert distance.max() <= trace.deviation < 0.75
    assert all(v in net.neighbours(u) for u, v in zip(path[:-1], path[1:]))


def length_of(net, path):
    return float(np.linalg.norm(np.diff(net.vertices[path], axis=0), axis=1).sum())


def swaying(by):
    x = np.linspace(0, N, 400)
    return np.column_stack([x, 4.5 + by * np.sin(2 * x), 0 * x])


def test_a_walk_follows_a_curve_that_sways_far_and_spares_itself_one_that_hardly_does(net):
    """Between two rows of vertices either is as near; the row is changed where that is worth its length only."""
    (hardly,) = trace_curve(net, swaying(0.03), 1e-6).paths
    (far,) = trace_curve(net, swaying(0.4), 1e-6).paths
    assert len(set(net.vertices[hardly, 1])) == 1 and length_of(net, hardly) == N
    assert (np.diff(net.vertices[far, 1]) != 0).sum() == 8


def test_a_straight_curve_gives_a_walk_that_never_turns_back(net):
    """A vertex a little ahead of its sample is as good as one beside it, or the walk would go about in a zigzag."""
    for slope in (0.3, 0.6, 0.9):
        x = np.linspace(0, N, 400)
        (path,) = trace_curve(net, np.column_stack([x, 0.3 + slope * x, 0 * x]), 1e-6).paths
        assert (np.diff(net.vertices[path, 0]) == 1).all(), slope


@pytest.mark.parametrize("unit", [2.0**-10, 2.0**10])
def test_the_walk_is_the_same_in_any_unit(net, unit):
    vertices, faces = grid(N, float(N))
    for curve in (swaying(0.2), circle((6.4, 5.7), 1.3), np.array([[0, N, 0], [N, 0, 0]], float)):
        other = trace_curve(edge_net(unit * vertices, faces), unit * curve, unit * 1e-6)
        assert other.paths == trace_curve(net, curve, 1e-6).paths


def test_what_hangs_over_the_edge_is_left_out_and_the_crease_reaches_the_boundary(net):
    trace = trace_curve(net, np.array([[-3, 2.2, 0], [15, 9.7, 0]], float), 1e-6, np.isin(np.arange((N + 1) ** 2), row(N, 0) + row(N, N)))
    (path,) = trace.paths
    assert net.vertices[path[0], 0] == 0.0 and net.vertices[path[-1], 0] == N
    assert 5.0 < trace.outside < 6.5


def test_a_curve_over_a_hole_gives_two_paths():
    vertices, faces = grid(N, float(N))
    centre = vertices[faces].mean(axis=1)
    hole = (np.abs(centre - [6, 6, 0]) < 2).all(axis=1)
    holed = tidy(vertices, faces[~hole], 0.0)
    trace = trace_curve(edge_net(holed.vertices, holed.faces), np.array([[0, 6.1, 0], [N, 6.1, 0]], float), 1e-6)
    assert len(trace.paths) == 2


def test_a_curve_elsewhere_gives_no_path(net):
    assert trace_curve(net, np.array([[0, 0, 50], [5, 5, 50]], float), 1e-6).paths == []


def cut(vertices, faces, curve, keep=None):
    keep = np.zeros(len(vertices), bool) if keep is None else keep
    return split_along(vertices, faces, curve, 1e-9, keep)


def check_split(split, vertices, faces, curve):
    """A split mesh is whole, covers the same area, has no slivers, and its paths follow the curve along edges."""
    area = face_areas(split.vertices, split.faces)
    assert area.sum() == pytest.approx(face_areas(vertices, faces).sum(), rel=1e-12)
    assert (face_normals(split.vertices, split.faces)[:, 2] > 0).all()
    corners = split.vertices[split.faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    assert (area / longest**2).min() > 0.015
    edges = {tuple(sorted(edge)) for edge in edge_faces(split.faces)[:, :2].tolist()}
    for path in split.paths:
        assert all(tuple(sorted(pair)) in edges for pair in zip(path[:-1], path[1:]))
        distance, _ = nearest_on_polyline(split.vertices[path], curve)
        assert distance.max() < 1e-9


@pytest.mark.parametrize("radius", [2.0, 3.1, 4.4])
def test_a_mesh_cut_along_a_circle_has_the_circle_as_edges(radius):
    vertices, faces = grid(N, float(N))
    curve = circle((6.13, 5.9), radius, 2000)
    split = cut(vertices, faces, curve)
    check_split(split, vertices, faces, curve)
    (path,) = split.paths
    assert path[0] == path[-1]
    edges = np.column_stack([path[:-1], path[1:]])
    regions = face_regions(split.faces, edges)
    inside = face_areas(split.vertices, split.faces)[regions == regions[face_at(np.array([6.1, 5.9, 0]), split.vertices, split.faces)[0]]]
    assert regions.max() == 1 and inside.sum() == pytest.approx(np.pi * radius**2, rel=0.05)


def test_a_second_cut_through_the_first_keeps_the_first():
    vertices, faces = grid(N, float(N))
    first = np.array([[-1, 3.3, 0], [13, 8.8, 0]], float)
    second = np.array([[2.2, -1, 0], [9.4, 13, 0]], float)
    one = cut(vertices, faces, first)
    keep = np.zeros(len(one.vertices), bool)
    keep[one.paths[0]] = True
    two = cut(one.vertices, one.faces, second, keep)
    path = split_path(one.paths[0], two.inserted)
    edges = {tuple(sorted(edge)) for edge in edge_faces(two.faces)[:, :2].tolist()}
    assert all(tuple(sorted(pair)) in edges for pair in zip(path[:-1], path[1:]))
    pairs = [pair for p in (path, two.paths[0]) for pair in zip(p[:-1], p[1:])]
    assert face_regions(two.faces, np.array(pairs)).max() == 3, "two crossing lines make four regions"


def test_a_cut_on_a_curved_surface_stays_on_it():
    vertices, faces = grid(N, float(N))
    bend = vertices.copy()
    bend[:, 2] = 0.05 * (bend[:, 0] ** 2 + bend[:, 1] ** 2)
    curve = circle((6.0, 6.0), 3.3, 3000)
    curve[:, 2] = 0.05 * (curve[:, 0] ** 2 + curve[:, 1] ** 2)
    split = cut(bend, faces, curve)
    (path,) = split.paths
    distance, _ = nearest_on_polyline(split.vertices[path], curve)
    assert distance.max() < 0.02, "no farther than the chords of the mesh are from the surface"


def test_a_vertex_that_must_stay_is_not_moved_onto_the_curve():
    vertices, faces = grid(N, float(N))
    curve = np.array([[-1, 5.9, 0], [13, 5.9, 0]], float)
    keep = np.zeros(len(vertices), bool)
    keep[6 * (N + 1) + 6] = True
    split = cut(vertices, faces, curve, keep)
    assert np.array_equal(split.vertices[6 * (N + 1) + 6], [6.0, 6.0, 0.0])
    assert split.vertices[5 * (N + 1) + 6, 1] == pytest.approx(5.9)


def test_a_curve_that_cannot_be_cut_is_refused():
    vertices, faces = grid(N, float(N))
    assert cut(vertices, faces, np.array([[0, 0, 50], [5, 5, 50]], float)) is None


def test_a_note_belongs_to_the_face_it_lies_on_or_sees_from_above():
    vertices, faces = grid(4, 4.0)
    dome = vertices.copy()
    dome[:, 2] = 8.0 - 0.5 * ((dome[:, 0] - 2) ** 2 + (dome[:, 1] - 2) ** 2)
    face, off = face_at(np.array([0.2, 0.1, 0.0]), dome, faces)
    assert off == 0.0 and face == 0, "a dot in the plan belongs to the face above it, not to the nearest one"
    centre = dome[faces[7]].mean(axis=0)
    assert face_at(centre, dome, faces) == (7, 0.0)
    _, off = face_at(np.array([40.0, 0.0, 0.0]), vertices, faces)
    assert off == pytest.approx(36.0)
