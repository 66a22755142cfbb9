"""Whatever goes in: a status and a sentence, numbers, the same result for the same problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.errors import MeshError
from compas_cgc.errors import ProblemError
from compas_cgc.model.constraints import Fixed
from compas_cgc.model.constraints import OnCurve
from compas_cgc.model.dummy_ring import with_dummy_ring
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.result import STATUSES
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection import ProjectionSettings
from compas_cgc.solvers.projection import Projector
from compas_cgc.solvers.projection import project

from ...support import shapes
from .test_projection import canopy
from .test_projection import irregular_disk
from .test_projection import nine_regions
from .test_projection import ring
from .test_projection import saddle


def assert_honest(problem: CGCProblem, solution) -> None:
    """A status, a sentence, finite numbers, and nothing moved that may not."""
    assert solution.status in STATUSES
    assert solution.message.startswith(solution.status.replace("step_limit", "not converged"))
    assert "nan" not in solution.message and "\n" not in solution.message
    assert np.isfinite(solution.vertices).all() and np.isfinite(solution.max_error)
    assert all(np.isfinite(np.asarray(column, float)).all() for column in solution.history)
    assert np.array_equal(solution.vertices[~problem.movable], problem.vertices[~problem.movable])


def with_roles(problem: CGCProblem, choose) -> CGCProblem:
    return replace(problem, roles=choose(problem.roles))


def coincident() -> CGCProblem:
    problem = canopy(9, 1.0, 0.9)
    problem.vertices[44] = problem.vertices[45]
    return problem


def nearly_coincident() -> CGCProblem:
    problem = ring(20, 40, 0.0, 1, 1.4, 0.4, 0.05)
    problem.vertices[400] = problem.vertices[401] + 1e-12
    return problem


def with_loose_vertices() -> CGCProblem:
    problem = canopy(9, 1.0, 0.9)
    vertices = np.vstack([problem.vertices, [[5, 5, 5], [6, 6, 6]]])
    return CGCProblem(vertices, problem.faces, np.append(problem.roles, [FREE, INTERNAL]), 1.0)


def two_parts() -> CGCProblem:
    problem = canopy(9, 1.0, 0.9)
    n = len(problem.vertices)
    vertices = np.vstack([problem.vertices, problem.vertices + [3, 0, 0]])
    return CGCProblem(vertices, np.vstack([problem.faces, problem.faces + n]), np.tile(problem.roles, 2), 1.0)


SOLVED = {
    "one triangle": lambda: CGCProblem([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [0, 0, 0], 1.0),
    "all fixed": lambda: with_roles(canopy(5, 1.0, 1.0), lambda roles: np.full_like(roles, FIXED)),
    "internal on the edge": lambda: with_roles(canopy(9, 1.0, 0.9), np.zeros_like),
    "one equation": lambda: with_roles(
        canopy(9, 1.0, 0.9), lambda r: np.where(r == FIXED, FIXED, np.where(np.arange(100) == 44, 0, CREASE))
    ),
    "dummies": lambda: with_dummy_ring(canopy(9, 1.0, 0.9)),
    "loose vertices": with_loose_vertices,
    "two parts": two_parts,
    "tiny target": lambda: canopy(9, 1e-9, 0.9),
    "flat and to stay flat": lambda: canopy(9, 0.0, 0.9),
}
HOPELESS = {
    "huge target": lambda: canopy(9, 1e6, 0.9),
    "wild neighbours": lambda: nine_regions(1000.0, 0.001),
    "no way to move": lambda: CGCProblem(*shapes.icosphere(1), np.full(42, INTERNAL), -1.0),
}


@pytest.mark.parametrize("case", SOLVED)
def test_odd_meshes_are_solved(case):
    problem = SOLVED[case]()
    solution = project(problem)
    assert_honest(problem, solution)
    assert solution.status == "converged", solution.message


@pytest.mark.parametrize("case", HOPELESS)
def test_what_cannot_be_solved_ends_with_a_sentence(case):
    problem = HOPELESS[case]()
    solution = project(problem)
    assert_honest(problem, solution)
    assert solution.status == "stalled" and "the best shape is returned" in solution.message


@pytest.mark.parametrize("problem, face", [(coincident(), "34-44-45"), (nearly_coincident(), "361-401-400")])
def test_a_face_without_area_is_named(problem, face):
    solution = project(problem)
    assert_honest(problem, solution)
    assert solution.status == "converged" or f"the face {face} has hardly any area; repair the mesh there" in solution.message


def test_where_nothing_may_move_that_is_said():
    vertices, faces = shapes.icosphere(1)
    problem = CGCProblem(vertices, faces, np.full(42, INTERNAL), 2.0)
    solution = project(problem.with_goals([Fixed(range(42))]))
    assert_honest(problem, solution)
    assert solution.status == "infeasible" and "all vertices are fixed; release some supports" in solution.message


@pytest.mark.parametrize("target", [-0.2, *(pytest.param(target, marks=pytest.mark.nightly) for target in (-0.3, -0.36))])
def test_a_surface_worse_than_the_input_is_not_passed_over(target):
    problem = saddle(target, 0)
    solution = project(problem)
    assert_honest(problem, solution)
    inside = problem.asked & ~boundary_vertices(problem.vertices, problem.faces)
    before = np.abs(gaussian_curvature(problem.vertices, problem.faces) - target)[inside].max()
    assert (solution.max_error > before * (1 + 1e-9)) == ("of the initial surface" in solution.message)


def test_bad_input_is_refused_in_words():
    with pytest.raises(MeshError, match="the mesh has no faces"):
        project(CGCProblem(np.zeros((0, 3)), np.zeros((0, 3), int), [], 1.0))
    problem = canopy(5, 1.0, 1.0)
    problem.targets[7] = np.nan
    with pytest.raises(ProblemError, match="vertex 7 has no target; give its region a K̄"):
        project(problem)
    projector = Projector(canopy(5, 1.0, 1.0))
    with pytest.raises(ValueError, match=r"vertices must have the shape \(36, 3\), not \(35, 3\)"):
        projector.solve(vertices=np.zeros((35, 3)))
    with pytest.raises(MeshError, match="not a finite number"):
        projector.solve(vertices=np.full((36, 3), np.nan))


@pytest.mark.parametrize(
    "name, value",
    [
        ("steps", 0),
        ("tolerance", -1.0),
        ("nearness", 0.0),
        ("smoothness", float("nan")),
        ("crease_stiffness", 2.0),
        ("retry", "yes"),
    ],
)
def test_settings_without_sense_are_refused(name, value):
    with pytest.raises(ValueError, match=f"{name} must be"):
        ProjectionSettings(**{name: value})


def test_settings_go_into_json():
    assert ProjectionSettings(**ProjectionSettings(steps=7).to_dict()) == ProjectionSettings(steps=7)


def test_limits_and_cancelling():
    problem = canopy(9, 1.0, 0.9)
    few = project(problem, settings=ProjectionSettings(steps=2))
    assert few.status == "step_limit" and few.iterations == 2 and "allow more steps" in few.message
    seen = []
    cancelled = project(problem, callback=lambda state: seen.append(state) or state.step == 2)
    assert cancelled.status == "cancelled" and cancelled.iterations == 2
    assert [state.step for state in seen] == [1, 2] and seen[-1].vertices.shape == problem.vertices.shape
    assert np.array_equal(cancelled.vertices, seen[-1].vertices)

    def stop(state):
        raise StopIteration

    assert project(problem, callback=stop).status == "cancelled"


def test_the_history_tells_every_step():
    solution = project(ring(10, 24, 0.0, 5, 7, 2, 0.25))
    history = solution.history
    assert len(history.energy) == solution.iterations and history.max_error[-1] == solution.max_error
    assert (history.error_norm[1:] < history.error_norm[:-1]).mean() > 0.7
    assert ((history.step_length > 0) & (history.step_length <= 1)).all() and history.step_length[-1] == 1
    assert history.error_norm[-1] < 1e-6 * history.error_norm[-3], "the last two steps gain six digits"


@pytest.mark.parametrize("make", [lambda: ring(10, 24, 0.0, 5, 7, 2, 0.25), lambda: irregular_disk(469)], ids=["drawn", "flat"])
def test_scaling_moving_and_turning_the_model_does_the_same_to_the_result(make):
    problem = make()
    expected = project(problem)
    turn, shift, scale = Rotation.from_rotvec([0.3, -1.0, 0.5]).as_matrix(), np.array([1e4, -2e5, 30.0]), 1000.0
    moved = replace(problem, vertices=scale * problem.vertices @ turn.T + shift, targets=problem.targets / scale**2)
    solution = project(moved)
    assert solution.status == "converged" and solution.iterations == expected.iterations
    back = (solution.vertices - shift) @ turn / scale
    assert np.abs(back - expected.vertices).max() < 1e-5


def test_millimetres_far_from_the_origin_reach_the_same_tolerance():
    problem = canopy(9, 1.0, 0.9)
    far = replace(problem, vertices=1000 * problem.vertices + [1e6, 2e6, 0], targets=problem.targets / 1e6)
    solution = project(far)
    assert solution.status == "converged" and solution.max_error <= 1e-12 * 1e-6


def test_the_same_problem_gives_the_same_bits():
    problem = nine_regions(1, -1)
    projector = Projector(problem)
    first, again, new = projector.solve(), projector.solve(), project(problem)
    assert np.array_equal(first.vertices, again.vertices) and np.array_equal(first.vertices, new.vertices)


def test_constraints_live_in_the_units_of_the_model():
    problem = canopy(10, 0.01, 10.0)
    edge = np.arange(1, 10)
    t = np.linspace(0, np.pi, 40)
    arch = np.column_stack([0 * t, 5 - 5 * np.cos(t), np.sin(t)])
    expected = project(problem.with_goals([OnCurve(edge, arch)])).vertices
    far = replace(problem, vertices=1000 * problem.vertices + 5e5, targets=problem.targets / 1e6)
    solution = project(far.with_goals([OnCurve(edge, 1000 * arch + 5e5)]))
    assert solution.status == "converged"
    assert np.abs((solution.vertices - 5e5) / 1000 - expected).max() < 1e-6
