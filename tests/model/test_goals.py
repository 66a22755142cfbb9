"""Goals: their derivatives, their plain data, their frame, and forty that cannot be, each told by its name."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import check
from compas_cgc.discrete import boundary_vertices
from compas_cgc.errors import CGCError
from compas_cgc.errors import ProblemError
from compas_cgc.meshing.closest_on_mesh import nearest_on_mesh
from compas_cgc.meshing.in_outline import inside_outline
from compas_cgc.meshing.in_outline import vertices_over
from compas_cgc.model.constraints import Height
from compas_cgc.model.goals.binding import bind
from compas_cgc.model.goals.guess import guessed
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
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.model.visible import on_held_edges
from compas_cgc.solvers.run import solve

from ..support import shapes

N = 10


def roof(held: bool = False, target: float = 0.005) -> CGCProblem:
    """A flat square of 15 m on its corners, or on its whole edge."""
    vertices, faces = shapes.grid(N, 15.0)
    rim = boundary_vertices(vertices, faces)
    roles = np.where(rim, FIXED if held else FREE, INTERNAL)
    roles[[0, N, (N + 1) ** 2 - 1, N * (N + 1)]] = FIXED
    return CGCProblem(vertices, faces, roles, target)


def shaken(problem: CGCProblem) -> CGCProblem:
    rng = np.random.default_rng(3)
    return problem.with_vertices(problem.vertices + rng.normal(scale=0.3, size=problem.vertices.shape) + [0, 0, 2.0])


WHOLE = [Rise(3.0), Height("crown", 4.0), Volume(300.0), Volume(300.0, level=-1.0), Area(250.0), Length([0, 5, 60], 9.0)]


@pytest.mark.parametrize("goal", WHOLE)
def test_derivatives_of_goals_of_the_whole(goal):
    problem = shaken(roof())
    (own,) = bind(problem.with_goals([goal])).equations
    move = np.random.default_rng(1).normal(size=problem.vertices.shape)
    x, step = problem.vertices, 1e-6
    slope = (own.value(x + step * move) - own.value(x - step * move)) / (2 * step)
    assert np.sum(own.gradient(x) * move) == pytest.approx(slope, rel=1e-7)
    change = (own.gradient(x + step * move) - own.gradient(x - step * move)) / (2 * step)
    assert np.abs(own.curvature_along(x, move) - change).max() <= 1e-6 * max(1.0, np.abs(change).max())


@pytest.mark.parametrize("goal", WHOLE)
def test_the_first_guess_of_an_unknown_k_goes_with_the_square_of_the_size(goal):
    posed = roof().with_goals([goal, Unknown()])
    small = posed.transformed(np.diag([1e-3, 1e-3, 1e-3, 1.0]))
    K, tiny = (np.nanmax(guessed(own).targets) for own in (posed, small))
    assert K not in (0.0, 0.005) and tiny == pytest.approx(1e6 * K, rel=1e-9)


def test_volume_and_area_do_not_ask_which_way_faces_turn():
    problem = shaken(roof())
    for goal in (Volume(300.0, level=0.0), Area(200.0)):
        one, other = (bind(p.with_goals([goal])).equations[0].value(p.vertices) for p in (problem, problem.flipped()))
        assert one == pytest.approx(other) and one > 0


def test_what_is_said_of_a_rise_is_measured_from_the_supports():
    mesh = CGCMesh.from_meshgrid(dx=10, nx=6)
    mesh.set_supports("corners")
    problem = mesh.to_problem()
    problem = problem.with_vertices(problem.vertices + [0.0, 0.0, 100.0]).with_targets(0.001)
    result = solve(problem, goals=[Rise(30.0)], unknown="all")
    assert result.status == "infeasible"
    reached = re.search(r"for the rise 30 the surface reaches ([\d.]+) instead of 30, with K = ", result.message)
    assert reached and float(reached.group(1)) < 30.0


def test_goals_scale_and_move_with_the_model():
    """In the local frame every goal lacks the same part of its number."""
    problem = shaken(roof()).with_goals(WHOLE)
    local, frame = problem.local()
    for own, moved in zip(bind(problem).equations, bind(local).equations):
        lack = own.value(problem.vertices) - own.wanted
        assert moved.value(local.vertices) - moved.wanted == pytest.approx(lack / frame.scale**own.power, rel=1e-9)
    sides = [Above(2.0), Below(3.0), Clearance((5, 5, 8, 9), 2.5), Within([(1, 1), (9, 1), (9, 9)]), NearPlane((0, 0, 2), (0, 0, 1), 0.3)]
    problem = shaken(roof()).with_goals(sides)
    local, frame = problem.local()
    for own, moved in zip(bind(problem).sides, bind(local).sides):
        at = own.candidates(problem.vertices)
        assert np.array_equal(at, moved.candidates(local.vertices)) and len(at)
        slack, inwards = own.goal.slack(problem.vertices[at])
        assert np.allclose(moved.goal.slack(local.vertices[at])[0], slack / frame.scale)
        further = own.goal.slack(problem.vertices[at] + 1e-6 * inwards)[0]
        assert np.allclose(further - slack, 1e-6, atol=1e-9), "the slack grows along the direction inwards"


def test_what_lies_over_a_place():
    vertices, faces = shapes.grid(10, 10.0)
    box = np.array([(2.5, 2.5), (4.5, 2.5), (4.5, 3.5), (2.5, 3.5)])
    within, reaching = vertices_over(vertices, faces, box)
    assert vertices[within, :2].tolist() == [[3, 3], [4, 3]]
    corners = vertices[reaching, :2]
    assert corners.min() == 2 and corners[:, 0].max() == 5 and corners[:, 1].max() == 4 and len(reaching) == 10
    small = np.array([(2.6, 2.1), (2.7, 2.1), (2.7, 2.2)])
    within, reaching = vertices_over(vertices, faces, small)
    assert not len(within) and len(reaching) == 3, "smaller than a face"
    exact = np.array([(2, 2), (4, 2), (4, 4), (2, 4)])
    assert [len(part) for part in vertices_over(vertices, faces, exact)] == [9, 9], "along edges of the mesh nothing else reaches over"
    ell = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)])
    assert inside_outline(np.array([(1, 3), (3, 1), (3, 3)]), ell).tolist() == [True, True, False]


def test_nearest_points_of_a_mesh():
    vertices, faces = shapes.icosphere(3)
    points = np.random.default_rng(0).normal(size=(50, 3))
    nearest, normals = nearest_on_mesh(points, vertices, faces)
    assert np.abs(np.linalg.norm(nearest, axis=1) - 1).max() < 0.02
    outwards = points / np.linalg.norm(points, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", normals, outwards).min() > 0.98


WRONG = {
    "mm for m": ([Rise(4000.0)], {}, "the rise 4000 is far larger than the mesh"),
    "mm for m, crown": ([Height("crown", 4000.0)], {}, "the height 4000 of the crown is far larger"),
    "mm for m, clearance": ([Clearance((5, 5, 8, 8), 2500.0)], {}, "the clearance 2500 is far larger"),
    "mm3 for m3": ([Volume(3e11)], {}, "the volume 3e\\+11 is far larger"),
    "mm2 for m2": ([Area(2.5e8)], {}, "the area 2.5e\\+08 is far larger"),
    "m for km": ([Rise(0.004)], {}, "the rise 0.004 is negligible against the size of the mesh"),
    "two heights": ([Rise(3.0), Height("crown", 4.0)], {}, "the rise 3 and the height 4 of the crown contradict"),
    "two crowns": ([Height("crown", 3.0), Height("crown", 4.0)], {}, "the height 3 of the crown and the height 4 of the crown contradict"),
    "two volumes": ([Volume(300.0), Volume(400.0)], {}, "the volume 300 and the volume 400 contradict"),
    "two areas": ([Area(300.0), Area(400.0)], {}, "the area 300 and the area 400 contradict"),
    "two lengths": ([Length([0, 1, 2], 4.0), Length([0, 1, 2], 5.0)], {}, "the length of a path 4 and the length of a path 5 contradict"),
    "above below": ([Above(3.0), Below(2.0)], {}, "the lowest height 3 and the highest height 2 contradict"),
    "crown over ceiling": ([Rise(3.0), Below(2.0)], {}, "the highest height 2 and the rise 3 contradict each other"),
    "two heights of a vertex": ([Height([60], 2.0), Height([60], 3.0)], {}, "the height 3 .* and the height 2 .* at vertex 60"),
    "a length there and back": ([Length([0, 1, 2], 4.0), Length([2, 1, 0], 5.0)], {}, "a path 4 and the length of a path 5 contradict"),
    "a path that stands still": ([Length([3, 3], 1.0)], {}, "the length of a path 1 names a vertex twice in a row"),
    "planes apart": (
        [NearPlane((0, 0, 0), (0, 0, 1), 1.0), NearPlane((0, 0, 5), (0, 0, -1), 1.5)],
        {},
        "a plane 1 and the distance from a plane 1.5 contradict each other: these planes are 5 apart",
    ),
    "a goal in words": (["rise = 3"], {}, "must be an object with a 'kind'"),
    "a goal without a kind": ([{"rise": 3}], {}, "must be an object with a 'kind'"),
    "true for a number": ([{"kind": "rise", "rise": True}], {}, "must be a finite number"),
    "a unit of its own": ([{"kind": "rise", "rise": 3, "unit": "m"}], {}, "has no field 'unit'; its fields are rise"),
    "half a vertex": ([{"kind": "above", "height": 1, "vertices": [1.5]}], {}, "must be a list of vertices, counted from 0"),
    "clearance over crown": ([Height("crown", 2.0), Clearance((5, 5, 8, 8), 3.0)], {}, "the clearance 3 and the height 2 of the crown"),
    "clearance over ceiling": ([Below(2.0), Clearance((5, 5, 8, 8), 3.0)], {}, "the clearance 3 and the highest height 2 contradict"),
    "vertex over ceiling": (
        [Below(2.0), Height([60], 3.0)],
        {},
        "the height 3 of vertices and the highest .* vertex 60",
    ),
    "vertex under floor": ([Above(2.0), Height([60], 1.0)], {}, "the lowest height 2 and the height 1 of .* vertex 60"),
    "crown under a support": ([Height("crown", -1.0)], {}, "the height -1 of the crown lies below the support at vertex 0"),
    "gate beside the mesh": ([Clearance((100, 100, 104, 103), 2.5)], {}, "lies outside the plan of the mesh"),
    "gate over no region": ([Clearance(7, 2.5)], {}, "over region 7, but the mesh has regions 0 to 0"),
    "support under a clearance": (
        [Clearance((-1, -1, 3, 3), 2.5)],
        {},
        "cannot be met at the support at vertex 0, which violates it by 2.5",
    ),
    "support under a floor": ([Above(2.0, [0, 5])], {}, "the lowest height 2 cannot be met at the support at vertex 0"),
    "support off a plane": (
        [NearPlane((0, 0, 5), (0, 0, 1), 0.4, [0])],
        {},
        "the distance from a plane 0.4 cannot be met at the support at vertex 0",
    ),
    "support outside": ([Within([(1, 1), (9, 1), (9, 9)], [0])], {}, "the outline to stay within cannot be met at the support at vertex 0"),
    "no vertices": ([Above(2.0, [])], {}, "the lowest height 2 names no vertices"),
    "no vertices of a height": ([Height([], 2.0)], {}, "the height 2 of vertices names no vertices"),
    "no edge": ([EdgeInPlan([])], {}, "the edge in plan names no vertices"),
    "no region": ([Unknown([])], {}, "the unknown K names no region"),
    "no such region": ([], {"unknown": [3]}, "names region 3, but the mesh has 1"),
    "no such region by name": ([], {"unknown": "roof"}, "numbers or 'all', not 'roof'"),
    "no such vertex": ([Above(2.0, [999])], {}, "names vertex 999, but the mesh has vertices 0 to 120"),
    "short way": ([Length([0, 5, 10], 10.0)], {}, "the length of a path 10 is shorter than the distance 15 between its fixed ends"),
    "kind with a typo": ([{"kind": "ries", "rise": 3}], {}, "not 'ries'; did you mean 'rise'?"),
    "field with a typo": ([{"kind": "rise", "ris": 3}], {}, "has no field 'ris'; its fields are rise"),
    "field missing": ([{"kind": "clearance", "height": 3}], {}, "needs where; its fields are where, height"),
    "not a number": ([{"kind": "volume", "volume": float("nan")}], {}, "volume of a constraint of kind volume must be a finite number"),
    "a word for a number": ([{"kind": "rise", "rise": "4 m"}], {}, "rise of a constraint of kind rise must be a finite number"),
    "a box of three": ([{"kind": "clearance", "where": [0, 0, 4], "height": 2}], {}, "a box \\[x0, y0, x1, y1\\]"),
    "a box inside out": (
        [{"kind": "clearance", "where": [4, 0, 0, 3], "height": 2}],
        {},
        "a box x0, y0, x1, y1 or a closed polyline",
    ),
    "a word for vertices": ([{"kind": "above", "height": 2, "vertices": "crwn"}], {}, "or 'all', not 'crwn'"),
    "a line of two": ([{"kind": "within", "points": [[0, 0], [1, 0]]}], {}, "the outline to stay within must be 3 or more"),
    "newton with two goals": ([Rise(3.0), Volume(300.0)], {"method": "newton"}, "projection"),
    "flow": ([Rise(3.0)], {"method": "flow"}, "only the method 'newton' or 'projection' or 'bending' supports constraints"),
}


@pytest.mark.parametrize("case", WRONG, ids=list(WRONG))
def test_goals_that_cannot_be_are_told_in_one_sentence(case):
    goals, more, words = WRONG[case]
    with pytest.raises(ValueError, match=words) as caught:
        solve(roof(), goals=goals, **more)
    problems = caught.value.problems if isinstance(caught.value, ProblemError) else [str(caught.value)]
    assert len(problems) == 1 and "\n" not in problems[0]


def test_of_a_fixed_edge():
    with pytest.raises(ProblemError, match="the area 200 must be larger than 225"):
        solve(roof(held=True), goals=[Area(200.0)])
    for goal in (EdgeInPlan(), Level()):
        with pytest.raises(ProblemError, match="the mesh has no free edge"):
            solve(roof(held=True), goals=[goal])
    without = replace(roof(), roles=np.where(roof().roles == FIXED, FREE, roof().roles))
    with pytest.raises(ProblemError, match="measured from the supports, but the mesh has none"):
        solve(without, goals=[Rise(2.0)])


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: Rise(0.0), "rise must be a number other than 0"),
        (lambda: Volume(-1.0), "volume must be a positive number"),
        (lambda: Area(float("nan")), "area must be a positive number"),
        (lambda: Length([1], 2.0), "path of two or more"),
        (lambda: Height("top", 2.0), "a list of vertices or 'crown', not 'top'"),
        (lambda: Above(float("inf")), "height must be a number"),
        (lambda: NearPlane((0, 0, 0), (0, 0, 0), 1.0), "normal of a plane"),
        (lambda: Clearance("gate", 2.0), "could not convert|where of a clearance"),
    ],
)
def test_values_without_sense(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_check_says_the_same():
    (said,) = check(roof().with_goals([Rise(4000.0)]))
    assert said.fatal and "the rise 4000" in said
    assert check(roof(target=np.nan).with_goals([Unknown("all"), Rise(3.0)])) == []


MISNAMED = {
    "Rise takes rise; write": lambda: Rise(),
    "not 'height'": lambda: Rise(height=4),
    "not 'hight'; did you mean 'height'": lambda: Clearance((0, 0, 1, 1), hight=2),
    "vertices of the goal Height must be a list of vertices, not the number 6; write \\[6\\]": lambda: Height(6, 1.0),
    "vertices of the goal Above must be a list of vertices, not the number 6": lambda: Above(1.0, 6),
    "the goal Height names vertex 999": lambda: Height([999], 1.0),
    "from the goal Height": lambda: Height([0], 1.0),
    "not 'rise 4'": lambda: "rise 4",
    "the edge in plan names only one vertex": lambda: EdgeInPlan([4]),
    "excludes the support at vertex": lambda: Within([(0, 0), (5, 0), (5, 5), (0, 5)]),
}


@pytest.mark.parametrize("sentence", MISNAMED)
def test_a_wrong_goal_is_told_by_its_name(sentence):
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=8)
    mesh.set_supports("corners")
    mesh.set_target(0.003)
    with pytest.raises((CGCError, ValueError, TypeError), match=sentence):
        goal = MISNAMED[sentence]()
        solve(mesh, goals=goal if isinstance(goal, (int, str)) else [goal])


def test_of_what_is_far_too_much_the_sentence_names_what_can_be_had():
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=8)
    mesh.set_supports("boundary")
    mesh.set_target(0.003)
    message = solve(mesh, goals=[Volume(90000.0)], unknown="all").message
    had = float(re.search("instead of the volume 90000, about ([0-9.]+) is possible", message).group(1))
    assert 800 < had < 5000, message
    assert solve(mesh, goals=[Volume(0.5 * had)], unknown="all").converged


def corner_roof(K: float, width: float, n: int) -> CGCMesh:
    mesh = CGCMesh.from_meshgrid(dx=width, nx=n)
    mesh.set_supports("corners")
    mesh.set_target(K)
    return mesh


@pytest.mark.nightly
def test_the_clearance_that_can_be_had_is_that_of_a_fair_surface():
    mesh, gate = corner_roof(0.003, 15.0, 12), (5.5, 0.0, 9.5, 3.0)
    message = solve(mesh, goals=[Clearance(gate, 40.0)]).message
    had = float(re.search("instead of the clearance 40, about ([0-9.]+) is possible", message).group(1))
    assert 10 < had < 40 and solve(mesh, goals=[Clearance(gate, had)]).verdict.fair


@pytest.mark.nightly
def test_more_of_a_goal_than_was_asked_for_is_had_instead_of_it():
    message = solve(corner_roof(0.004, 12.0, 9), goals=[Rise(2.0), Volume(600.0)]).message
    told = re.search(r"instead of the rise 2, about ([0-9.]+) is possible with the volume 600;", message)
    assert told and 2 < float(told.group(1)) < 6, message


@pytest.mark.nightly
def test_a_rough_surface_names_the_goal_and_no_crease_where_a_bound_bends_it():
    result = solve(corner_roof(0.004, 12.0, 9), goals=[Below(-6.0)])
    assert not result.verdict.fair and "over these supports with the highest height -6, not even" in result.message
    assert "crease" not in result.message


def test_a_sheet_that_nothing_asks_to_curve_is_flat_and_fair():
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=8)
    mesh.set_supports("boundary")
    mesh.set_target(0.003)
    result = solve(mesh, unknown="all")
    assert result.verdict.fair and result.problem.region_targets() == [0.0]


def test_level_edges_are_held_edges():
    """K is as free along them as along supports: a straight one has none of its own."""
    problem = CGCMesh.from_meshgrid(dx=4, nx=4).to_problem()
    for goal, held in (Level([1, 2, 3]), [1, 2, 3]), (EdgeInPlan([1, 2, 3]), []):
        assert np.flatnonzero(on_held_edges(problem.with_goals([goal]))).tolist() == held
