"""Newton's method: surfaces known in closed form, any start, any size, the finish after the flow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize
from scipy.spatial.transform import Rotation

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.discrete import mean_curvature
from compas_cgc.discrete.jacobian import CurvatureEquations
from compas_cgc.errors import MeshError
from compas_cgc.errors import ProblemError
from compas_cgc.linalg.superlu import SuperLU
from compas_cgc.model.dummy_ring import with_dummy_ring
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.result import STATUSES
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.paper.examples import example2
from compas_cgc.paper.examples import example3
from compas_cgc.paper.examples import example4
from compas_cgc.paper.examples import example5
from compas_cgc.solvers.flow import flow
from compas_cgc.solvers.newton import NewtonSettings
from compas_cgc.solvers.newton import newton
from compas_cgc.solvers.newton.damped import damped_newton
from compas_cgc.solvers.newton.system import Step
from compas_cgc.solvers.newton.system import System

from ...support import shapes


def held_at_its_edge(mesh, target):
    vertices, faces = mesh
    return CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), target)


def square(n=20, target=1.0):
    return held_at_its_edge(shapes.grid(n), target)


def lifted(problem, height):
    """Return the problem with z = height(x, y) at its internal vertices."""
    vertices = problem.vertices.copy()
    x, y = vertices[problem.asked, :2].T
    vertices[problem.asked, 2] = height(x, y)
    return replace(problem, vertices=vertices)


def largest_residual(problem, vertices):
    inner = np.flatnonzero(problem.asked)
    return float(np.abs(CurvatureEquations(problem.faces, problem.targets, inner, inner).residual(vertices)).max())


# ----------------------------------------------------------------------
# The surface that comes out
# ----------------------------------------------------------------------


def test_a_flat_mesh_rises_to_a_convex_surface_of_the_curvature_asked_for():
    problem = square()
    solution = newton(problem)
    assert solution.status == "converged", solution.message
    assert largest_residual(problem, solution.vertices) <= 1e-13
    K = gaussian_curvature(solution.vertices, problem.faces)[problem.asked]
    assert np.abs(K - 1).max() == pytest.approx(solution.max_error, rel=1e-3)
    assert solution.max_error <= 1e-11
    assert (mean_curvature(solution.vertices, problem.faces)[problem.asked] > 0.99).all()


def test_what_is_held_stays_bit_for_bit():
    problem = square()
    solution = newton(problem)
    assert np.array_equal(solution.vertices[~problem.asked], problem.vertices[~problem.asked])


@pytest.mark.parametrize("measure, low, high", [("defect", 1.5, 2.6), pytest.param("smooth", 3.4, 5.0, marks=pytest.mark.nightly)])
def test_over_a_disk_it_is_a_cap_of_the_sphere_to_second_order_and_to_fourth_in_the_smooth_measure(measure, low, high):
    """K = 1 / R² over a circle of radius 1 is a cap of the sphere of radius R, on irregular meshes too."""
    K = 0.64
    R = 1 / K**0.5
    counts, errors = (300, 1200, 4800), []
    for count in counts:
        problem = held_at_its_edge(shapes.delaunay_disk(count), K)
        solution = newton(problem, settings=NewtonSettings(measure=measure))
        assert solution.status == "converged" and solution.measure == measure, solution.message
        centre = np.array([0, 0, -np.sqrt(R**2 - 1)])
        errors.append(float(np.sqrt(np.mean((np.linalg.norm(solution.vertices - centre, axis=1) - R) ** 2))))
    order = -2 * np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert low < order < high, (order, errors)


def test_between_two_circles_it_is_a_zone_of_the_sphere():
    R, low = 2**0.5, 1.0

    def height(r):
        return np.sqrt(R**2 - r**2) - np.sqrt(R**2 - low**2)

    errors = []
    for rows in (10, 20):
        radius = np.linspace(low, 0.3, rows)
        cone = height(0.3) * (1 - radius) / 0.7
        solution = newton(held_at_its_edge(shapes.revolution(radius, cone, 6 * rows), 0.5))
        assert solution.status == "converged", solution.message
        errors.append(np.abs(np.linalg.norm(solution.vertices + [0, 0, np.sqrt(R**2 - low**2)], axis=1) - R).max())
    assert errors[0] < 2e-4
    assert errors[0] / errors[1] > 3


@pytest.mark.parametrize("bulge", [0.3, -0.3])
def test_between_two_circles_with_no_curvature_it_is_a_cone(bulge):
    t = np.linspace(0, 1, 20)
    solution = newton(held_at_its_edge(shapes.revolution(3 - 1.5 * t + 4 * bulge * t * (1 - t), 3 * t, 60), 0.0))
    assert solution.status == "converged", solution.message
    assert solution.max_error < 1e-11
    radius = np.hypot(*solution.vertices[:, :2].T)
    assert np.abs(radius - (3 - 0.5 * solution.vertices[:, 2])).max() < 1e-4


def test_an_independent_solver_finds_the_same_surface_from_nearby():
    problem = square(6)
    solution = newton(problem)
    inner = np.flatnonzero(problem.asked)
    equations = CurvatureEquations(problem.faces, problem.targets, inner, inner)

    def residual(z):
        vertices = solution.vertices.copy()
        vertices[inner, 2] = z
        return equations.residual(vertices)

    z = solution.vertices[inner, 2]
    found = optimize.root(residual, z + 1e-3 * np.sin(np.arange(len(z))), method="hybr", tol=1e-13)
    assert np.abs(found.x - z).max() < 1e-8


@pytest.mark.parametrize("n", [5, 10, 30, 100])
def test_the_number_of_steps_hardly_depends_on_the_size(n):
    solution = newton(square(n))
    assert solution.status == "converged", solution.message
    assert solution.iterations <= 9


def test_different_targets_side_by_side_and_a_zero_among_them():
    problem = square(20)
    x, y = problem.vertices[:, 0] - 0.5, problem.vertices[:, 1] - 0.5
    for targets in (np.where(x < 0, 0.1, 2.0), np.where(np.hypot(x, y) < 0.15, 0.0, 1.0)):
        solution = newton(replace(problem, targets=targets))
        assert solution.status == "converged", solution.message


# ----------------------------------------------------------------------
# Starts
# ----------------------------------------------------------------------


STARTS = {
    "dome": lambda x, y: 0.8 * x * (1 - x) * 4 * y * (1 - y),
    "steep dome": lambda x, y: 32 * x * (1 - x) * y * (1 - y),
    "upside down": lambda x, y: -5 * x * (1 - x) * y * (1 - y),
    "noise": lambda x, y: 0.1 * np.random.default_rng(0).normal(size=len(x)),
}


@pytest.mark.parametrize("name", STARTS)
def test_any_start_leads_to_the_convex_surface(name):
    problem = square(20)
    flat = newton(problem)
    solution = newton(lifted(problem, STARTS[name]))
    assert solution.status == "converged", solution.message
    assert solution.vertices[:, 2].max() == pytest.approx(flat.vertices[:, 2].max(), rel=0.02)
    assert (mean_curvature(solution.vertices, problem.faces)[problem.asked] > 0.9).all()


def test_a_vertex_that_leaves_for_good_ends_the_solve_and_the_start_comes_back(monkeypatch):
    def away(system, shape, *_):
        for _ in range(50):
            shape = system.moved(shape, np.eye(len(system.asked))[0], np.array([[0.0, 0.0, 1.0]]))
            yield Step(shape, 1.0, 1)
        return False

    monkeypatch.setattr("compas_cgc.solvers.newton.globalization.damped_newton", away)
    problem = square(6)
    solution = newton(problem, settings=NewtonSettings(start="given"))
    diagonals = 50 / np.linalg.norm(np.ptp(problem.vertices, axis=0))
    assert solution.status == "diverged" and solution.iterations < 0.2 * 50 < diagonals
    assert np.abs(solution.vertices - problem.vertices).max() <= 2.0 * 2**0.5


@pytest.mark.parametrize("n, height", [(6, 2.0), (8, 0.5), (12, 0.2)])
def test_no_step_turns_a_convex_vertex_inside_out(n, height):
    """Beyond that the equation is not elliptic, and a smaller residual leads nowhere."""
    local, _ = lifted(square(n), lambda x, y: 16 * height * x * (1 - x) * y * (1 - y)).local()
    system = System(local, "auto")
    start = system.measure(local.vertices)
    assert (start.mean > 0).all()
    steps = list(damped_newton(system, start, 1e-12, 2**-10))
    assert len(steps) > 1 and min(step.length for step in steps) < 1, "somewhere a whole step would dent it"
    assert all((step.shape.mean > 0).all() for step in steps)


def test_folded_and_degenerate_faces_are_laid_out_anew():
    problem = square(20)
    middle = 10 * 21 + 10
    for place in (problem.vertices[middle + 1], problem.vertices[middle] + [0.08, 0, 0]):
        vertices = problem.vertices.copy()
        vertices[middle] = place
        solution = newton(replace(problem, vertices=vertices))
        assert solution.status == "converged", solution.message


def test_a_curved_boundary():
    problem = square(20)
    x, y, _ = problem.vertices.T
    for height, target in ((0.3 * x * (1 - x), 1.0), (0.3 * ((x - 0.5) ** 2 - (y - 0.5) ** 2), 1.0), (0.8 * x * (1 - x), 0.1)):
        solution = newton(replace(problem, vertices=np.column_stack([x, y, height]), targets=np.full(len(x), target)))
        assert solution.status == "converged", solution.message


def test_a_small_change_of_the_target_needs_a_step_or_two():
    problem, settings = square(40), NewtonSettings(measure="defect")
    solution = newton(problem, settings=settings)
    again = newton(replace(problem, vertices=solution.vertices, targets=1.05 * problem.targets), settings=settings)
    assert again.status == "converged"
    assert again.iterations <= 2


def test_and_about_half_the_steps_where_fits_read_the_corners():
    problem = square(40)
    settings = NewtonSettings(measure="smooth")
    solution = newton(problem, settings=settings)
    again = newton(replace(problem, vertices=solution.vertices, targets=1.05 * problem.targets), settings=settings)
    assert solution.measure == again.measure == "smooth" and again.status == "converged"
    assert again.iterations <= 0.75 * solution.iterations


@pytest.mark.parametrize("n", [20, 40])
def test_a_solved_mesh_is_handed_back_as_it_is(n):
    problem = square(n)
    solution = newton(problem)
    again = newton(replace(problem, vertices=solution.vertices))
    assert again.iterations == 0
    assert np.array_equal(again.vertices, solution.vertices)


def test_scale_and_place_and_orientation_do_not_matter():
    problem = square(12)
    expected = newton(problem)
    turn = Rotation.from_euler("xyz", [0.4, -1.1, 2.0]).as_matrix()
    scale, shift = 20_000.0, np.array([1e6, -2e6, 3e5])
    moved = replace(problem, vertices=problem.vertices @ turn.T * scale + shift, targets=problem.targets / scale**2)
    solution = newton(moved)
    assert solution.status == "converged", solution.message
    assert solution.max_error <= 1e-7 / scale**2
    assert np.abs((solution.vertices - shift) @ turn / scale - expected.vertices).max() < 1e-6


# ----------------------------------------------------------------------
# The finish
# ----------------------------------------------------------------------


def test_the_finish_after_the_flow_holds_the_creases_and_takes_the_regions_to_rounding():
    mesh, settings = example4(centre=4.0, around=1.0, s=1.0, e=2)
    problem = with_dummy_ring(CGCProblem.from_mesh(mesh))
    shaped = flow(problem, settings=settings)
    assert shaped.max_error > 0.05
    finished = newton(replace(problem, vertices=shaped.vertices), settings=NewtonSettings(start="given"))
    assert finished.status == "converged", finished.message
    assert finished.max_error < 1e-12
    moved = np.linalg.norm(finished.vertices - shaped.vertices, axis=1)
    assert moved[problem.roles == CREASE].max() == 0.0
    assert 0 < moved.max() <= 2e-4


@pytest.mark.parametrize("example", [example2, example3, example4, example5])
def test_the_examples_of_the_paper_from_their_own_starts(example):
    mesh, _ = example()
    solution = newton(with_dummy_ring(CGCProblem.from_mesh(mesh)))
    assert solution.status == "converged", solution.message
    assert solution.max_error <= 1e-12


def test_a_given_start_that_is_too_far_is_said_to_be():
    solution = newton(square(), settings=NewtonSettings(start="given"))
    assert solution.status == "stalled"
    assert "an initial surface without flat or folded faces" in solution.message


# ----------------------------------------------------------------------
# What cannot be
# ----------------------------------------------------------------------


def test_negative_curvature_is_left_to_projection():
    solution = newton(square(10, -1.0))
    assert solution.status == "stalled"
    assert "projection" in solution.message


def test_too_much_curvature_is_refused_in_words():
    problem = square(10, 5.0)
    solution = newton(problem)
    assert solution.status == "infeasible"
    assert solution.iterations == 0
    assert "the target 5 is too large for this boundary" in solution.message
    assert np.array_equal(solution.vertices, problem.vertices)


def test_curvature_beyond_what_is_refused_ends_with_the_best_shape():
    for target in (2.9, 3.2):
        problem = square(20, target)
        solution = newton(problem)
        assert solution.status in ("stalled", "diverged")
        assert "smaller K̄" in solution.message
        assert np.isfinite(solution.vertices).all()
        K = gaussian_curvature(solution.vertices, problem.faces)[problem.asked]
        assert np.abs(K - target).max() <= target * (1 + 1e-9)


@pytest.mark.parametrize("target", [0.02, 0.5])
def test_a_plan_with_an_inward_corner_overhangs_there_or_is_given_up_in_words(target):
    """Along an inward corner a surface with K > 0 can only lean out over the edge."""
    vertices, faces = shapes.grid(20, 2.0)
    keep = ~(vertices[faces].mean(axis=1)[:, :2] > 1).all(axis=1)
    used, faces = np.unique(faces[keep], return_inverse=True)
    solution = newton(held_at_its_edge((vertices[used], faces.reshape(-1, 3)), target))
    assert np.isfinite(solution.vertices).all()
    if solution.status == "converged":
        assert (solution.vertices[:, :2].min(axis=1) > 1.02).any()
    else:
        assert "inward corners" in solution.message


def test_a_part_that_is_held_nowhere_is_named():
    vertices, faces = shapes.grid(8)
    ball, ball_faces = shapes.icosphere(2)
    roles = np.concatenate([np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), np.full(len(ball), INTERNAL)])
    problem = CGCProblem(np.vstack([vertices, ball + [5, 0, 0]]), np.vstack([faces, ball_faces + len(vertices)]), roles, 0.5)
    solution = newton(problem)
    assert solution.status == "stalled"
    assert f"vertex {len(vertices)} has no supports" in solution.message


def test_neighbours_of_wildly_different_targets_get_a_status_and_no_nan():
    problem = square(20)
    near = np.hypot(*(problem.vertices[:, :2] - 0.5).T) < 0.1
    solution = newton(replace(problem, targets=np.where(near, 30.0, 1e-3)))
    assert solution.status in STATUSES
    assert np.isfinite(solution.vertices).all()
    assert np.isfinite(solution.max_error)


def test_no_curvature_on_an_open_edge():
    vertices, faces = shapes.grid(4)
    with pytest.raises(MeshError, match="vertex 0 has no closed ring"):
        newton(CGCProblem(vertices, faces, np.full(len(vertices), INTERNAL), 1.0))


def test_no_target_no_solve():
    with pytest.raises(ProblemError, match="vertex 6 is internal but has no target"):
        newton(square(4, np.nan))


def test_nothing_asked_nothing_done():
    vertices, faces = shapes.grid(4)
    solution = newton(CGCProblem(vertices, faces, np.full(len(vertices), FIXED), 1.0))
    assert (solution.status, solution.iterations, solution.max_error) == ("converged", 0, 0.0)


@given(st.integers(0, 10_000), st.floats(0.02, 3.0))
def test_on_any_quadrilateral_it_ends_well_or_says_why(seed, target):
    rng = np.random.default_rng(seed)
    vertices, faces = shapes.grid(8)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + rng.uniform(-0.2, 0.2, (4, 2))
    u, v = vertices[:, :1], vertices[:, 1:2]
    weights = np.hstack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
    problem = held_at_its_edge((np.column_stack([weights @ corners, np.zeros(len(u))]), faces), target)
    solution = newton(problem)
    assert np.isfinite(solution.vertices).all()
    if solution.status == "converged":
        assert largest_residual(problem, solution.vertices) <= 1e-13
    else:
        assert target > 1.0, solution.message
        assert "K̄" in solution.message


# ----------------------------------------------------------------------
# Steps, callbacks, settings
# ----------------------------------------------------------------------


def test_the_history_has_a_row_per_step_and_the_callback_sees_each():
    seen = []
    problem = square(10)
    solution = newton(problem, callback=seen.append)
    history = solution.history
    assert [state.step for state in seen] == list(range(1, solution.iterations + 1))
    assert len(history.max_error) == len(history.trials) == solution.iterations
    assert (history.step_length <= 1).all()
    assert history.max_error[-1] < 1e-10 < history.max_error[0]
    assert np.isfinite(history.energy).all()
    assert seen[-1].max_error == history.max_error[-1]
    assert np.array_equal(seen[0].vertices[~problem.asked], problem.vertices[~problem.asked])


def test_a_callback_cancels():
    def stop(state):
        raise StopIteration

    for callback in (lambda state: True, stop):
        solution = newton(square(10), callback=callback)
        assert (solution.status, solution.iterations) == ("cancelled", 1)
        assert solution.vertices[:, 2].max() > 0


def test_too_few_steps_are_said_to_be():
    solution = newton(square(10), settings=NewtonSettings(steps=2))
    assert (solution.status, solution.iterations) == ("step_limit", 2)
    assert "allow more steps" in solution.message


@pytest.mark.parametrize(
    "bad",
    [
        dict(steps=0),
        dict(tolerance=0.0),
        dict(start="flat"),
        dict(anisotropy=0.5),
        dict(shortest=2.0),
        dict(backend="amg"),
        dict(steps=True),
    ],
)
def test_wrong_settings_are_named(bad):
    with pytest.raises(ValueError, match=next(iter(bad))):
        NewtonSettings(**bad)


def test_settings_go_to_json():
    assert NewtonSettings(**NewtonSettings(steps=7).to_dict()) == NewtonSettings(steps=7)


@pytest.mark.nightly
def test_a_large_mesh_takes_few_factorisations_for_the_surface_that_a_smaller_one_takes_one_a_step_for(monkeypatch):
    made, factorise = [], SuperLU.factorise
    monkeypatch.setattr(SuperLU, "factorise", lambda solver, matrix: made.append(matrix.shape) or factorise(solver, matrix))
    problem = square(110)
    solution = newton(problem)
    few, made[:] = len(made), []
    monkeypatch.setattr(System, "many", False)
    fresh = newton(problem)
    assert solution.status == fresh.status == "converged"
    assert few <= 4 < len(made)
    assert solution.iterations <= fresh.iterations + 1
    assert solution.vertices[:, 2].max() == pytest.approx(fresh.vertices[:, 2].max(), abs=1e-6)
    assert np.abs(gaussian_curvature(solution.vertices, problem.faces)[problem.asked] - 1.0).max() <= 1e-9
