"""Unknown K with a sign, within bounds, and in the ratios that are drawn."""

from __future__ import annotations

import re

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import OnPlane
from compas_cgc import ProblemError
from compas_cgc import Rise
from compas_cgc import Unknown
from compas_cgc import Volume
from compas_cgc import solve
from compas_cgc.linalg.work import Work
from compas_cgc.model.constraint_data import constraint_of
from compas_cgc.model.goals.unknown_text import unknown_data
from compas_cgc.model.goals.unknown_text import unknown_text
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.polish.goal_seeking import seek
from compas_cgc.solvers.polish.settings import PolishSettings

N = 12


def halves(supports="corners", drawn=(0.02, 0.04)):
    """Return a square with a crease along the middle and two drawn K."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=N)
    mesh.set_supports(supports)
    mesh.set_creases([[N // 2 * (N + 1) + i for i in range(N + 1)]])
    for region, K in enumerate(drawn):
        mesh.set_target(K, region=region)
    return mesh


def found(*goals, **options):
    result = solve(halves(**options), goals=goals)
    return result, result.problem.region_targets()


@pytest.mark.parametrize("supports", ["corners", pytest.param("boundary", marks=pytest.mark.nightly)])
def test_a_ratio_is_kept(supports):
    result, (first, second) = found(Rise(0.5), Unknown([0, 1], ratio=True), supports=supports)
    assert result.converged and result.verdict.fair and second == pytest.approx(2.0 * first, rel=1e-12)
    assert result.vertices[:, 2].max() == pytest.approx(0.5, abs=1e-9)


def test_a_ratio_leaves_one_unknown_for_one_goal():
    with pytest.raises(ProblemError, match="at most one height or goal of the whole surface for each region of unknown K"):
        solve(halves(), method="bending", goals=[Rise(0.5), Volume(9.0), Unknown([0, 1], ratio=True)])


def test_what_stops_at_a_bound_is_made_up_for_by_the_others():
    free = found(Rise(1.0), Unknown([0, 1]))[1]
    low = 0.5 * free[1]
    result, bounded = found(Rise(1.0), Unknown([0]), Unknown([1], bounds=[0.001, low]))
    assert result.converged and bounded[1] <= low * (1.0 + 1e-9) and bounded[0] > 1.2 * free[0]
    assert result.vertices[:, 2].max() == pytest.approx(1.0, abs=1e-6)


def test_bounds_that_leave_no_surface_are_named():
    result, K = found(Rise(1.0), Unknown([0, 1], ratio=True, bounds=[0.001, 0.01]))
    assert result.status == "infeasible" and "widen its bounds" in result.message and K[1] <= 0.01 * (1.0 + 1e-9)


def saddle(lifted, *between, n=12):
    """Return a square of 8 m on its corners, of which two are lifted, and on points of its edges."""
    mesh = CGCMesh.from_meshgrid(dx=8.0, nx=n)
    corners = [0, n, (n + 1) ** 2 - 1, n * (n + 1)]
    mesh.set_supports([*corners, *between])
    for key in corners[::2]:
        mesh.vertex_attribute(key, "z", lifted)
    return mesh


@pytest.mark.parametrize("drawn, n", [(-0.005, 12), (-0.001, 8)])
def test_a_rise_above_the_supports_is_found_from_a_k_that_leaves_a_support_the_crown(drawn, n):
    mesh = saddle(2.0, n=n)
    assert solve(mesh, targets=drawn).vertices[:, 2].max() == 2.0
    result = solve(mesh, targets=drawn, goals=[Rise(1.2)], unknown="all")
    assert result.converged and result.verdict.fair and result.vertices[:, 2].max() == pytest.approx(1.0 + 1.2, abs=1e-9)


def test_k_is_found_on_the_surface_of_even_curvature_where_the_one_of_least_bending_is_not_fair():
    mesh = saddle(1.0, 6)
    known = solve(mesh, targets=-0.05)
    assert known.verdict.fair and "evenness" in known.message
    rise = float(known.vertices[:, 2].max()) - 2.0 / 5.0
    result = solve(mesh, targets=-0.05, goals=[Rise(rise)], unknown="all")
    assert result.verdict.fair and result.problem.region_targets() == [pytest.approx(-0.05, rel=1e-6)]
    assert result.message.count("evenness") == 1


def courtyard(length, hole, nx=9, ny=10):
    """Return a flat roof of 12 m by a length around a courtyard, which is given by rows and columns of vertices, on its four corners."""
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=nx, dy=length, ny=ny)
    V, F = mesh.arrays()
    i, j = np.round(V[:, 0] / 12.0 * nx), np.round(V[:, 1] / length * ny)
    inside = (i >= hole[0]) & (i <= hole[1]) & (j >= hole[2]) & (j <= hole[3])
    corners = [k for k in range(len(V)) if i[k] in (0, nx) and j[k] in (0, ny)]
    used, F = np.unique(F[~inside[F].all(axis=1)], return_inverse=True)
    return CGCProblem(V[used], F.reshape(-1, 3)).with_supports(np.searchsorted(used, corners).tolist())


@pytest.mark.parametrize("length, hole, K, drawn", [(12.2, (2, 4, 3, 5), -0.0092, 1.8), (13.9, (2, 5, 2, 4), -0.0091, 1.8)])
def test_a_rise_is_found_where_it_grows_with_a_constant_and_falls_again(length, hole, K, drawn):
    plan = courtyard(length, hole)
    rise = float(solve(plan, targets=K).vertices[:, 2].max())
    result = solve(plan, targets=drawn * K, goals=[Rise(rise)], unknown="all")
    assert result.converged and result.verdict.fair and result.problem.region_targets()[0] < 0.0
    assert result.vertices[:, 2].max() == pytest.approx(rise, abs=1e-6)


def test_of_a_rise_that_is_not_reached_the_largest_on_the_way_is_said():
    plan = courtyard(12.2, (2, 4, 3, 5))
    result = solve(plan, targets=-0.005, goals=[Rise(6.0)], unknown="all")
    reached = float(re.search(r"for the rise 6 the surface reaches ([\d.]+) instead of 6", result.message).group(1))
    assert result.status == "infeasible" and result.vertices[:, 2].max() == pytest.approx(reached, rel=1e-5)
    for K in (-0.005, -0.01):
        assert solve(plan, targets=K).vertices[:, 2].max() < reached


def test_a_search_between_two_surfaces_can_be_cancelled():
    plan, settings = courtyard(12.2, (2, 4, 3, 5)).with_targets(1.8 * -0.0092), PolishSettings()
    whole = seek(plan.with_goals([Rise(2.0435), Unknown()]), settings)
    for steps in range(10, whole.iterations - 10, 40):
        count = iter(range(steps))
        stopped = seek(plan.with_goals([Rise(2.0435), Unknown()]), settings, lambda state, count=count: next(count, None) is None)
        assert stopped.status == "cancelled" and stopped.iterations <= steps + 20


def test_the_sign_may_be_other_than_drawn():
    result, K = found(Rise(0.3), Unknown([0, 1], ratio=True, sign=1), drawn=(-0.02, -0.04))
    assert result.converged and min(K) > 0.0


@pytest.mark.parametrize("method", ["projection", "bending"])
def test_a_ratio_is_kept_beside_a_crease_in_a_plane(method):
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=8)
    mesh.set_supports("corners")
    mesh.set_creases([[4 * 9 + i for i in range(9)]])
    mesh.set_target(0.01, region=0)
    mesh.set_target(0.03, region=1)
    at = [4 * 9 + i for i in range(9)]
    result = solve(mesh, method=method, goals=[Rise(0.5), Unknown([0, 1], ratio=True), OnPlane(at, (3, 0, 0), (1, 0, 0))])
    first, second = result.problem.region_targets()
    assert result.converged and first > 0.0
    assert second == pytest.approx(3.0 * first, rel=1e-9)


def test_a_sign_that_other_goals_do_not_allow_is_no_result():
    mesh = halves("boundary")
    at = [list(mesh.vertices()).index(v) for v in mesh.creases()[0][1:-1]]
    result = solve(mesh, goals=[Rise(0.5), Unknown([0, 1], ratio=True), OnPlane(at, (3, 0, 0), (1, 0, 0))])
    K = np.array(result.problem.region_targets())
    assert (result.converged and (K > 0.0).all()) or (result.status == "infeasible" and "shall be at least 0" in result.message)


@pytest.mark.parametrize(
    "goals, words",
    [
        ([Unknown([0]), Unknown([0, 1], ratio=True)], "two goals Unknown say different things about region 0"),
        ([Unknown([0, 1], ratio=True, bounds=[0.01, 0.015])], "K of regions 0, 1 cannot be between 0.01 and 0.015"),
    ],
)
def test_what_cannot_be_is_said_before_the_solve(goals, words):
    with pytest.raises(ProblemError, match=words):
        solve(halves(), goals=[Rise(0.5), *goals])


@pytest.mark.parametrize(
    "values, words",
    [
        ({"sign": 2}, "must be 1 or -1"),
        ({"bounds": [0.2, 0.1]}, "its least and its largest"),
        ({"bounds": [0.1]}, "its least and its largest"),
        ({"bounds": [-0.2, -0.1], "sign": 1}, "leave no K of the sign 1"),
    ],
)
def test_values_that_make_no_sense(values, words):
    with pytest.raises(ValueError, match=words):
        Unknown([0], **values)


@pytest.mark.parametrize("goal", [Unknown(), Unknown([0, 2], ratio=True), Unknown([1], sign=-1), Unknown("all", True, 1, [0.01, 0.05])])
def test_text_there_and_back(goal):
    assert constraint_of(unknown_data(unknown_text(goal))) == goal


@pytest.mark.parametrize("text", ["", "a", "0 ration", "0 0.1...2x"])
def test_text_that_reads_otherwise(text):
    with pytest.raises(ValueError, match="unknown K cannot be"):
        constraint_of(unknown_data(text))


def test_bounds_scale_with_the_mesh():
    from compas.geometry import Scale

    mesh = halves()
    mesh.set_goals([Rise(0.5), Unknown([0, 1], bounds=[0.001, 0.05])])
    assert mesh.transformed(Scale.from_factors([10.0] * 3)).goals()[1].bounds == pytest.approx([1e-5, 5e-4])


@pytest.mark.parametrize("amount", [1e5, 2e5, 4e5])
def test_a_search_whose_work_is_used_up_ends_with_what_it_reached(amount):
    problem = halves().to_problem().with_goals([Rise(1.0), Unknown([0, 1])])
    with Work(amount).counted():
        solution = seek(problem, PolishSettings())
    assert solution.status == "stalled" and solution.message
