"""Goals are met by the surface that bends least, with K up to its free edges, at second order on any triangles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import ConstantMeanCurvature
from compas_cgc import sensitivity
from compas_cgc import solve
from compas_cgc.errors import ProblemError
from compas_cgc.model.constraints import Fixed
from compas_cgc.model.constraints import Height
from compas_cgc.model.constraints import Mirror
from compas_cgc.model.constraints import OnLine
from compas_cgc.model.goals.binding import bind
from compas_cgc.model.goals.inequalities import Above
from compas_cgc.model.goals.inequalities import Below
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.inequalities import NearPlane
from compas_cgc.model.goals.inequalities import Within
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.places import Level
from compas_cgc.model.goals.wholes import Area
from compas_cgc.model.goals.wholes import Length
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.polish.polisher import polish

from ...support import shapes

GATE = (5.5, 0.0, 9.5, 3.0)


def roof(n: int = 15, target: float = 0.003, jitter: float = 0.0) -> CGCProblem:
    """A flat square of 15 m on its corners."""
    vertices, faces = shapes.grid(n, 15.0)
    inside = (np.abs(vertices[:, :2] - 7.5) < 7.4).all(axis=1)
    vertices[inside, :2] += jitter * 15.0 / n * np.random.default_rng(n).uniform(-1, 1, (inside.sum(), 2))
    return CGCProblem(vertices, faces, targets=target).with_supports("corners")


def solved(problem: CGCProblem, *goals):
    solution = polish(problem.with_goals(goals))
    assert solution.status == "converged", solution.message
    assert solution.max_error < 1e-12 and solution.verdict.fair
    return solution


def across(n: int) -> list[int]:
    return (np.arange(n + 1) * (n + 1) + n // 2).tolist()


@pytest.mark.parametrize("goal", [Rise(2.5), Rise(-3.5), Height("crown", 4.0), Volume(400.0), Volume(200.0, 1.0), Area(240.0)])
@pytest.mark.parametrize("n", [14, 15])  # with one crown, and with four
def test_a_quantity_of_the_whole_surface_with_k_given(goal, n):
    solution = solved(roof(n), goal)
    (own,) = bind(roof(n).with_goals([goal])).equations
    assert own.value(solution.vertices) == pytest.approx(own.wanted, rel=1e-11)
    flat = roof(n).vertices[:, :2]
    assert np.abs(solution.vertices[:, :2] - flat).max() < 1e-12, "free edges stay over their lines"


@pytest.mark.parametrize("n", [15, 32])  # the second is solved on fewer vertices first, unless the path would lose some
def test_a_path_of_a_length(n):
    V = solved(roof(n), Length(across(n), 17.0)).vertices[across(n)]
    assert np.linalg.norm(np.diff(V, axis=0), axis=1).sum() == pytest.approx(17.0, rel=1e-12)


@pytest.mark.parametrize("goals", [[Volume(400.0)], [Clearance(GATE, 2.5)], [EdgeInPlan(), Rise(3.0)]])
def test_the_answer_does_not_depend_on_the_triangles(goals):
    regular, irregular, fine = (solved(own, *goals).vertices[:, 2].max() for own in (roof(15), roof(15, jitter=0.25), roof(30)))
    assert irregular == pytest.approx(regular, rel=5e-3)
    assert fine == pytest.approx(regular, rel=2e-2)  # edges that supports push and pull converge more slowly


def test_edges_of_a_leaning_drawing_stay_over_their_lines():
    drawn = roof(12)
    leaning = drawn.with_vertices(drawn.vertices + np.outer(0.2 * drawn.vertices[:, 0], [0, 0, 1]))
    V = solved(leaning, Above(0.0)).vertices
    assert np.abs(V[:, :2] - drawn.vertices[:, :2]).max() < 1e-12


def test_the_crown_of_a_surface_of_given_area_is_of_second_order():
    crowns = [float(solved(roof(n), Area(240.0)).vertices[:, 2].max()) for n in (8, 16, 32)]
    assert np.log2((crowns[1] - crowns[0]) / (crowns[2] - crowns[1])) > 1.8


def test_vertices_are_put_to_heights_and_edges_level():
    heights = {7: 1.5, 7 * 16: 1.0, 7 * 16 + 8: 3.3}
    V = solved(roof(), *(Height([vertex], height) for vertex, height in heights.items())).vertices
    assert np.abs(V[list(heights), 2] - list(heights.values())).max() < 1e-11
    V = solved(roof(), Level()).vertices
    sides = [np.arange(1, 15), np.arange(1, 15) * 16, np.arange(1, 15) + 15 * 16]
    assert all(np.abs(V[side, 2]).max() < 1e-11 for side in sides), "at the height of the corners"


@pytest.mark.parametrize("goal", [Below(2.8), Clearance(GATE, 2.6), NearPlane((0, 0, 0), (0, 0, 1), 2.8), Below(3.0, vertices=[119])])
def test_what_presses_against_a_side_touches_it_and_costs_energy(goal):
    plain, pressed = solved(roof()), solved(roof(), goal)
    side = bind(roof().with_goals([goal])).sides[0]
    at = side.candidates(pressed.vertices)
    assert side.goal.slack(plain.vertices[at])[0].min() < -0.05
    assert abs(side.goal.slack(pressed.vertices[at])[0].min()) < 1e-9
    assert pressed.branches[0].energy > plain.branches[0].energy


def test_a_side_that_is_not_reached_changes_nothing():
    site = Within([(-5, -5), (20, -5), (20, 20), (-5, 20)])
    plain, free = solved(roof()), solved(roof(), Below(20.0), Above(-5.0), site)
    assert np.abs(plain.vertices - free.vertices).max() < 1e-12


def test_a_limit_that_turns_a_dome_over_says_so():
    hanging, pressed, asked = (solved(roof(10, K), goal) for K, goal in ((0.0089, Below(3.0)), (0.0089, Below(4.5)), (0.006, Rise(-6.5))))
    assert hanging.vertices[:, 2].max() < 1e-9 and "on the side of the supports opposite to the drawing" in hanging.message
    assert pressed.vertices[:, 2].min() > -1e-9 and "other side" not in pressed.message
    assert asked.vertices[:, 2].min() == pytest.approx(-6.5) and "other side" not in asked.message


def test_other_laws_meet_goals_too():
    result = solve(roof(), laws=ConstantMeanCurvature(0.05), goals=[Below(2.8), Height([7], 0.9)])
    assert result.converged and result.verdict.fair and result.max_error < 1e-12
    assert result.vertices[:, 2].max() == pytest.approx(2.8, abs=1e-9) and result.vertices[7, 2] == pytest.approx(0.9, abs=1e-11)


def test_saddles_stay_above_a_height():
    solution = solved(roof(target=-0.003), Above(0.0))
    assert solution.vertices[:, 2].min() > -1e-9


@pytest.mark.parametrize("target", [0.003, -0.003])
def test_fixed_vertices_stay_where_they_are_drawn(target):
    edge = 7  # in the middle of a free edge
    result = solve(roof(target=target), goals=[Fixed([edge])])
    assert result.method == "bending" and result.verdict.fair and result.max_error < 1e-12
    np.testing.assert_array_equal(result.vertices[edge], roof().vertices[edge])
    supported = solve(roof(target=target).with_supports([*roof().supports, edge]), method="bending")
    assert np.abs(result.vertices - supported.vertices).max() < 1e-9, "as on a support"


SQUARE = [(1, 1), (14, 1), (14, 14), (1, 14)]


@pytest.mark.parametrize("goal", [OnLine([40], (0, 0, 1), (1, 1, 0)), Mirror((7.5, 0, 0), (1, 0, 0)), Within(SQUARE, [40, 16])])
def test_goals_that_moves_along_one_direction_do_not_meet_are_those_of_the_projection(goal):
    with pytest.raises(ProblemError, match="cannot meet all of these goals; use the method projection"):
        polish(roof().with_goals([goal]))


@pytest.mark.parametrize("goals", [[Height([7], 1.5), Below(3.1)], [Volume(400.0), Level()], [Area(240.0)], [Length(across(15), 17.0)]])
def test_derivatives_by_k_hold_places_and_sides_and_go_on_pushing(goals):
    problem = roof().with_goals(goals)
    result = solve(problem, method="bending")
    moves = sensitivity(result).moves[0]

    def on(sign: float) -> np.ndarray:
        """Return the surface for other K, and for the numbers that quantities have there."""
        by = sign * 1e-7
        numbers = [own.value(result.vertices + by * moves) for own in bind(problem).equations]
        names = {Volume: "volume", Area: "area", Length: "length"}
        wanted = [replace(own, **{names[type(own)]: numbers[0]}) if type(own) in names else own for own in goals]
        return polish(problem.with_targets(0.003 + by).with_goals(wanted, add=False), start=result.vertices).vertices

    difference = (on(1.0) - on(-1.0)) / 2e-7
    assert np.abs(moves - difference).max() < 1e-5 * np.abs(difference).max()


def test_what_cannot_be_is_not_called_solved():
    solution = polish(roof(8).with_goals([Clearance(GATE, 40.0)]))
    assert solution.status != "converged" or not solution.verdict.fair
