"""solve(): the choice of a method, the finish, and what both promise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import FlowSettings
from compas_cgc import NewtonSettings
from compas_cgc import ProjectionSettings
from compas_cgc import solve
from compas_cgc.analysis import analyse
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.errors import FINER
from compas_cgc.errors import Remedy
from compas_cgc.model.measures import is_held_all_round
from compas_cgc.model.measures import read_across
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import DUMMY
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.paper.examples import CATALOGUE
from compas_cgc.paper.examples import SurfaceExample
from compas_cgc.paper.examples import example2
from compas_cgc.paper.examples import example3
from compas_cgc.paper.examples import example4
from compas_cgc.solvers.choices import choose
from compas_cgc.solvers.flow import finish
from compas_cgc.solvers.flow import flow
from compas_cgc.solvers.flow.finish import flow_and_finish
from compas_cgc.solvers.newton import newton
from compas_cgc.solvers.registry import METHODS
from compas_cgc.solvers.running import run_method

from ..support import shapes
from ..system.fairness_study import case

EXAMPLES = [e for e in CATALOGUE if isinstance(e, SurfaceExample) and e.variant != "nofilter"]


def dome(target=0.01, n=9):
    mesh = CGCMesh.from_meshgrid(dx=9, nx=n)
    mesh.set_supports("boundary")
    mesh.set_target(target)
    return mesh


def vault():
    mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    mesh.set_supports("corners")
    mesh.set_creases([[10 * i + 4 for i in range(10)]])
    mesh.set_target(0.01)
    return mesh


# ----------------------------------------------------------------------
# Every example to rounding
# ----------------------------------------------------------------------


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_auto_takes_every_example_to_rounding(example):
    mesh, _ = example.build()
    result = solve(mesh)
    assert result.converged, result.message
    assert result.max_error <= 1e-10
    for v in mesh.supports():
        assert result.mesh.vertex_coordinates(v) == mesh.vertex_coordinates(v)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_the_papers_strategies_end_at_rounding_with_the_finish(example):
    mesh, settings = example.build()
    shaped = solve(mesh, settings=settings)
    finished = solve(mesh, settings=replace(settings, finish=True))
    assert (shaped.method, finished.method) == ("flow", "flow")
    assert finished.converged and finished.max_error <= 1e-10, finished.message
    for v in mesh.vertices_where_role("crease"):
        assert finished.mesh.vertex_coordinates(v) == shaped.mesh.vertex_coordinates(v), "the finish must not move a crease"


def test_the_finish_moves_a_nearly_solved_surface_by_next_to_nothing():
    """Example 4 with mixed targets is 0.12 off after the paper's steps of S2 with e = 2."""
    mesh, settings = example4(centre=4.0, around=1.0, s=1.0, e=2)
    before = solve(mesh, settings=settings)
    after = solve(mesh, settings=replace(settings, finish=True))
    assert before.max_error > 0.1 and after.max_error < 1e-11
    assert np.abs(after.mesh.arrays()[0] - before.mesh.arrays()[0]).max() < 2e-4


def test_the_flow_hands_over_as_soon_as_the_creases_rest():
    mesh, settings = example4(centre=4.0, around=1.0)
    settings = replace(settings, tolerance=1e-6, steps=3000)
    alone = solve(mesh, settings=settings)
    both = solve(mesh, settings=replace(settings, finish=True))
    assert alone.converged and both.converged
    assert both.iterations < 0.7 * alone.iterations and both.max_error < 1e-6 * alone.max_error
    assert np.abs(both.mesh.arrays()[0] - alone.mesh.arrays()[0]).max() < 2e-4
    assert len(both.history.energy) == both.iterations


@pytest.mark.parametrize("own", [True, False], ids=["of the creases", "of the settings"])
def test_creases_that_have_waited_do_not_wait_again_when_the_flow_goes_on(monkeypatch, own):
    """Newton's method is made to stall at the handover; the delay was e = 10 steps."""
    monkeypatch.setattr(finish, "newton", lambda *given, **more: real(*given, **more)._replace(status="stalled"))
    real = newton
    problem = CGCProblem.from_mesh(example4(centre=4.0, around=1.0)[0])
    creases = problem.roles == CREASE
    if own:
        problem = replace(problem, e=np.where(creases, 10, np.nan))
    settings = FlowSettings(tolerance=1e-5, e=0 if own else 10)
    handover = flow(problem, settings=replace(settings, tolerance=1e-3)).iterations
    places = {}

    def callback(state):
        # The last word on a step is that of the flow: what the finish did was not taken.
        places[state.step] = state.vertices[creases]

    solution = flow_and_finish(problem, settings=settings, callback=callback)
    assert solution.iterations > handover + 2 and solution.status == "stalled"
    still = [step for step in range(2, solution.iterations) if np.array_equal(places[step], places[step - 1])]
    assert [step for step in still if step <= handover] == list(range(2, 11))
    assert handover + 2 not in still


# ----------------------------------------------------------------------
# The choice
# ----------------------------------------------------------------------


def negative():
    mesh = vault()
    mesh.set_target(-0.01)
    return mesh


def strategic():
    mesh = vault()
    mesh.set_strategy(s=0.5)
    return mesh


CHOICES = [
    (dome, None, ["newton", "newton", "bending"]),
    (vault, None, ["bending"]),
    (lambda: dome(0.0), None, ["projection", "bending"]),
    (negative, None, ["bending"]),
    (strategic, None, ["flow", "bending"]),
    (vault, FlowSettings(), ["flow"]),
    (vault, NewtonSettings(), ["newton"]),
    (dome, ProjectionSettings(), ["projection"]),
]


@pytest.mark.parametrize("make, settings, methods", CHOICES)
def test_the_method_suits_the_problem_and_is_said(make, settings, methods):
    mesh = make()
    choices = choose(CGCProblem.from_mesh(mesh), settings)
    assert [choice.method for choice in choices] == methods
    result = solve(mesh, settings=settings)
    if result.method == methods[0]:
        assert f"; by the method {methods[0]}, as {choices[0].reason}" in result.ending


def test_the_next_method_is_tried_when_one_stalls(monkeypatch):
    """Newton's method is made to stall by a start that it may not leave."""
    import compas_cgc.solvers.selection as auto

    stalled = []

    def run(method, problem, *, settings, callback, options):
        if method.name == "newton":
            stalled.append(run_method(method, problem, settings=NewtonSettings(steps=1), callback=callback))
            return stalled[-1]
        return run_method(method, problem, settings=settings, callback=callback, options=options)

    run_method = auto.run_method
    monkeypatch.setattr(auto, "run_method", run)
    result = solve(dome())
    assert len(stalled) == 2 and all(solution.status != "converged" for solution in stalled)
    assert result.converged and result.method == "bending"
    assert f"(newton {stalled[0].status})" in result.message


def test_when_no_method_converges_the_best_surface_is_returned_with_a_remedy():
    """A surface with K < 0 stays within the convex hull of its edge, here a plane."""
    mesh = CGCMesh.from_meshgrid(dx=2, nx=6)
    mesh.set_supports("boundary")
    mesh.set_target(-0.2)
    result = solve(mesh)
    assert not (result.converged and result.verdict.fair) and "no surface has K < 0 within this edge" in result.message
    assert Remedy("scale", -1.0) in result.ending.remedies


def test_a_column_level_with_those_beside_it_along_a_free_edge_is_what_makes_a_dome_rough():
    """A dome above the line of three columns would be straight between them, whatever its K."""
    n = 12
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=n)
    mesh.set_supports([0, n, n * (n + 1), (n + 1) ** 2 - 1, n // 2])
    mesh.set_target(0.003)
    level = solve(mesh)
    assert not level.verdict.fair and f"its support at vertex {n // 2} lies on the straight line" in level.message
    assert Remedy("release", [n // 2]) in level.ending.remedies
    mesh.vertex_attribute(n // 2, "z", 1.5)
    assert solve(mesh).verdict.fair


def test_where_the_mesh_is_too_coarse_that_is_said_and_not_that_the_supports_carry_nothing():
    """A dome over a hexagon on 91 vertices is wavy beside the straight edges, along which no K > 0 is smooth."""
    turns = 2.0 * np.pi * np.arange(7) / 6.0
    mesh = CGCMesh.from_outline(4.3 * np.column_stack([np.cos(turns), np.sin(turns)]), edge_length=0.8)
    mesh.set_supports("boundary")
    mesh.set_target(0.0083)
    coarse = solve(mesh)
    assert not coarse.verdict.fair and "mesh the drawing finer" in coarse.message and FINER in coarse.ending.remedies
    assert solve(mesh.subdivided("corner")).verdict.fair


def test_of_several_that_stall_the_nearest_is_returned(monkeypatch):
    import compas_cgc.solvers.selection as auto

    errors, tried = {"newton": 0.3, "bending": 0.1}, []

    def run(method, problem, **given):
        tried.append(method.name)
        return run_method(method, problem, **given)._replace(status="stalled", max_error=errors[method.name])

    run_method = auto.run_method
    monkeypatch.setattr(auto, "run_method", run)
    monkeypatch.setattr(auto, "why_not_found", lambda *given: "")
    result = solve(dome())
    assert tried == ["newton", "newton", "bending"]
    assert (result.method, result.max_error) == ("bending", 0.1) and result.message.endswith("(newton stalled)")


@pytest.mark.parametrize("end", ["infeasible", "cancelled"])
def test_what_cannot_be_or_is_not_wanted_is_not_tried_by_another_method(monkeypatch, end):
    import compas_cgc.solvers.selection as auto

    tried = []
    run_method = auto.run_method
    monkeypatch.setattr(
        auto,
        "run_method",
        lambda method, problem, **given: tried.append(method.name) or run_method(method, problem, **given)._replace(status=end),
    )
    assert solve(dome()).status == end and tried == ["newton"]


def test_the_largest_error_is_that_of_the_mesh_returned():
    for method in ("flow", "newton", "projection"):
        result = solve(dome(), method=method)
        vertices, faces = result.mesh.arrays()
        inner = [i for i, v in enumerate(result.mesh.vertices()) if result.mesh.vertex_role(v) == "internal"]
        error = np.abs(gaussian_curvature(vertices, faces)[inner] - 0.01).max()
        assert result.converged and error <= max(1e-12, 2 * result.max_error), method


@pytest.mark.nightly
def test_what_the_smooth_measure_reads_once_more_is_said():
    """It stands still where K < 0 too; of a surface where it does not the message says how far K is off."""
    found = solve(case(4016).problem, method="projection")
    assert found.converged and found.measure == "smooth" and "once more" not in found.message
    assert np.nanmax(np.abs(found.curvature - found.problem.targets)) < 1e-7
    moved = found.vertices + 1e-3 * np.sin(3.0 * found.vertices)
    other = replace(found, problem=found.problem.with_vertices(moved))
    off = np.abs(other.curvature - other.problem.targets)[other.problem.asked]
    assert off.max() > 1e-3
    assert f"the error of K is {np.median(off):.2g} (median) and {off.max():.2g} (largest)" in other.message


def test_all_methods_find_the_same_dome():
    heights = {method: max(solve(dome(), method=method).mesh.vertices_attribute("z")) for method in ("flow", "newton", "projection")}
    assert heights["newton"] == pytest.approx(heights["flow"], rel=2e-3)
    assert heights["projection"] == pytest.approx(heights["flow"], rel=2e-3)


# ----------------------------------------------------------------------
# Hard cases
# ----------------------------------------------------------------------


def test_an_irregular_disk_meets_its_targets_and_the_sphere():
    """Solving for the defect on an irregular mesh still gives the cap of the sphere."""
    vertices, faces = shapes.delaunay_disk(2000)
    mesh = CGCMesh.from_vertices_and_faces(vertices, faces)
    mesh.set_supports("boundary")
    mesh.set_target(0.5)
    result = solve(mesh)
    radius = 2**0.5
    height = radius - (radius**2 - 1) ** 0.5
    assert result.converged and max(result.mesh.vertices_attribute("z")) == pytest.approx(height, abs=2e-3)


def test_regions_of_every_sign_side_by_side():
    mesh = CGCMesh.from_meshgrid(dx=12, nx=12)
    mesh.set_supports("corners")
    mesh.set_creases([[13 * i + k for i in range(13)] for k in (4, 8)])
    for region, K in enumerate((0.02, 0.0, -0.02)):
        mesh.set_target(K, region=region)
    result = solve(mesh)
    assert result.converged and result.max_error < 1e-12
    report = analyse(result.mesh)
    assert [r.total_curvature for r in report.regions] == pytest.approx([0.02, 0.0, -0.02], abs=1e-3)


def test_a_vertex_is_drawn_to_a_height():
    from compas_cgc.model.constraints import Height

    mesh = vault()
    key = 44
    index = list(mesh.vertices()).index(key)
    result = solve(mesh, goals=[Height([index], 1.25)])
    assert result.converged and result.mesh.vertex_coordinates(key)[2] == pytest.approx(1.25, abs=1e-9)
    assert result.method == "bending" and "and meets the goals" in result.message


@pytest.mark.parametrize("method", ["flow", "newton", "projection", "auto"])
def test_every_method_can_be_watched_and_cancelled(method):
    seen = []

    def callback(state):
        seen.append(state)
        return state.step == 2

    mesh = dome()
    result = solve(mesh, method=method, settings=None, callback=callback)
    assert result.status == "cancelled" and [state.step for state in seen] == [1, 2]
    assert seen[0].vertices.shape == (100, 3)
    assert np.isfinite(result.mesh.arrays()[0]).all()


@pytest.mark.parametrize("method", ["flow", "newton", "projection", "auto"])
def test_a_callback_sees_the_vertices_of_the_model_and_none_that_carry_a_free_edge(method):
    problem = CGCProblem.from_mesh(example3()[0])
    real = problem.roles != DUMMY
    assert 0 < real.sum() < len(real)
    seen = []
    solution = solve(problem, method=method, callback=lambda state: seen.append(state.vertices) or len(seen) == 3)
    fixed = (problem.roles == FIXED)[real]
    assert seen and len(solution.vertices) == real.sum()
    for vertices in seen:
        assert vertices.shape == (real.sum(), 3) and np.array_equal(vertices[fixed], problem.vertices[real][fixed])
    if solution.status == "cancelled":
        moved = problem.roles[real] == INTERNAL
        assert np.abs(seen[-1] - solution.vertices)[moved].max() < np.abs(seen[0] - problem.vertices[real])[moved].max()


def test_faces_outside_a_fixed_rim_change_nothing():
    mesh = example2()[0]
    drawn, real = mesh.to_problem(), mesh.to_problem().without_dummies()
    assert is_held_all_round(drawn) and len(drawn.vertices) > len(real.vertices)
    faces = read_across(drawn)[drawn.real_faces]
    places, same = drawn.vertices[faces], real.vertices[read_across(real)]
    assert np.array_equal(places, same)  # the same corners are turned
    one, other = solve(mesh), solve(real)
    assert one.method == other.method == "newton"
    assert np.array_equal(one.vertices, other.vertices)


def test_settings_and_constraints_of_another_method_are_refused_in_words():
    from compas_cgc.model.constraints import Height

    with pytest.raises(ValueError, match="the method 'newton' takes NewtonSettings, not FlowSettings"):
        solve(dome(), method="newton", settings=FlowSettings())
    with pytest.raises(ValueError, match="only the method 'projection' or 'bending' supports constraints"):
        solve(dome(), method="flow", goals=[Height([0], 1.0)])
    with pytest.raises(ValueError, match="auto, flow, newton, projection, bending"):
        solve(dome(), method="best")


def test_what_is_fixed_stays_bit_for_bit_with_every_method():
    problem = CGCProblem.from_mesh(dome())
    for method in ("flow", "newton", "projection"):
        solution = run_method(METHODS[method], problem)
        assert np.array_equal(solution.vertices[problem.roles == FIXED], problem.vertices[problem.roles == FIXED])


def test_a_diverged_flow_is_not_finished():
    problem = CGCProblem.from_mesh(example4(centre=400.0, around=400.0)[0])
    solution = flow_and_finish(problem, settings=FlowSettings(steps=400))
    assert solution.status in ("diverged", "step_limit", "stalled")
    assert np.isfinite(solution.vertices).all() and (problem.roles == CREASE).any()


def test_a_free_edge_that_draws_in_is_told_with_the_part_of_the_plan_that_is_kept():
    disc = CGCMesh.from_outline(9.0 * np.array([(np.cos(a), np.sin(a)) for a in np.linspace(0.0, 2 * np.pi, 40, endpoint=False)]), 1.5)
    for key in disc.vertices():
        x, y, _ = disc.vertex_coordinates(key)
        disc.vertex_attribute(key, "z", 2.0 + 1.2 * (x * x - y * y) / 81.0)
    disc.set_supports([key for key in disc.vertices_on_boundary() if disc.vertex_coordinates(key)[0] < 2.0])
    disc.set_target(-0.01)
    curled = solve(disc, method="projection")
    drawn = disc.to_problem()
    before, after = (shapes.plan_area(V, drawn.faces) for V in (drawn.vertices, curled.vertices))
    share = after / before
    assert share < 0.75 and f"covering {100 * share:.0f} % of the drawn plan" in curled.message
    disc.set_target(-0.001)
    assert "of the drawn plan" not in solve(disc).message
