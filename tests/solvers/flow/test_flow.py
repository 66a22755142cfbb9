"""The paper's flow: its examples, its line search, its filter, and what goes wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from compas_cgc.discrete import energy_gradient
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.discrete.evaluation import Measure
from compas_cgc.discrete.evaluation import Measurement
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import DUMMY
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.paper.examples import example2
from compas_cgc.paper.examples import example4
from compas_cgc.solvers.flow import FlowSettings
from compas_cgc.solvers.flow import flow
from compas_cgc.solvers.flow.filter import GradientFilter
from compas_cgc.solvers.flow.linesearch import armijo_line_search

from ...support import shapes


def fixed_square(n=9, width=0.9, target=1.0):
    vertices, faces = shapes.grid(n, width)
    rim = (vertices[:, :2] <= 1e-9).any(axis=1) | (vertices[:, :2] >= width - 1e-9).any(axis=1)
    return CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), target)


def problem_of(example):
    mesh, settings = example
    return CGCProblem.from_mesh(mesh), settings


# ----------------------------------------------------------------------
# The surface that comes out
# ----------------------------------------------------------------------


def test_a_newcomer_gives_a_target_and_nothing_else():
    problem = fixed_square()
    solution = flow(problem)
    assert solution.status == "converged"
    inner = problem.asked
    K = gaussian_curvature(solution.vertices, problem.faces)[inner]
    assert np.abs(K - 1).max() <= 1e-6
    assert np.abs(K - 1).max() == pytest.approx(solution.max_error, rel=1e-3)
    assert (solution.vertices[inner, 2] > 0).all()


def test_curvature_is_the_same_as_that_of_a_sphere_over_a_circle():
    """A disk with K = 1 over a circle of radius 0.6 is a cap of the unit sphere."""
    from compas_cgc.paper.examples.plan import hexagonal_disk

    heights = []
    for rings in (6, 12):
        faces, ring, place = hexagonal_disk(rings)
        angle = 2 * np.pi * place / np.maximum(1, 6 * ring)
        r = 0.6 * ring / rings
        vertices = np.column_stack([r * np.cos(angle), r * np.sin(angle), np.zeros(len(r))])
        problem = CGCProblem(vertices, faces, np.where(ring == rings, FIXED, INTERNAL), 1.0)
        solution = flow(problem, settings=FlowSettings(steps=4000))
        assert solution.status == "converged"
        heights.append(solution.vertices[0, 2])
    errors = np.abs(np.array(heights) - (1 - 0.8))
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] > 2.5


def test_supports_and_dummies_come_back_bit_for_bit():
    problem, settings = problem_of(example2())
    solution = flow(problem, settings=settings)
    still = np.isin(problem.roles, [FIXED, DUMMY])
    assert np.array_equal(solution.vertices[still], problem.vertices[still])


def test_same_input_same_bits():
    problem, settings = problem_of(example4(centre=4.0, around=1.0))
    first, second = flow(problem, settings=settings), flow(problem, settings=settings)
    assert np.array_equal(first.vertices, second.vertices)
    assert all(np.array_equal(a, b) for a, b in zip(first.history, second.history))


@hypothesis_settings(max_examples=15)
@given(seed=st.integers(0, 10_000), scale=st.sampled_from([1e-3, 0.37, 1.0, 1000.0]), shift=st.floats(-100, 100))
def test_size_place_and_numbering_change_nothing_but_rounding(seed, scale, shift):
    rng = np.random.default_rng(seed)
    problem = fixed_square(7)
    bumped = problem.vertices + np.where(problem.asked, 0.01 * rng.random(len(problem.roles)), 0.0)[:, None] * [0, 0, 1]
    problem = CGCProblem(bumped, problem.faces, problem.roles, problem.targets)
    order = rng.permutation(len(bumped))
    place = np.argsort(order)
    turn = Rotation.random(random_state=rng)
    other = CGCProblem(
        turn.apply(bumped)[order] * scale + shift * scale,
        rng.permutation(place[problem.faces]),
        problem.roles[order],
        problem.targets[order] / scale**2,
    )
    settings = FlowSettings(steps=30, tolerance=0.0)
    a, b = flow(problem, settings=settings), flow(other, settings=settings)
    back = turn.inv().apply((b.vertices - shift * scale) / scale)[place]
    assert np.abs(back - a.vertices).max() < 1e-9
    assert b.max_error * scale**2 == pytest.approx(a.max_error, rel=1e-6)


def test_s_and_e_of_a_vertex_go_before_the_settings():
    problem, settings = problem_of(example4(s=0.8))
    creases = problem.roles == CREASE
    given = CGCProblem(problem.vertices, problem.faces, problem.roles, problem.targets, s=np.where(creases, 0.5, np.nan))
    asked, _ = problem_of(example4(s=0.5))
    assert np.array_equal(flow(given, settings=settings).vertices, flow(asked, settings=example4(s=0.5)[1]).vertices)
    held = CGCProblem(problem.vertices, problem.faces, problem.roles, problem.targets, e=np.where(creases, 10_000, np.nan))
    assert np.array_equal(flow(held, settings=settings).vertices[creases], problem.vertices[creases])


@pytest.mark.parametrize("e", [0, 1, 5])
def test_a_crease_waits_exactly_as_many_steps_as_it_is_told(e):
    problem, settings = problem_of(example4(centre=4.0, around=1.0, e=e))
    creases, moved = problem.roles == CREASE, []

    def callback(state):
        moved.append(not np.array_equal(state.vertices[creases], problem.vertices[creases]))
        return len(moved) == e + 2

    flow(problem, settings=settings, callback=callback)
    assert moved == [False] * e + [True, True]


def test_the_step_length_and_radius_of_the_paper_scale_with_the_mesh():
    """Table 2's parameters are those of Example 2 on a mesh ten times as large."""
    mesh, settings = example2()
    small = CGCProblem.from_mesh(mesh)
    large = CGCProblem(small.vertices * 10, small.faces, small.roles, small.targets / 100)
    a = flow(small, settings=FlowSettings(steps=50, tolerance=0, mu0=0.1, filter_radius=0.5))
    b = flow(large, settings=FlowSettings(steps=50, tolerance=0, mu0=100.0, filter_radius=5.0))
    assert b.max_error * 100 == pytest.approx(a.max_error, rel=1e-6)
    assert b.history.step_length == pytest.approx(1000 * a.history.step_length, rel=1e-12)


# ----------------------------------------------------------------------
# Energy and line search
# ----------------------------------------------------------------------


@pytest.mark.parametrize("example", [example2(), example4()], ids=["example 2", "example 4"])
def test_every_accepted_step_lowers_the_energy(example):
    problem, settings = problem_of(example)
    history = flow(problem, settings=settings).history
    local, _ = problem.local()
    first = Measure(local.vertices, local.faces, local.face_targets())(local.vertices).energy
    before = np.concatenate([[first], history.energy[:-1]])
    assert history.accepted[:10].any()
    assert (history.energy < before)[history.accepted].all()
    # Where no trial passes, the shortest step is taken; what that costs is no more than the discretisation.
    assert (history.energy - before)[1:].max() < 1e-5 * abs(history.energy[-1])


def test_energy_falls_at_every_one_of_the_steps_that_shape_the_surface():
    problem, settings = problem_of(example2())
    history = flow(problem, settings=settings).history
    assert (np.diff(history.energy[:50]) < 0).all()
    assert history.max_error[49] < 0.1


@pytest.mark.parametrize("kind", ["steiner", "cotangent"])
def test_both_energies_lead_to_the_same_surface(kind):
    solution = flow(fixed_square(), settings=FlowSettings(energy=kind))
    assert solution.status == "converged"
    assert solution.vertices[:, 2].max() == pytest.approx(flow(fixed_square()).vertices[:, 2].max(), rel=1e-3)


def test_measure_is_the_public_energy_and_its_slope_is_the_derivative():
    """With the rim clamped, the slope of Eq. 28 is close to the true derivative along the step."""
    problem, _ = problem_of(example2())
    bent = problem.vertices.copy()
    bent[problem.movable, 2] = 0.1 * np.sin(bent[problem.movable, 0] * 3.4) * np.sin(bent[problem.movable, 1] * 3.4)
    measure = Measure(problem.vertices, problem.faces, problem.face_targets())
    here = measure(bent)
    exact = energy_gradient(bent, problem.faces, measure.weight)[problem.asked]
    ours = ((here.curvature - problem.targets) * here.area)[problem.asked, None] * here.normal[problem.asked]
    assert np.sum(exact * ours) > 0.99 * np.linalg.norm(exact) * np.linalg.norm(ours)


def quadratic(minimum):
    def measure(x):
        return Measurement(x[:, 0], np.ones(len(x)), x, float(((x - minimum) ** 2).sum()))

    return measure


def test_line_search_takes_the_first_step_that_passes_and_says_when_none_does():
    x = np.zeros((1, 3))
    towards = np.array([[1.0, 0, 0]])
    free = np.array([np.inf])
    options = dict(mu0=8.0, tau=0.5, xi=0.01, q=5)
    step = armijo_line_search(quadratic([1.0, 0, 0]), x, towards, 1.0, -2.0, free, **options)
    assert (step.length, step.trials, step.accepted) == (1.0, 4, True)
    bounded = armijo_line_search(quadratic([1.0, 0, 0]), x, towards, 1.0, -2.0, np.array([0.6]), **options)
    assert (bounded.length, bounded.trials, bounded.accepted) == (0.5, 5, True)
    away = armijo_line_search(quadratic([1.0, 0, 0]), x, -towards, 1.0, 2.0, free, **{**options, "xi": 0.5})
    assert (away.length, away.trials, away.accepted) == (0.25, 6, False)
    assert np.array_equal(away.vertices, -0.25 * towards)


# ----------------------------------------------------------------------
# Filter
# ----------------------------------------------------------------------


def dense_filter(points, gradient, sources, rows, radius, power):
    """Eqs. 23-26 word for word, over all pairs."""
    distance = np.minimum(np.linalg.norm(points[:, None] - points[None], axis=2), radius)
    w = ((radius - distance) / radius) ** power
    w[:, ~np.isin(np.arange(len(points)), sources)] = 0
    out = np.zeros_like(gradient)
    total = w[rows].sum(axis=1, keepdims=True)
    out[rows] = (w[rows] / np.where(total > 0, total, 1)) @ gradient
    return out


@given(seed=st.integers(0, 500), power=st.sampled_from([1.0, 2.5, 3.0]), refilter=st.booleans())
def test_filter_is_the_papers_while_the_mesh_moves(seed, power, refilter):
    rng = np.random.default_rng(seed)
    points = rng.random((80, 3))
    sources, rows = np.arange(0, 60), np.arange(0, 70)
    smooth = GradientFilter(sources, rows, np.empty((0, 3), int), radius=0.4, power=power, refilter=refilter)
    start = points.copy()
    for _ in range(6):
        gradient = rng.normal(size=points.shape)
        expected = dense_filter(points if refilter else start, gradient, sources, rows, 0.4, power)
        reached = np.abs(smooth(points, gradient) - expected).max()
        assert reached < 1e-12
        points = points + 0.05 * rng.normal(size=points.shape)


def test_without_a_filter_creases_take_the_mean_of_their_neighbours():
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]])
    smooth = GradientFilter(np.array([1, 2]), np.array([0, 1, 2]), faces, radius=0.0, power=3.0, refilter=True)
    gradient = np.array([[9.0, 9, 9], [1, 0, 0], [3, 0, 0], [50, 50, 50]])
    assert smooth(np.zeros((4, 3)), gradient) == pytest.approx(np.array([[2.0, 0, 0], [1, 0, 0], [3, 0, 0], [0, 0, 0]]))


def test_a_radius_that_reaches_too_many_vertices_is_refused_in_words(monkeypatch):
    monkeypatch.setattr("compas_cgc.solvers.flow.filter.MOST_PAIRS", 1000)
    with pytest.raises(ValueError, match="choose a smaller radius"):
        flow(fixed_square(12), settings=FlowSettings(filter_radius=10.0))


# ----------------------------------------------------------------------
# How it ends
# ----------------------------------------------------------------------


def test_too_much_curvature_inflates_and_is_called_divergence():
    """No surface with K = 4.0 spans a square 10 wide: the flow blows it up until it is stopped."""
    problem = fixed_square(9, 10.0, 4.0)
    solution = flow(problem, settings=FlowSettings(steps=5000))
    assert solution.status == "diverged"
    assert "too large for the boundary" in solution.message
    assert np.isfinite(solution.vertices).all()
    start = np.abs(gaussian_curvature(problem.vertices, problem.faces)[problem.asked] - 4.0).max()
    assert solution.max_error <= start


def test_without_a_filter_the_flow_diverges_and_says_so():
    problem, settings = problem_of(example2(filtered=False))
    solution = flow(problem, settings=settings)
    assert solution.status == "diverged"
    assert "set filter_radius" in solution.message


@pytest.mark.parametrize("steps, status", [(5, "step_limit"), (9, "diverged")])
def test_a_run_that_ends_much_farther_from_its_target_than_it_began_was_not_slow_but_lost(steps, status):
    """Without a filter the error grows: after five steps by 3 %, after nine to the fivefold."""
    problem, settings = problem_of(example2(filtered=False))
    solution = flow(problem, settings=replace(settings, steps=steps))
    assert (solution.status, solution.iterations) == (status, steps)
    reached = np.abs(gaussian_curvature(solution.vertices, problem.faces) - problem.targets)[problem.asked].max()
    assert reached == pytest.approx(solution.max_error, rel=1e-6) and solution.max_error < 1.1 * problem.target_scale


def test_a_step_limit_is_said_and_the_shape_kept():
    solution = flow(fixed_square(), settings=FlowSettings(steps=20))
    assert (solution.status, solution.iterations) == ("step_limit", 20)
    assert "allow more steps" in solution.message
    assert len(solution.history.energy) == 20


@pytest.mark.parametrize("how", ["true", "stop"])
def test_a_callback_sees_every_step_and_cancels(how):
    seen = []

    def callback(state):
        seen.append(state)
        if state.step == 7:
            if how == "stop":
                raise StopIteration
            return True

    solution = flow(fixed_square(), callback=callback)
    assert (solution.status, solution.iterations, len(seen)) == ("cancelled", 7, 7)
    assert [state.step for state in seen] == list(range(1, 8))
    assert np.array_equal(seen[-1].vertices, solution.vertices)
    assert seen[-1].max_error == solution.history.max_error[-1] == solution.max_error


def test_a_solved_shape_is_left_alone():
    problem = fixed_square()
    first = flow(problem)
    again = flow(CGCProblem(first.vertices, problem.faces, problem.roles, problem.targets))
    assert (again.status, again.iterations) == ("converged", 0)


def test_a_mesh_without_inner_vertices_is_left_alone():
    problem = fixed_square(n=1)
    solution = flow(problem, settings=FlowSettings(tolerance=0.0, steps=2))
    assert not problem.asked.any() and np.array_equal(solution.vertices, problem.vertices)
    assert solution.max_error == 0.0 and solution.history.error_norm.tolist() == [0.0, 0.0]


def test_targets_of_zero_are_reached():
    problem = fixed_square(8, 1.0, 0.0)
    vertices = problem.vertices + np.where(problem.asked, 0.02, 0)[:, None] * [0, 0, 1]
    solution = flow(CGCProblem(vertices, problem.faces, problem.roles, problem.targets), settings=FlowSettings(steps=5000, tolerance=1e-4))
    assert solution.status == "converged", solution.message


@pytest.mark.parametrize(
    "wrong, words",
    [
        (dict(steps=0), "steps must be a whole number from 1 up, not 0"),
        (dict(tau=1.0), "tau must be between 0 and 1"),
        (dict(mu0=-1), "mu0 must be a positive number"),
        (dict(mu0=float("nan")), "mu0 must be a positive number"),
        (dict(energy="area"), "one of steiner, cotangent"),
        (dict(s=1.5), "s must be between 0 and 1"),
        (dict(zeta=1.0), "zeta must be greater than 1"),
        (dict(q=2.5), "q must be a whole number"),
    ],
)
def test_settings_are_checked_in_words(wrong, words):
    with pytest.raises(ValueError, match=words):
        FlowSettings(**wrong)
