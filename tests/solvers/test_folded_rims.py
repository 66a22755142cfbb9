"""Roofs that are held all round and may fold: one height, whatever the mesh."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CloughTocher2DInterpolator
from scipy.spatial import Delaunay
from scipy.spatial import cKDTree

from compas_cgc import CGCMesh
from compas_cgc import Rise
from compas_cgc import Unknown
from compas_cgc import get
from compas_cgc import read
from compas_cgc import solve
from compas_cgc.model.problem import CGCProblem

SQUARE = [[0.0, 0.0], [15.0, 0.0], [15.0, 15.0], [0.0, 15.0]]
TURN = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
OVAL = np.column_stack([9.0 * np.cos(TURN), 6.0 * np.sin(TURN)])
STRIPS = [[[0.0, y], [15.0, y]] for y in (5.0, 10.0)]
BAYS = [[[x, -6.0 * np.sqrt(1 - (x / 9.0) ** 2)], [x, 6.0 * np.sqrt(1 - (x / 9.0) ** 2)]] for x in (-3.0, 3.0)]


def roof(outline, creases, length: float, K: float) -> CGCMesh:
    mesh = CGCMesh.from_outline(np.array(outline), edge_length=length, creases=[np.array(line) for line in creases])
    mesh.set_supports("boundary")
    mesh.set_target(K)
    return mesh


@pytest.mark.parametrize(
    "outline, creases, lengths",
    [pytest.param(SQUARE, STRIPS, (1.0, 0.9), marks=pytest.mark.nightly), pytest.param(OVAL, BAYS, (1.4, 1.1), marks=pytest.mark.nightly)],
    ids=["square", "oval"],
)
def test_a_folded_roof_over_a_whole_rim_is_fair_and_as_high_on_every_mesh(outline, creases, lengths):
    drawn = [roof(outline, creases, length, 1.0).to_problem() for length in lengths]
    for K in (0.002, 0.004):
        found = [solve(problem.with_targets(K)) for problem in drawn]
        assert all(result.converged and result.verdict.fair for result in found), [str(result.verdict) for result in found]
        heights = [np.ptp(result.vertices[:, 2]) for result in found]
        assert max(heights) < 1.02 * min(heights)
        assert all(result.vertices[:, 2].min() > -1e-9 for result in found)


def bays(n: int, irregular: bool) -> CGCProblem:
    """A unit square that is held all round, with one crease in the middle, K = 1.5; triangles are regular, or random ones."""
    steps = np.linspace(0.0, 1.0, n + 1)
    points = np.column_stack([part.ravel() for part in np.meshgrid(steps, steps, indexing="ij")])
    rim, middle = ((points == 0.0) | (points == 1.0)).any(axis=1), np.abs(points[:, 0] - 0.5) < 1e-9
    if irregular:
        shifts = np.random.default_rng(0).uniform(-0.3, 0.3, points.shape) / n
        shifts[rim] = shifts[middle, 0] = 0.0
        points = points + shifts
    vertices, faces = np.column_stack([points, np.zeros(len(points))]), Delaunay(points).simplices
    faces = faces[np.linalg.norm(np.cross(*(vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2))), axis=1) > 1e-9]
    turned = np.cross(*(vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2)))[:, 2] < 0.0
    faces[turned] = faces[turned][:, ::-1]
    crease = np.flatnonzero(middle)[np.argsort(points[middle, 1])]
    return CGCProblem(vertices, faces, creases=[crease.tolist()]).with_supports("boundary").with_targets(1.5)


def height(problem: CGCProblem, x: float, y: float) -> float:
    """Return the height of a surface over a place, by a smooth interpolation of the vertices nearest to it."""
    near = cKDTree(problem.vertices[:, :2]).query([x, y], 12)[1]
    return float(CloughTocher2DInterpolator(problem.vertices[near, :2], problem.vertices[near, 2])(x, y))


@pytest.mark.parametrize("n", [24, pytest.param(48, marks=pytest.mark.nightly)])
def test_crease_and_bays_are_as_high_on_regular_and_random_triangles(n):
    found = [solve(bays(n, irregular)) for irregular in (False, True)]
    assert all(result.verdict.fair and result.method == "newton" for result in found), [result.message for result in found]
    for place, known in (((0.5, 0.5), 0.1715), ((0.25, 0.5), 0.1746)):
        heights = [height(result.problem, *place) for result in found]
        assert heights == pytest.approx([known] * 2, rel=0.012 if n == 24 else 0.005)


@pytest.mark.parametrize("n", [16, pytest.param(32, marks=pytest.mark.nightly)])
def test_regions_of_different_K_are_as_high_on_every_mesh(n):
    """On the mesh itself the crease would rise from 2.44 to 2.75 between 24 and 96 divisions: bending beside the rim grows without end."""
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=n)
    mesh.set_supports("boundary")
    mesh.set_creases([[(n + 1) * (n // 2) + k for k in range(n + 1)]])
    mesh.set_target(0.02, region=0)
    mesh.set_target(0.03, region=1)
    result = solve(mesh)
    assert result.verdict.fair and result.vertices[:, 2].reshape(n + 1, n + 1)[n // 2].max() == pytest.approx(2.5, rel=0.005)
    goal = solve(mesh, goals=[Rise(2.5), Unknown([1])])
    assert goal.verdict.fair and goal.problem.targets[goal.problem.region_vertices(0) & goal.problem.asked] == pytest.approx(0.02)
    again = solve(mesh, targets=goal.problem.targets)
    assert goal.vertices[:, 2].max() == pytest.approx(2.5, rel=1e-6) and again.vertices[:, 2].max() == pytest.approx(2.5, rel=1e-3)


@pytest.mark.nightly
def test_on_the_other_side_it_is_the_mirror_image_and_a_slider_ends_at_the_surface_of_a_solve():
    facade = read(get("facade.3dm")).to_problem()
    above = solve(facade)
    moved = above.vertices - facade.vertices
    below = solve(facade.with_vertices(facade.vertices - 0.3 * moved * [0.0, 1.0, 0.0]))
    mirrored = facade.vertices + moved * [1.0, -1.0, 1.0]
    assert below.verdict.fair and below.vertices == pytest.approx(mirrored, abs=0.01 * np.abs(moved).max())
    slid, fresh = solve(above, targets=0.011), solve(facade.with_targets(0.011))
    assert slid.vertices == pytest.approx(fresh.vertices, abs=1e-9)


def test_where_the_shape_of_the_drawing_is_kept_no_other_is_put_over_it():
    mesh = roof(SQUARE, STRIPS, 1.3, 0.002)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", -0.01 * x * (15.0 - x) * (1.0 - (y / 7.5 - 1.0) ** 2))
    result = solve(mesh, settings={"keep": "shape"})
    assert "dome" not in result.message and result.vertices[:, 2].max() < 0.1
