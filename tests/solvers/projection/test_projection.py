"""Projection reaches any sign of K, with free edges and creases, from flat and from drawn starts."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import Delaunay

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_normals
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.discrete import vertex_areas
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection import ProjectionSettings
from compas_cgc.solvers.projection import Projector
from compas_cgc.solvers.projection import project

from ...support import shapes


def square(n: int, target: float = 1.0, width: float = 1.0) -> CGCProblem:
    """A flat square with a fixed boundary."""
    vertices, faces = shapes.grid(n, width)
    return CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), target)


def canopy(n: int, target, width: float, lines=()) -> CGCProblem:
    """A flat square on its four corners, with free edges and no dummy mesh, and creases along grid lines."""
    vertices, faces = shapes.grid(n, width)
    i, j = np.divmod(np.arange(len(vertices)), n + 1)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[np.isin(i, lines) | np.isin(j, lines)] = CREASE
    roles[np.isin(i, (0, n)) & np.isin(j, (0, n))] = FIXED
    return CGCProblem(vertices, faces, roles, target)


def nine_regions(centre: float, around: float) -> CGCProblem:
    """Example 4 without its dummies."""
    i, j = np.divmod(np.arange(256), 16)
    inner = (i > 5) & (i < 10) & (j > 5) & (j < 10)
    return canopy(15, np.where(inner, centre, around), 1.5, (5, 10))


def irregular_disk(count: int, target: float = 0.5, radius: float = 1.0, height=None) -> CGCProblem:
    """A Delaunay triangulation of shaken points in a circle, with the rim fixed."""
    h = radius * np.sqrt(np.pi / count)
    around = round(2 * np.pi * radius / h)
    angle = 2 * np.pi * np.arange(around) / around
    x, y = np.meshgrid(np.arange(-radius, radius, 0.93 * h), np.arange(-radius, radius, 0.93 * h))
    points = np.column_stack([x.ravel(), y.ravel()]) + np.random.default_rng(3).uniform(-0.3, 0.3, (x.size, 2)) * h
    points = points[np.hypot(*points.T) < radius - 0.55 * h]
    points = np.vstack([radius * np.column_stack([np.cos(angle), np.sin(angle)]), points])
    faces = Delaunay(points).simplices.astype(np.int64)
    a, b = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    turned = a[:, 0] * b[:, 1] < a[:, 1] * b[:, 0]
    faces[turned] = faces[turned][:, ::-1]
    z = np.zeros(len(points)) if height is None else height(*points.T)
    return CGCProblem(np.column_stack([points, z]), faces, np.where(np.arange(len(points)) < around, FIXED, INTERNAL), target)


def ring(rows: int, around: int, target: float, inner: float, outer: float, height: float, sag: float) -> CGCProblem:
    """A ring between two circles, the inner one fixed and higher, the outer one a free edge."""
    t = np.linspace(1, 0, rows)
    vertices, faces = shapes.revolution(inner + (outer - inner) * t, height * (1 - t) + sag * np.sin(np.pi * t), around)
    roles = np.full(len(vertices), INTERNAL)
    roles[:around], roles[-around:] = FREE, FIXED
    return CGCProblem(vertices, faces, roles, target)


def saddle(target: float, fixed: int) -> CGCProblem:
    """A disk with a rim like a saddle, held at so many points of it or at all (0)."""
    problem = irregular_disk(469, target, height=lambda x, y: 0.3 * (x**2 - y**2))
    if fixed:
        rim = np.flatnonzero(problem.roles == FIXED)
        problem.roles[rim] = FREE
        problem.roles[rim[np.arange(fixed) * len(rim) // fixed]] = FIXED
    return problem


def assert_solved(problem: CGCProblem, solution, steps: int) -> None:
    """Everything that was asked, measured anew on what came back."""
    assert solution.status == "converged", solution.message
    assert solution.iterations <= steps
    K = gaussian_curvature(solution.vertices, problem.faces)
    closed = problem.asked & ~boundary_vertices(problem.vertices, problem.faces)
    error, area = np.abs(K - problem.targets)[closed], vertex_areas(solution.vertices, problem.faces)[closed]
    # The tolerance is relative to the largest target. An angle defect is a sum of angles near 2 pi, which rounds to a few 1e-15.
    least = 1e-12 * max(1.0, problem.target_scale)
    assert (error <= np.maximum(least, 6e-15 / area)).all()
    assert abs(solution.max_error - error.max()) <= least + 6e-15 / area.min()
    still = ~problem.movable
    assert np.array_equal(solution.vertices[still], problem.vertices[still])
    assert sharpest_fold(solution.vertices, problem.faces) > 0, "crumpled"


def sharpest_fold(vertices, faces) -> float:
    edges = edge_faces(faces)
    left, right = edges[edges[:, 3] >= 0, 2:].T
    normals = face_normals(vertices, faces)
    return float(np.einsum("ij,ij->i", normals[left], normals[right]).min())


CRUMPLING = {
    "opposite signs": lambda: nine_regions(2, -6),
    "noise": lambda: shaken(square(8), 0.1),
}


def shaken(problem: CGCProblem, height: float) -> CGCProblem:
    vertices = problem.vertices.copy()
    vertices[problem.movable, 2] += height * np.random.default_rng(1).normal(size=int(problem.movable.sum()))
    return CGCProblem(vertices, problem.faces, problem.roles, problem.targets)


@pytest.mark.parametrize("name", CRUMPLING)
def test_no_step_folds_the_surface_onto_itself(name):
    """A fold has any curvature at its ends, so crumpling is the shortest way to a small error."""
    problem = CRUMPLING[name]()
    folds = []
    solution = project(problem, callback=lambda state: folds.append(sharpest_fold(state.vertices, problem.faces)) and None)
    before = sharpest_fold(problem.vertices, problem.faces)
    assert min(folds) >= min(0.0, before), "no edge folds by more than a right angle, unless it did before"
    assert solution.status == "converged" and sharpest_fold(solution.vertices, problem.faces) > 0


TABLE = {
    "square, K = 1, fixed boundary, 144": (lambda: square(11), 12),
    "square, K = 1, fixed boundary, 1,849": (lambda: square(42), 18),
    "irregular disk": (lambda: irregular_disk(469), 12),
    "irregular disk, 3,000": (lambda: irregular_disk(3000), 12),
    "Example 3": (lambda: canopy(9, 1.0, 0.9), 12),
    "Example 4, K = 1": (lambda: nine_regions(1, 1), 45),
    "Example 4, K = 4": (lambda: nine_regions(4, 4), 115),
    "Example 4, 4 in the centre and 1 around": (lambda: nine_regions(4, 1), 60),
    "Example 4, 4 / 0": (lambda: nine_regions(4, 0), 20),
    "Example 4, +1 / -1": (lambda: nine_regions(1, -1), 145),
    "Example 4, -1 / +1": (lambda: nine_regions(-1, 1), 100),
    "ring, K = 0, 240": (lambda: ring(10, 24, 0.0, 5, 7, 2, 0.25), 12),
    "ring, K = 0, 2,400": (lambda: ring(30, 80, 0.0, 5, 7, 2, 0.25), 12),
    "ring, K = 0, 19,200": (lambda: ring(80, 240, 0.0, 5, 7, 2, 0.25), 12),
    "ring, K = -1, 240": (lambda: ring(10, 24, -1.0, 1, 1.4, 0.4, 0.05), 15),
    "ring, K = -1, 2,400": (lambda: ring(30, 80, -1.0, 1, 1.4, 0.4, 0.05), 25),
    "ring, K = -1, 19,200": (lambda: ring(80, 240, -1.0, 1, 1.4, 0.4, 0.05), 25),
    "wide ring, K = -1, 240": (lambda: ring(10, 24, -1.0, 1, 2, 0.6, 0.15), 25),
    "wide ring, K = -1, 2,400": (lambda: ring(30, 80, -1.0, 1, 2, 0.6, 0.15), 20),
    "wide ring, K = -1, 19,200": (lambda: ring(80, 240, -1.0, 1, 2, 0.6, 0.15), 25),
    "saddle on eight points": (lambda: saddle(-0.2, 8), 150),
}


@pytest.mark.parametrize("case", [pytest.param(case, marks=[pytest.mark.nightly] if "19,200" in case else []) for case in TABLE])
def test_every_row_of_the_table_is_solved_to_rounding(case):
    make, steps = TABLE[case]
    problem = make()
    assert_solved(problem, project(problem, settings=ProjectionSettings(measure="defect")), steps)


@pytest.mark.parametrize("target", [-0.2, pytest.param(-0.36, marks=pytest.mark.nightly)])
def test_negative_curvature_inside_a_plane_fixed_rim_names_the_remedy(target):
    """A plane convex rim carries no K < 0 in total (Gauss-Bonnet), so no rounding leads to a solution."""
    problem = irregular_disk(469, target)
    solution = project(problem)
    assert solution.status != "converged"
    assert "a region of negative K needs a free edge" in solution.message
    assert np.isfinite(solution.vertices).all() and sharpest_fold(solution.vertices, problem.faces) > 0.9


@pytest.mark.parametrize("target", [-1.0, 0.25])
def test_without_any_support_only_the_shape_changes(target):
    problem = canopy(12, target, 1.0)
    problem.roles[problem.roles == FIXED] = FREE
    assert_solved(problem, project(problem), 45)


def test_closed_surfaces_need_no_support_either():
    vertices, faces = shapes.icosphere(3)
    problem = CGCProblem(vertices * [1, 1, 1.2], faces, np.zeros(len(vertices), int), 1.0)
    assert_solved(problem, project(problem), 8)


def test_a_folded_plate_of_flat_faces_is_no_start():
    problem = canopy(10, 1.0, 1.0, (5,))
    problem.vertices[:, 2] = 0.3 - 0.6 * np.abs(problem.vertices[:, 0] - 0.5)
    assert_solved(problem, project(problem), 30)


def test_smoothness_keeps_the_move_smooth_and_nearness_keeps_it_small():
    problem = ring(12, 40, -0.3, 1, 1.5, 0.5, 0.1)
    moves = [project(problem, settings=ProjectionSettings(smoothness=s)).vertices - problem.vertices for s in (0.05, 0.5)]
    near, smooth = (np.linalg.norm(move) for move in moves)
    assert near < smooth
    same = project(problem, settings=ProjectionSettings(nearness=16.0, smoothness=0.1)).vertices
    assert np.allclose(same, problem.vertices + moves[0], atol=1e-9), "only the ratio of the weights counts"


def test_less_smoothness_is_tried_where_the_straight_way_stalls():
    """A wide ring whose metric is so stiff that it folds on the straight way."""
    problem = ring(10, 24, -1.0, 1, 2, 0.6, 0.15)
    straight = project(problem, settings=ProjectionSettings(smoothness=0.15, retry=False))
    assert straight.status != "converged"
    assert_solved(problem, project(problem, settings=ProjectionSettings(smoothness=0.15)), 100)


def test_how_far_free_edges_leave_their_lines_is_told():
    problem = canopy(10, 0.02, 10.0)
    found = project(problem)
    edge = problem.vertices[:, 1] == 0.0
    inwards = float(found.vertices[edge, 1].max())
    told = float(re.search(r"free edges left their drawn lines by up to ([\d.]+) in plan", found.message).group(1))
    assert found.status == "converged" and 0.1 < inwards == pytest.approx(told, rel=1e-3)
    assert "drawn lines" not in project(replace(problem, goals=(EdgeInPlan(),))).message


def test_a_saddle_becomes_a_dome():
    """From K near -0.36 to +0.3, where every least-norm way from the drawing folds the surface."""
    assert_solved(saddle(0.3, 8), project(saddle(0.3, 8), settings=ProjectionSettings(retry=False, measure="defect")), 100)


def test_a_warm_start_takes_few_steps_and_arrives_at_the_same_curvature():
    problem = canopy(44, 0.01, 10.0)
    projector = Projector(problem)
    vertices = projector.solve().vertices
    for factor in (1.05, 1.1, 1.05):
        solution = projector.solve(factor * problem.targets, vertices=vertices)
        assert solution.status == "converged" and solution.iterations <= 5
        vertices = solution.vertices
        assert np.nanmax(np.abs(gaussian_curvature(vertices, problem.faces) - 0.01 * factor)) < 1e-12
