"""Another K from a result: on from its surface, over its drawing."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Rise
from compas_cgc import read
from compas_cgc import solve
from compas_cgc import write


def roof(n: int = 10) -> CGCMesh:
    mesh = CGCMesh.from_meshgrid(dx=1.0, nx=n)
    mesh.set_supports("corners")
    mesh.set_target(1.0)
    return mesh


def by_result(result, K):
    return solve(result, targets=K)


def by_problem(result, K):
    return solve(result.problem.with_targets(K))


def by_mesh(result, K):
    result.mesh.set_target(K)
    return solve(result.mesh)


def by_copy(result, K):
    mesh = result.mesh.copy()
    mesh.set_target(K)
    return solve(mesh)


@pytest.mark.parametrize("go_on", [by_result, by_problem, by_mesh, by_copy])
def test_a_slider_of_a_result_goes_on_and_comes_back(go_on):
    mesh = roof()
    first = here = solve(mesh)
    for K in (1.5, 2.07, 3.0):
        here = go_on(here, K)
        assert here.converged and here.verdict.fair and "starting from the previous surface" in here.message
        assert np.abs(here.vertices - solve(mesh, targets=K).vertices).max() < 1e-3
    back = go_on(go_on(here, 2.0), 1.0)
    assert np.abs(back.vertices - first.vertices).max() < 1e-6


def test_a_result_solved_again_is_the_result_and_another_K_gives_what_the_drawing_does(tmp_path):
    """Its plan is that of the drawing: the mean normal of a surface on one wall is inclined."""
    canopy = CGCMesh.from_meshgrid(dx=2.0, nx=8, dy=1.0, ny=4)
    canopy.set_supports(range(0, 9 * 5, 5))
    canopy.set_target(0.3)
    result, other = solve(canopy), solve(canopy, targets=0.2)
    assert result.verdict.fair and np.ptp(result.vertices[::5, 2]) == 0.0 < np.ptp(result.vertices[:, 2])
    files = [tmp_path / "roof.json", tmp_path / "roof.3dm"]
    for file in files:
        write(file, result)
    for again in (result, *map(read, files)):
        assert np.array_equal(again.to_problem().drawn.vertices, canopy.to_problem().vertices)
    assert np.array_equal(solve(again).vertices, result.vertices)
    assert np.abs(solve(again, targets=0.2).vertices - other.vertices).max() < 1e-3


def test_what_is_changed_otherwise_is_a_new_drawing():
    creased = roof().to_problem().with_creases([range(110, 121), range(55, 66)])
    assert solve(creased).mesh.to_problem().drawn is not None, "meshes keep creases in another order"
    found = solve(roof())
    other = found.problem.with_targets(1.2)
    assert np.array_equal(other.drawn.vertices, found.start) and other.drawn.drawn is None
    moved = found.vertices.copy()
    moved[0, 2] += 0.1
    for changed in (other.with_vertices(moved), other.with_supports([5], add=True), other.flipped(), other.with_goals([Rise(0.2)])):
        assert changed.drawn is None


def test_where_the_surface_leads_to_no_fair_one_the_drawing_is_solved_anew():
    """From a dome to a saddle: no way leads from one to the other."""
    mesh = roof()
    saddle = solve(solve(mesh), targets=-1.0)
    assert saddle.converged and saddle.verdict.fair, saddle.message
    assert np.abs(saddle.vertices - solve(mesh, targets=-1.0).vertices).max() < 1e-3


@pytest.mark.parametrize("creases", [(), ([10 * 21 + k for k in range(21)],)], ids=["plain", "creased"])
def test_a_saddle_does_not_depend_on_what_was_found_before(creases):
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=20)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", 0.3 * (x + y) - 0.06 * x * y)
    mesh.set_supports("corners")
    mesh.set_creases(list(creases))
    mesh.set_target(-0.02)
    there = solve(solve(mesh), targets=-0.0212)
    assert there.converged and np.abs(there.vertices - solve(mesh, targets=-0.0212).vertices).max() < 1e-6


def test_from_a_surface_of_even_curvature_another_K_is_that_of_the_drawing(tmp_path):
    """Least bending, from where such a surface leads to, is none that the drawing leads to."""
    mesh = CGCMesh.from_meshgrid(dx=2.0, nx=10)
    mesh.set_supports([2, 9, 87, 116, 88])
    mesh.set_target(-0.02)
    even = solve(mesh)
    assert even.verdict.fair and even.evenness == even.problem.origin.evenness == 0.55
    cold = solve(mesh, targets=-0.05).vertices
    files = [tmp_path / "roof.json", tmp_path / "roof.3dm"]
    for file in files:
        write(file, even)
    for again in (even, *map(read, files)):
        assert np.array_equal(solve(again).vertices, even.vertices) and np.array_equal(solve(again, targets=-0.05).vertices, cold)


def test_over_a_fixed_edge_the_drawing_is_solved_by_newtons_method():
    mesh = roof()
    mesh.set_supports("boundary")
    there = solve(solve(mesh), targets=1.4)
    assert there.method == "newton" and np.array_equal(there.vertices, solve(mesh, targets=1.4).vertices)


def test_a_creased_roof_over_a_fixed_edge_ends_at_the_same_surface_from_its_last_one():
    mesh = CGCMesh.from_meshgrid(dx=1.0, nx=20)
    mesh.set_creases([list(range(210, 231))])
    mesh.set_supports("boundary")
    mesh.set_target(0.25)
    there = solve(solve(mesh), targets=0.26)
    assert there.converged and there.vertices == pytest.approx(solve(mesh, targets=0.26).vertices, abs=1e-9)


def test_goals_are_kept_on_the_way():
    mesh = roof()
    mesh.set_goals([Rise(0.27)])
    first = solve(mesh)
    there = solve(first, targets=1.3)
    assert there.converged and there.verdict.fair and there.vertices[:, 2].max() == pytest.approx(0.27, abs=1e-9)
    assert np.abs(solve(there, targets=1.0).vertices - first.vertices).max() < 1e-4
