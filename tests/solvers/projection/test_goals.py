"""Goals are met exactly, together with K, and K is found where it is not given."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.analysis import verdict
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.errors import ProblemError
from compas_cgc.meshing.closest_points import feet_on_polyline
from compas_cgc.model.constraints import Height
from compas_cgc.model.constraints import OnLine
from compas_cgc.model.goals.binding import bind
from compas_cgc.model.goals.inequalities import Above
from compas_cgc.model.goals.inequalities import Below
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.inequalities import NearPlane
from compas_cgc.model.goals.inequalities import Within
from compas_cgc.model.goals.measures import volume
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.places import Level
from compas_cgc.model.goals.places import OnSurface
from compas_cgc.model.goals.wholes import Area
from compas_cgc.model.goals.wholes import Length
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection import ProjectionSettings
from compas_cgc.solvers.projection import project
from compas_cgc.solvers.run import solve

from ...support import shapes

GATE = (5.5, 0.0, 9.5, 3.0)


def roof(target: float = 0.003, n: int = 16, width: float = 15.0) -> CGCProblem:
    """A flat square on its four corners."""
    vertices, faces = shapes.grid(n, width)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[[0, n, (n + 1) ** 2 - 1, n * (n + 1)]] = FIXED
    return CGCProblem(vertices, faces, roles, target)


def nine(n: int = 18, target: float = np.nan) -> CGCProblem:
    """A square on its corners, in nine regions."""
    vertices, faces = shapes.grid(n, 15.0)
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    paths = [np.flatnonzero(k == at).tolist() for k in (i, j) for at in (n // 3, 2 * n // 3)]
    return CGCProblem(vertices, faces, targets=target, creases=paths).with_supports("corners")


def solved(problem: CGCProblem, *goals, **settings):
    solution = project(problem.with_goals(goals), settings=ProjectionSettings(**settings))
    assert solution.status == "converged", solution.message
    assert solution.max_error < 1e-12
    return solution


@pytest.mark.parametrize("goal", [Rise(2.5), Height("crown", 4.0), Volume(400.0), Volume(200.0, 1.0), Area(240.0)])
def test_a_goal_of_the_whole_with_k_given_and_with_k_found(goal):
    for more in ([], [Unknown("all")]):
        problem = roof()
        solution = solved(problem, goal, *more)
        (own,) = bind(problem.with_goals([goal])).equations
        assert own.value(solution.vertices) == pytest.approx(own.wanted, rel=1e-11)
        if more:
            found = np.unique(solution.targets)
            assert len(found) == 1 and f"K = {found[0]:.6g} was found for region 0" in solution.message
            measured = gaussian_curvature(solution.vertices, problem.faces)[problem.asked]
            assert np.abs(measured - found).max() < 1e-13, "that K is the surface's"


def test_a_path_of_a_length():
    path = np.arange(17) * 17 + 8
    solution = solved(roof(), Length(path.tolist(), 17.0), Unknown())
    assert np.linalg.norm(np.diff(solution.vertices[path], axis=0), axis=1).sum() == pytest.approx(17.0, rel=1e-12)


@pytest.mark.parametrize("height, content", [(3.0, 400.0), (4.0, 500.0), (4.0, 450.0)])
def test_nine_unknown_k_for_a_height_and_a_volume(height, content):
    problem = nine(24)
    result = solve(problem, goals=[Height("crown", height), Volume(content)], unknown="all")
    assert result.converged and result.iterations <= 12
    assert result.vertices[:, 2].max() == pytest.approx(height, rel=1e-10)
    assert volume(result.vertices, result.faces, 0.0) == pytest.approx(content, rel=1e-10)
    K = result.problem.region_targets()
    assert None not in K and len(set(K)) > 1
    assert verdict(result.problem, problem.vertices).fair
    assert (
        "9 regions" in result.message and "the goals do not determine K completely, so it is that of the fairest surface" in result.message
    )


def test_of_two_regions_one_is_given():
    problem = nine(12).with_targets(0.004)
    result = solve(problem, goals=[Rise(4.0)], unknown=[4])
    K = result.problem.region_targets()
    assert K[:4] == [0.004] * 4 and K[5:] == [0.004] * 4 and K[4] != 0.004
    assert result.vertices[:, 2].max() == pytest.approx(4.0, abs=1e-8)


def test_a_rise_that_needs_k_of_the_other_sign_is_refused_with_the_range():
    result = solve(nine(12).with_targets(0.004), goals=[Rise(2.0)], unknown=[4])
    assert result.status == "infeasible" and not result.verdict.fair
    assert re.search(
        r"with K > 0 was found that meets the goals: for the rise 2 the surface reaches 3\.\d+ instead of 2", result.message
    ), result.message


def test_without_goals_the_fairest_k_is_none():
    result = solve(roof(), unknown="all")
    assert result.converged and "no goal determines K, so it is that of the fairest surface" in result.message
    assert abs(result.problem.targets[0]) < 1e-15 and np.abs(result.vertices[:, 2]).max() == 0


def test_the_answer_does_not_depend_on_units_or_place():
    one = solve(roof(), goals=[Rise(2.5), Clearance(GATE, 2.0)], unknown="all")
    big = roof().with_vertices(1000 * roof().vertices + [5e4, -2e4, 3e3])
    gate = (5.5e3 + 5e4, -2e4, 9.5e3 + 5e4, 3e3 - 2e4)
    other = solve(big, goals=[Rise(2500.0), Clearance(gate, 2e3 + 3e3)], unknown="all")
    assert one.converged and other.converged
    assert np.abs((other.vertices - [5e4, -2e4, 3e3]) / 1000 - one.vertices).max() < 1e-6
    assert other.problem.targets[0] * 1e6 == pytest.approx(one.problem.targets[0], rel=1e-7)


@pytest.mark.parametrize("raised", [0.1, 0.6, 1.0])
def test_a_gate_stays_clear(raised):
    problem = roof(n=20)
    plain = solved(problem)
    at = bind(problem.with_goals([Clearance(GATE, 1.0)])).sides[0].candidates(plain.vertices)
    height = plain.vertices[at, 2].min() + raised
    solution = solved(problem, Clearance(GATE, height))
    x, y, z = solution.vertices.T
    over = (x >= GATE[0]) & (x <= GATE[2]) & (y >= GATE[1]) & (y <= GATE[3])
    assert over.sum() > 12 and z[over].min() >= height - 1e-9
    assert solution.iterations <= 21
    assert verdict(replace(problem, vertices=solution.vertices), problem.vertices).fair


def test_a_side_that_is_not_reached_changes_nothing():
    problem = roof(n=12)
    plain, free = solved(problem), solved(problem, Below(20.0), Above(-5.0), Within([(-5, -5), (20, -5), (20, 20), (-5, 20)]))
    assert np.abs(plain.vertices - free.vertices).max() < 1e-4, "both are the fairest one"


def test_what_presses_against_a_side_is_worth_it():
    """Complementarity: with the side taken away the surface has less energy and crosses it."""
    problem = roof(n=12)
    top = solved(problem).vertices[:, 2].max()
    low = solved(problem, Below(0.8 * top))
    assert low.vertices[:, 2].max() == pytest.approx(0.8 * top, abs=1e-12)


def test_edges_within_a_site_and_over_their_line():
    problem = roof(target=0.01, n=12)
    rim = np.flatnonzero(problem.roles == FREE)
    line = np.array([(0, 0, 0), (15, 0, 0), (15, 15, 0), (0, 15, 0)], float)

    def off(solution):
        flat = solution.vertices[rim] * [1, 1, 0]
        return np.linalg.norm(feet_on_polyline(flat, line, closed=True)[0] - flat, axis=1).max()

    assert off(solved(problem)) > 0.3
    assert off(solved(problem, EdgeInPlan())) < 1e-12
    path = problem.vertices[:13, :2]
    one = solved(problem, EdgeInPlan(list(range(13)), path))
    assert np.abs(one.vertices[:13, 0]).max() < 1e-12 < off(one)
    site = [(0.1, 0.1), (14.9, 0.1), (14.9, 14.9), (0.1, 14.9)]
    inside = solved(problem, Within(site, rim.tolist()))
    assert (inside.vertices[rim, :2] >= 0.1 - 1e-12).all() and (inside.vertices[rim, :2] <= 14.9 + 1e-12).all()


@pytest.mark.parametrize("given", [False, True], ids=["drawn", "given"])
def test_edges_of_a_steep_court_stay_over_their_lines(given):
    plan = np.array([(0, 0, 0), (14, 0, 0), (14, 5.5, 0), (5.5, 5.5, 0), (5.5, 14, 0), (0, 14, 0)], float)
    heights = {(0, 0): 3, (14, 0): 3, (14, 5.5): 3, (5.5, 14): 3, (0, 14): 3, (14, 2.75): 4, (2.75, 14): 4, (9.75, 5.5): 4, (5.5, 9.75): 4}
    mesh = CGCMesh.from_outline(plan, 1.0, creases=[[[0, 0, 0], [5.5, 5.5, 0]]], points=[(*at, z) for at, z in heights.items()])
    supports = mesh.vertices_near(list(heights))
    for vertex, z in zip(supports, heights.values()):
        mesh.vertex_attribute(vertex, "z", z)
    mesh.set_supports(supports)
    mesh.set_target(0.004)
    result = solve(mesh, goals=[EdgeInPlan(points=plan, closed=True) if given else EdgeInPlan()])
    assert result.verdict.fair
    edge = result.vertices[boundary_vertices(result.vertices, result.faces)] * [1, 1, 0]
    assert np.abs(feet_on_polyline(edge, plan, closed=True)[0] - edge).max() < 1e-9


def test_an_oculus_kept_level_and_round_by_one_goal():
    t = np.linspace(1, 0, 9)
    vertices, faces = shapes.revolution(1.0 + 4.0 * t, 0.0 * t, 40)
    roles = np.full(len(vertices), INTERNAL)
    roles[:40], roles[-40:] = FIXED, FREE
    ring = np.arange(len(vertices) - 40, len(vertices))
    problem = CGCProblem(vertices, faces, roles, 0.03)
    assert np.linalg.norm(solved(problem).vertices[ring, :2], axis=1).max() > 1.05, "it grows by itself"
    level = solved(problem, Level())
    assert np.abs(np.linalg.norm(level.vertices[ring, :2], axis=1) - 1).max() < 1e-9
    assert np.ptp(level.vertices[ring, 2]) < 1e-12 and level.vertices[ring, 2].mean() > 1
    found = solved(problem, Level(), Rise(1.5), Unknown())
    assert np.abs(found.vertices[ring, 2] - 1.5).max() < 1e-11


def test_a_facade_near_its_plane():
    """Twelve by six panels with K of either sign in turn, upright."""
    per, nx, ny = 3, 12, 6
    i, j = np.divmod(np.arange((nx * per + 1) * (ny * per + 1)), ny * per + 1)
    vertices = np.column_stack([i / per, 0.0 * i, j / per])
    a = (np.arange(nx * per)[:, None] * (ny * per + 1) + np.arange(ny * per)).ravel()
    step = ny * per + 1
    faces = np.column_stack([a, a + step + 1, a + step, a, a + 1, a + step + 1]).reshape(-1, 3)
    paths = [np.flatnonzero(i == k * per).tolist() for k in range(1, nx)] + [np.flatnonzero(j == k * per).tolist() for k in range(1, ny)]
    problem = CGCProblem(vertices, faces, creases=paths).with_supports("corners")
    label = problem.regions()
    for region in range(nx * ny):
        x, _, z = vertices[faces[label == region]].mean(axis=(0, 1))
        problem = problem.with_targets(0.02 if (int(x) + int(z)) % 2 else -0.02, region=region)
    free = solved(problem).vertices
    assert np.abs(free[:, 1]).max() > 0.05
    solution = solved(problem, NearPlane((0, 0, 0), (0, 1, 0), 0.05))
    assert np.abs(solution.vertices[:, 1]).max() <= 0.05 + 1e-9
    assert verdict(replace(problem, vertices=solution.vertices), vertices).fair


def test_an_edge_on_a_surface():
    problem = roof(n=12)
    edge = np.flatnonzero((problem.vertices[:, 0] == 0) & (problem.roles == FREE))
    corners = np.array([(0, -5, 0), (0, 20, 0), (3, -5, 10), (3, 20, 10)], float)
    solution = solved(problem, OnSurface(edge, corners, [[0, 1, 2], [1, 3, 2]]))
    x, _, z = solution.vertices[edge].T
    assert np.abs(x - 0.3 * z).max() < 1e-12 and z.max() > 0.5


@pytest.mark.nightly
def test_a_clearance_that_cannot_be_says_how_much_can():
    result = solve(roof(n=10), goals=[Clearance(GATE, 40.0), EdgeInPlan()])
    assert result.status == "infeasible"
    assert "the clearance 40 cannot be met" in result.message and "instead of the clearance 40, about" in result.message


def test_the_smooth_measure_finds_k_too():
    solution = solved(roof(n=12), Rise(2.0), Unknown(), measure="smooth")
    assert solution.vertices[:, 2].max() == pytest.approx(2.0, abs=1e-10)
    sharp = solved(roof(n=12), Rise(2.0), Unknown())
    assert solution.targets[0] == pytest.approx(sharp.targets[0], rel=0.05)


def test_the_problem_of_a_result_keeps_its_goals_and_the_k_that_was_found():
    result = solve(roof(target=np.nan, n=10), goals=[{"kind": "rise", "rise": 2.0}], unknown=[0])
    assert result.problem.goals == (Rise(2.0), Unknown([0]))
    assert np.isfinite(result.problem.targets).all()
    assert result.mesh.region_target(0) == result.problem.targets[0]
    higher = solve(result.problem.with_goals([Rise(2.1), Unknown()], add=False))
    assert higher.converged and higher.vertices[:, 2].max() == pytest.approx(2.1, abs=1e-11)


def test_a_rough_surface_with_goals_tells_why_or_how_much_k_there_can_be():
    """A column level with two others within one region of K > 0: whatever is found there has a fold."""
    problem = roof(target=0.004, n=10)
    roles = problem.roles.copy()
    roles[5 * 11 + 5] = FIXED
    result = solve(replace(problem, roles=roles), goals=[EdgeInPlan()])
    assert result.converged and not result.verdict.fair
    assert "lies on the straight line or plane through the supports" in result.message and "draw a crease through it" in result.message


@pytest.mark.nightly
def test_edges_in_plan_of_a_large_mesh():
    """It is solved on a coarser mesh first, which keeps goals that name no vertices."""
    problem = roof(target=0.004, n=80)
    solution = solved(problem, EdgeInPlan())
    rim = np.flatnonzero(problem.roles == FREE)
    x, y, _ = solution.vertices[rim].T
    assert np.abs(np.minimum(np.minimum(x, 15 - x), np.minimum(y, 15 - y))).max() < 1e-11


def test_places_that_contradict_each_other_are_named():
    problem = roof(n=8)
    at = np.flatnonzero(problem.vertices[:, 0] == 0)[2:4].tolist()
    with pytest.raises(ProblemError, match="the height 3 .* and the height 2 .* contradict each other on the level edge"):
        solve(problem, goals=[Level(at), Height([at[0]], 2.0), Height([at[1]], 3.0)])
    result = solve(problem, goals=[OnLine(at[:1], (0, 4, 5), (1, 0, 0)), Height(at[:1], 2.0)])
    assert not result.converged and "and the height of vertices contradict each other there" in result.message
    away = project(problem.with_goals([EdgeInPlan(at, [(100, 100), (200, 100)])]))
    assert "the edge in plan is out of its reach" in away.message


@pytest.mark.nightly
def test_what_cannot_be_met_is_not_told_to_be_less():
    mesh = CGCMesh.from_meshgrid(dx=15, nx=8)
    mesh.set_supports("corners")
    mesh.set_target(0.005)
    alone = solve(mesh, goals=[Area(1.0)])
    assert alone.status == "infeasible" and "the area 1 cannot be met" in alone.message and "choose another value," in alone.message
    both = solve(mesh, goals=[Area(1.0), Volume(5000.0)], unknown=[0])
    assert both.status == "infeasible" and "remove one of them, or change the value of one" in both.message
