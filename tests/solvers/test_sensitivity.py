"""Derivatives of solved surfaces by K, against central differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import vertex_normals
from compas_cgc.errors import ProblemError
from compas_cgc.model.goals.binding import bind
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.measures import area
from compas_cgc.model.goals.measures import volume
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.measures import measured_curvature
from compas_cgc.model.measures import read_across
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.problem import Drawing
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection.measure import smooth_equations
from compas_cgc.solvers.projection.optimality import optimality
from compas_cgc.solvers.projection.settings import ProjectionSettings
from compas_cgc.solvers.projection.system import System
from compas_cgc.solvers.run import solve
from compas_cgc.solvers.sensitivity import sensitivity

from ..support import shapes


def roof(held: bool, n: int = 12, target: float = 0.004, creased: bool = False) -> CGCProblem:
    vertices, faces = shapes.grid(n, 15.0)
    rim = boundary_vertices(vertices, faces)
    # Mixed areas have a kink at right angles, and so have their derivatives.
    vertices[~rim, :2] += np.random.default_rng(5).uniform(-0.1, 0.1, (np.count_nonzero(~rim), 2))
    roles = np.where(rim, FIXED if held else FREE, INTERNAL)
    roles[[0, n, (n + 1) ** 2 - 1, n * (n + 1)]] = FIXED
    problem = CGCProblem(vertices, faces, roles, target)
    line = [np.flatnonzero(np.arange((n + 1) ** 2) // (n + 1) == n // 2).tolist()]
    return problem.with_creases(line) if creased else problem


def irregular(held: bool, target: float = 0.01) -> CGCProblem:
    vertices, faces = shapes.delaunay_disk(160, radius=5.0)
    rim = boundary_vertices(vertices, faces)
    roles = np.where(rim, FIXED if held else FREE, INTERNAL)
    roles[np.flatnonzero(rim)[::6]] = FIXED
    return CGCProblem(vertices, faces, roles, target)


def fairest(result, targets) -> np.ndarray:
    """Return the fairest surface near to a result for other targets, to rounding, by Newton's method on its optimality.

    In the smooth measure what the layout puts into K is told anew for every step.
    """
    posed = replace(result.problem.with_vertices(result.start), targets=targets)
    local, frame = posed.local()
    system = System(local, ProjectionSettings(), bind(local), found=False)
    vertices, equations = frame.to_local(result.vertices), system.equations(local.targets)
    system = system.touching(system.at(vertices, equations), equations)
    for _ in range(30):
        if result.measure == "smooth":
            equations = smooth_equations(system, system.equations(local.targets), vertices)
        point = system.at(vertices, equations)
        solved = optimality(system, point, equations)
        step = solved.correction(point, equations, solved.multipliers)[0]
        vertices = vertices + step
        if np.abs(step).max() < 1e-12:
            break
    assert np.abs(step).max() < 1e-11
    return frame.to_model(vertices)


def central(result, region: int, part: float = 1e-4) -> np.ndarray:
    own = result.problem.region_vertices(region)
    K = result.problem.targets
    by = part * np.abs(K[own]).max()
    if result.method == "newton":
        ahead, behind = (solve(replace(result.problem, targets=K + sign * by * own), method="newton").vertices for sign in (1, -1))
    else:
        ahead, behind = (fairest(result, K + sign * by * own) for sign in (1, -1))
    return (ahead - behind) / (2 * by)


@pytest.mark.parametrize(
    "problem, goals",
    [
        (roof(held=True), []),
        (roof(held=False), []),
        (roof(held=False, creased=True), []),
        (roof(held=False), [EdgeInPlan(), Clearance((5.5, 0, 9.5, 3), 2.2)]),
    ],
    ids=["newton", "corners", "two regions", "edges and a gate"],
)
def test_against_central_differences(problem, goals):
    result = solve(problem, goals=goals, method="newton" if (problem.roles != FREE).all() else "projection")
    assert result.converged
    found = sensitivity(result)
    x, faces, top = result.vertices, result.faces, int(np.argmax(result.vertices[:, 2]))
    for number, region in enumerate(found.regions):
        difference = central(result, region)
        assert np.abs(found.moves[number] - difference).max() <= 1e-6 * np.abs(difference).max()
        assert found.height[number] == pytest.approx(difference[top, 2], rel=1e-6)
        step = 1e-4 * difference * np.abs(found.targets[number])
        for own, measured in ((found.volume, lambda v: volume(v, faces, 0.0)), (found.area, lambda v: area(v, faces))):
            slope = (measured(x + step) - measured(x - step)) / (2e-4 * np.abs(found.targets[number]))
            assert own[number] == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("held", [True, False], ids=["rim", "supports"])
def test_of_the_fairest_surface_in_the_smooth_measure(held):
    result = solve(irregular(held), method="projection")
    assert result.converged and result.measure == "smooth"
    difference = central(result, 0)
    assert np.abs(sensitivity(result).moves[0] - difference).max() <= 1e-6 * np.abs(difference).max()


def test_newton_moves_change_the_smooth_measure_by_what_is_asked():
    result = solve(irregular(held=True), method="newton")
    assert result.converged and result.measure == "smooth"
    x, asked, moves = result.vertices, result.problem.asked, sensitivity(result).moves[0]
    normals = vertex_normals(x, read_across(result.problem))
    assert np.abs(np.cross(moves, normals)).max() <= 1e-9 * np.abs(moves).max()

    def slope(by: float) -> np.ndarray:
        ahead, behind = (measured_curvature(replace(result.problem, vertices=x + one * moves), "smooth") for one in (by, -by))
        return (ahead - behind)[asked] / (2 * by)

    # Richardson: the error of the quotients goes with the square of the step.
    assert (4 * slope(1e-5) - slope(2e-5)) / 3 == pytest.approx(np.ones(np.count_nonzero(asked)), abs=1e-6)


@pytest.mark.parametrize(
    "held, creased",
    [
        pytest.param([*range(13), *range(156, 169)], False, id="free edges between walls", marks=pytest.mark.nightly),
        pytest.param("boundary", True, id="a crease within a rim", marks=pytest.mark.nightly),
    ],
)
def test_lines_move_as_they_do_between_solves_and_the_surface_between_them_goes_along(held, creased):
    problem = roof(held=False, creased=creased).with_supports(held)
    result = solve(problem)
    assert result.method == "newton" and result.verdict.fair
    found = sensitivity(result)
    for number, region in enumerate(found.regions):
        by = 1e-4 * found.targets[number]
        ahead, behind = (solve(problem.with_targets(found.targets[number] + sign * by, region=region)) for sign in (1, -1))
        difference = (ahead.vertices - behind.vertices)[:, 2] / (2 * by)
        largest, lines = np.abs(difference).max(), ~problem.asked
        assert found.moves[number][lines, 2] == pytest.approx(difference[lines], abs=1e-5 * largest)
        assert found.height[number] == pytest.approx(difference[np.argmax(result.vertices[:, 2])], rel=1e-3)
        assert found.volume[number] == pytest.approx((measured(ahead) - measured(behind)) / (2 * by), rel=1e-3)


def measured(result) -> float:
    return volume(result.vertices, result.faces, 0.0)


def test_the_sentence_says_it_in_the_units_of_the_drawing():
    problem = replace(roof(held=True), drawing=Drawing("roof", "Meters"))
    found = sensitivity(solve(problem))
    lift = 0.01 * found.targets[0] * found.height[0] * 1000
    assert str(found) == f"1 % more K lifts the crown by {lift:.3g} mm" and 5 < lift < 100
    two = sensitivity(solve(roof(held=False, creased=True))).sentences()
    assert len(two) == 2 and "in region 1 lifts the crown by" in two[1]


def test_where_k_was_found_too():
    found = sensitivity(solve(roof(held=True), goals=[Rise(3.0)], unknown=[0]))
    assert found.height[0] > 0 and found.to_dict()["regions"] == [0]
    assert sensitivity(solve(roof(held=False), goals=[Rise(3.0)], unknown=[0])).moves.shape == (1, 169, 3)


def test_of_what_there_are_no_derivatives():
    flow = solve(roof(held=True, n=6), method="flow")
    with pytest.raises(ProblemError, match="derivatives are not available for the method flow"):
        sensitivity(flow)
    with pytest.raises(ProblemError, match="step_limit, not converged"):
        sensitivity(solve(roof(held=False, n=6), settings={"steps": 1}))
