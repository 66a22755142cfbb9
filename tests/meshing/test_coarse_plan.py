"""Coarser meshes of a plan, and values carried over from them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from compas_cgc import CGCMesh
from compas_cgc.discrete import edge_faces
from compas_cgc.meshing.carry_over import CarryOver
from compas_cgc.meshing.coarse_plan import coarse_plan
from compas_cgc.model.divided import with_short_lines
from compas_cgc.solvers.coarse import laid_out_anew

from ..support import shapes


def coarsened(n, step, lines=(), kept=()):
    vertices, faces = shapes.grid(n)
    marked = np.zeros(len(vertices), bool)
    marked[list(kept)] = True
    return vertices[:, :2], coarse_plan(np.ascontiguousarray(vertices[:, :2]), faces, np.array(lines, int).reshape(-1, 2), marked, step)


def places(plan, faces, found):
    return np.vstack([plan[found.kept], np.einsum("pk,pkx->px", found.weights, plan[faces[found.within]])])


def test_the_rim_is_thinned_and_corners_stay():
    plan, found = coarsened(40, 0.1)
    assert {0, 40, 41 * 40, 41 * 41 - 1} <= set(found.kept.tolist())
    edges = edge_faces(found.faces)
    assert (edges[:, 3] < 0).sum() == 40, "ten edges a side"
    corners = places(plan, shapes.grid(40)[1], found)[found.faces]
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    double = ax * by - ay * bx
    assert (double > 0).all() and double.sum() == pytest.approx(2.0)


def test_lines_and_kept_vertices_stay_on_the_mesh():
    middle = np.arange(41) * 41 + 20
    plan, found = coarsened(40, 0.12, lines=np.column_stack([middle[:-1], middle[1:]]), kept=[41 * 7 + 31])
    assert 41 * 7 + 31 in found.kept
    at = plan[found.kept][found.lines]
    assert np.allclose(at[..., 0] if np.ptp(at[..., 0]) < 1e-12 else at[..., 1], 0.5)
    own = {tuple(edge) for edge in np.sort(edge_faces(found.faces)[:, :2], axis=1).tolist()}
    assert {tuple(edge) for edge in np.sort(found.lines, axis=1).tolist()} <= own


def test_a_plan_that_lies_over_itself_has_no_coarser_mesh():
    vertices, faces = shapes.grid(40)
    twice = np.vstack([vertices, vertices + [1e-3, 1e-3, 0]])[:, :2]
    both = np.vstack([faces, faces + len(vertices)])
    assert coarse_plan(np.ascontiguousarray(twice), both, np.empty((0, 2), int), np.zeros(len(twice), bool), 0.1) is None


def test_polynomials_of_degree_four_are_carried_over_exactly():
    points, goal = np.random.default_rng(1).uniform(size=(2, 300, 2))
    x, y = points.T
    u, v = goal.T
    carried = CarryOver(points, goal)(np.column_stack([x**4 - 3 * x * y**3, y**2]))
    assert np.abs(carried - np.column_stack([u**4 - 3 * u * v**3, v**2])).max() < 1e-7


def test_nothing_is_carried_to_no_places():
    # A region between creases may have no vertex of its own.
    for points in (np.zeros((1, 2)), np.eye(3, 2)):
        assert CarryOver(points, np.zeros((0, 2)))(np.ones((len(points), 3))).shape == (0, 3)


def test_the_error_of_what_is_carried_over_falls_with_the_fifth_power():
    goal = np.random.default_rng(2).uniform(0.1, 0.9, size=(500, 2))

    def wave(at):
        return np.sin(4 * at[:, :1] + 1) * np.cos(3 * at[:, 1:])

    errors = [np.abs(CarryOver(shapes.grid(n)[0][:, :2], goal)(wave(shapes.grid(n)[0][:, :2])) - wave(goal)).max() for n in (16, 32)]
    assert errors[1] < errors[0] / 20


def between_sides(vertices, faces, angle):
    """The inner edges between the triangles on two sides of a line through the middle, which go in a zigzag along it."""
    side = (vertices[faces].mean(axis=1)[:, :2] - 0.5) @ [np.cos(angle), np.sin(angle)] > 0.0
    edges = edge_faces(faces)
    edges = edges[edges[:, 3] >= 0]
    return edges[side[edges[:, 2]] != side[edges[:, 3]], :2]


@pytest.mark.parametrize("n", [6, 9, 14])
@pytest.mark.parametrize("angle", np.linspace(0.1, 3.0, 8))
def test_lines_that_go_in_a_zigzag_stay_on_a_mesh_laid_out_anew(n, angle):
    rng = np.random.default_rng(int(10 * angle) + n)
    vertices, faces = shapes.grid(n)
    inside = np.abs(vertices[:, :2] - 0.5).max(axis=1) < 0.5 - 1e-9
    vertices[inside, :2] += rng.uniform(-0.25, 0.25, (inside.sum(), 2)) / n
    plan = np.ascontiguousarray(vertices[:, :2])
    lines = between_sides(vertices, faces, angle)
    for step in (1.0 / n, 0.6 / n, 1.7 / n):
        found = coarse_plan(plan, faces, lines, np.zeros(len(plan), bool), step)
        assert found is not None
        own = found.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        assert {tuple(sorted(e)) for e in found.lines.tolist()} <= {tuple(sorted(e)) for e in own.tolist()}
        assert {*lines.ravel().tolist()} >= {*found.kept[found.lines].ravel().tolist()}


def test_a_straight_rim_with_rounding_has_coarser_meshes_too():
    pytest.importorskip("compas_cgal")
    outline = [[0, 0, 0], [9, -1, 0], [15, 3, 0], [14, 10, 0], [6, 12, 0], [-1, 7, 0]]
    vertices, faces = CGCMesh.from_outline(outline, 0.8).arrays()
    none = np.empty((0, 2), int), np.zeros(len(vertices), bool)
    for step in np.linspace(0.6, 2.5, 30):
        found = coarse_plan(np.ascontiguousarray(vertices[:, :2]), faces, *none, step)
        assert found is None or (edge_faces(found.faces)[:, 3] < 0).any()


OUTLINES = {
    "rectangle": ((0.0, 0.0), (9.0, 0.0), (9.0, 5.0), (0.0, 5.0)),
    "square": ((0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)),
    "trapezoid": ((0.0, 0.0), (10.0, 0.0), (8.0, 5.0), (2.0, 5.0)),
    "kite": ((0.0, 0.0), (3.0, 4.0), (0.0, 6.0), (-3.0, 4.0)),
    "T": ((0.0, 0.0), (3.0, 0.0), (3.0, 4.0), (6.0, 4.0), (6.0, 6.0), (-3.0, 6.0), (-3.0, 4.0), (0.0, 4.0)),
}


@pytest.mark.parametrize("turn", [0.0, 0.4])
@pytest.mark.parametrize("name", OUTLINES)
def test_a_symmetric_plan_is_laid_out_anew_symmetrically(name, turn):
    """Whatever its direction, and although its own triangles are not symmetric."""
    along = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    problem = CGCMesh.from_outline(np.array(OUTLINES[name]) @ along, edge_length=0.5).to_problem()
    laid = laid_out_anew(with_short_lines(problem.with_supports("corners").with_targets(0.01), 0.02), 600, symmetric=True)
    assert laid is not None
    places = laid.problem.vertices[:, :2] @ along.T
    middle = (places[:, 0].min() + places[:, 0].max()) / 2
    away, partners = cKDTree(places).query(places * [-1.0, 1.0] + [2 * middle, 0.0])
    assert away.max() < 1e-9
    faces = laid.problem.faces
    unlike = {tuple(face) for face in np.sort(faces, axis=1).tolist()} ^ {tuple(face) for face in np.sort(partners[faces], axis=1).tolist()}
    assert len(unlike) <= 0.02 * len(faces), "only cocircular vertices on the axis have no symmetric triangles"
