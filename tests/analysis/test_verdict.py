"""What is fair and what is not, on surfaces that everybody would agree on."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.analysis import analyse
from compas_cgc.analysis import verdict
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import vertex_normals
from compas_cgc.io.reading import ReadProblem
from compas_cgc.io.summary import describe
from compas_cgc.model.problem import CREASE
from compas_cgc.model.problem import FIXED
from compas_cgc.model.problem import FREE
from compas_cgc.model.problem import INTERNAL
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.problem import Drawing
from compas_cgc.model.verdict import MAX_ERROR_90
from compas_cgc.model.verdict import MAX_OTHER_SIDE
from compas_cgc.model.verdict import MAX_WAVINESS_95
from compas_cgc.solvers.polish.polisher import polish

from ..support import shapes
from ..system.fairness_study import known_case


def cap(n: int = 20, target: float = 1.0) -> CGCProblem:
    """A square piece of the unit sphere."""
    vertices, faces = shapes.grid(n)
    x, y = vertices[:, :2].T - 0.5
    vertices[:, 2] = np.sqrt(1 - x**2 - y**2)
    return CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), target)


def shaken(problem: CGCProblem, by: float) -> CGCProblem:
    noise = by * np.random.default_rng(0).normal(size=problem.vertices.shape)
    return replace(problem, vertices=problem.vertices + np.where(problem.asked[:, None], noise, 0.0))


def test_a_sphere_is_fair_and_its_numbers_are_those_of_a_sphere():
    problem = cap()
    found = verdict(problem, problem.vertices)
    assert found.fair and not found.reasons and str(found) == "fair"
    assert found.fit_median < 6e-3 and found.fit_most < 1e-2
    assert found.folds_too_sharp == 0.0
    plan = face_areas(problem.vertices * [1, 1, 0], problem.faces).sum()
    assert found.area_kept == pytest.approx(face_areas(problem.vertices, problem.faces).sum() / plan, rel=1e-12)
    assert found.to_dict()["word"] == "fair" and found.places == []


@pytest.mark.parametrize("name, limit", [("fit_most", MAX_ERROR_90), ("waviness", MAX_WAVINESS_95), ("bulging_both_ways", MAX_OTHER_SIDE)])
def test_roughness_is_the_largest_value_relative_to_its_limit(name, limit):
    found = replace(verdict(cap()), fit_most=None, waviness=None, bulging_both_ways=0.0)
    assert found.roughness == 0.0 and replace(found, **{name: 1.5 * limit}).roughness == pytest.approx(1.5)


def test_a_crumpled_sphere_is_rough():
    found = verdict(shaken(cap(), 0.005))
    assert not found.fair and found.fit_median > 0.3
    assert str(found).startswith("rough: the curvature of fitted polynomials deviates from its target by")


def test_a_smooth_surface_of_the_wrong_curvature_is_rough():
    found = verdict(cap(target=1.2))
    assert not found.fair and found.fit_median == pytest.approx(1 / 6, abs=0.01) and found.folds_too_sharp == 0.0


def test_a_crease_may_fold_and_an_edge_may_not():
    vertices, faces = shapes.grid(12)
    vertices[:, 2] = 0.4 * np.abs(vertices[:, 0] - 0.5) - 0.1 * (vertices[:, 0] - 0.5) ** 2
    ridge = np.abs(vertices[:, 0] - 0.5) < 1e-9
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    folded = CGCProblem(vertices, faces, roles, 0.0)
    creased = replace(folded, roles=np.where(ridge, CREASE, roles))
    assert verdict(creased).fair
    assert not verdict(folded).fair and verdict(folded).sharpest_fold > 40


def test_a_single_kink_is_seen_on_any_mesh():
    """Its share of a fine mesh is nothing, to the eye it is all: one vertex, a fifth of an edge too high."""
    for n in (20, 30):
        problem = cap(n)
        middle = int(np.argmin(np.linalg.norm(problem.vertices[:, :2] - 0.5, axis=1)))
        kinked = problem.vertices.copy()
        kinked[middle] *= 1.0 + 0.2 / n
        found = verdict(problem.with_vertices(kinked))
        assert not found.fair and found.folds_too_sharp < 0.01 and middle in found.places
        assert found.reasons[0].startswith("it is kinked: between vertices")


def test_what_is_drawn_out_or_lost_is_named():
    problem = cap()
    lost = verdict(problem, 1.5 * problem.vertices)
    assert not lost.fair and "49 % of the area of the input in plan" in str(lost)
    pulled = problem.vertices.copy()
    pulled[:21] += 0.98 * (pulled[21:42] - pulled[:21])
    needles = verdict(replace(problem, vertices=pulled), problem.vertices)
    assert any("needles" in reason for reason in needles.reasons)


def test_the_verdict_turns_and_scales_with_the_model():
    problem = shaken(cap(12), 0.002)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    other = replace(problem, vertices=100 * problem.vertices @ turn.T + [1e3, 0, 5], targets=problem.targets / 1e4)
    here, there = verdict(problem), verdict(other)
    assert (here.fair, len(here.reasons)) == (there.fair, len(there.reasons))
    assert there.fit_median == pytest.approx(here.fit_median, rel=1e-6)
    assert there.sharpest_fold == pytest.approx(here.sharpest_fold, rel=1e-6)


def square(n: int, share: float) -> CGCProblem:
    """A plan over which K > 0 is singular along all edges, whatever the mesh."""
    vertices, faces = shapes.grid(n)
    return CGCProblem(vertices, faces).with_supports("boundary").with_targets(share * np.pi)


@pytest.mark.parametrize("n", [6, 10, 20, 40])
@pytest.mark.parametrize("share", [0.1, 0.5])
def test_a_dome_over_a_square_is_fair_however_coarse(n, share):
    result = solve(square(n, share))
    assert result.verdict.fair, str(result.verdict)


def test_two_domes_with_a_fold_between_are_rough():
    vertices, faces = shapes.grid(24)
    x, y = vertices[:, :2].T - 0.5
    vertices[:, 2] = -0.5 * (np.abs(x) - 0.25) ** 2 - 0.5 * y**2
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    found = verdict(CGCProblem(vertices, faces, roles, 1.0))
    assert not found.fair
    # The other half of a dome that bulges up and down.
    vertices[:, 2] = 0.25 * np.sin(2 * np.pi * x) * np.cos(np.pi * y)
    both = verdict(CGCProblem(vertices, faces, roles, 1.0))
    assert both.bulging_both_ways > 0.3 and any("to the other side" in reason for reason in both.reasons)


def test_a_saddle_of_small_waves_is_rough_at_the_places_of_the_waves():
    vertices, faces = shapes.grid(24)
    x, y = vertices[:, :2].T - 0.5
    vertices[:, 2] = 0.5 * (x**2 - y**2)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    problem = CGCProblem(vertices, faces, roles, -1.0)
    assert verdict(problem).waviness < 0.05
    waved = vertices.copy()
    waved[:, 2] += np.where(x > 0.1, 0.002 * np.cos(np.pi * 24 * (x + y)), 0.0)
    found = verdict(problem.with_vertices(waved))
    assert not found.fair and found.waviness > 0.4 and found.places
    assert np.mean(vertices[found.places, 0] - 0.5 > 0.0) > 0.9


def test_a_result_is_judged_where_there_is_a_surface():
    result = solve(square(12, 0.5))
    assert result.to_dict()["verdict"]["word"] == "fair" and result.start is not None
    lost = replace(result, status="diverged")
    assert not lost.verdict.fair and str(lost.verdict) == "rough: no surface was found"
    assert lost.to_dict()["verdict"]["reasons"] == lost.verdict.reasons and lost.summary.startswith("no surface found")


def test_a_surface_is_judged_once_however_often_its_verdict_is_read(monkeypatch):
    judged = []

    def counted(*args):
        judged.append(args)
        return verdict(*args)

    for module in ("solvers.running", "datastructures.solve_result", "analysis.report"):
        monkeypatch.setattr(f"compas_cgc.{module}.verdict", counted)
    roof = square(8, 0.5)
    result = solve(roof)
    assert analyse(result, roof).verdict is result.verdict and len(judged) == 1
    assert result.verdict == verdict(result.problem, result.start)


def bent_saddle(n: int, jump: float, over: float = 1e-9, crease: bool = False) -> CGCProblem:
    """A saddle z = xy of K about -1, which beyond the straight line x = 0 bends by `jump` more across it, all at once or over a length.

    The line is straight, so that its own bending is nothing that could change K.
    """
    vertices, faces = shapes.grid(n)
    x, y = vertices[:, :2].T - 0.5
    beyond = np.clip(x, 0, None)
    growing = beyond < over  # where the second derivative grows evenly from 0 to the jump
    slope = np.where(growing, beyond**2 / (2 * over), beyond - over / 2)
    vertices[:, 2] = x * y + jump * np.where(growing, beyond**3 / (6 * over), beyond**2 / 2 - over * beyond / 2 + over**2 / 6)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[(np.abs(x) < 1e-9) & crease & (roles == INTERNAL)] = CREASE
    return CGCProblem(vertices, faces, roles, -1.0 / (1 + (y + jump * slope) ** 2 + x**2) ** 2)


@pytest.mark.parametrize("n", [16, 32, 48])
def test_a_sheet_that_suddenly_bends_another_way_is_rough_at_the_fault(n):
    problem = bent_saddle(n, 6.0)
    found = verdict(problem)
    told = re.search(r"it has a fault at vertex (\d+) and (\d+) others: its bending changes by up to", str(found))
    assert not found.fair and told, found
    assert abs(problem.vertices[int(told[1]), 0] - 0.5) < 2.5 / n and int(told[2]) > n / 2
    assert int(told[1]) in found.places


@pytest.mark.parametrize("n", [24, 48])
def test_what_bends_another_way_by_and_by_or_at_a_crease_has_no_fault(n):
    for problem in (bent_saddle(n, 0.0), bent_saddle(n, 4.0, 0.4), bent_saddle(n, 6.0, crease=True)):
        assert "fault" not in str(verdict(problem))


@pytest.mark.nightly
def test_known_surfaces_on_any_mesh_have_no_fault():
    """Spheres, bulges, spindles, cones, pseudospheres and saddles of revolution on regular, Delaunay, graded and anisotropic meshes."""
    for number in range(1, 60, 2):
        known = known_case(number)
        if len(known.problem.vertices) < 500:
            assert "fault" not in str(verdict(known.problem.with_vertices(known.answer))), known.name


@pytest.mark.parametrize("number", [3001, 3009, 3049, 3161, 3171, 3181])
def test_known_surfaces_on_stretched_triangles_are_fair_and_wrinkled_ones_are_not(number):
    """Cubic polynomials over two rings are 10 to 30 % off the curvature of these surfaces, quartic ones over three are not."""
    known = known_case(number)
    exact = known.problem.with_vertices(known.answer)
    assert verdict(exact).fair, str(verdict(exact))
    edge = np.sqrt(np.median(face_areas(exact.vertices, exact.faces)))
    wrinkles = 0.05 * edge * np.random.default_rng(0).standard_normal(len(exact.vertices))
    rough = exact.with_vertices(exact.vertices + wrinkles[:, None] * vertex_normals(exact.vertices, exact.faces))
    assert not verdict(rough).fair


def waves(count: int, supports: int, turned: float = 0.0) -> CGCProblem:
    """A disc that goes up and down so many times around its middle, held at some points of its rim, turned about the x axis."""
    vertices, faces = shapes.delaunay_disk(500)
    z = vertices[:, 0] + 1j * vertices[:, 1]
    vertices[:, 2] = 0.3 * np.real(z**count)
    rim = np.flatnonzero(boundary_vertices(vertices, faces))
    roles = np.full(len(vertices), INTERNAL)
    roles[rim] = FREE
    angles = np.angle(z[rim])
    roles[[rim[np.argmin(np.abs(np.angle(np.exp(1j * (angles - at)))))] for at in 2 * np.pi * np.arange(supports) / supports]] = FIXED
    c, s = np.cos(turned), np.sin(turned)
    return CGCProblem(vertices @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]]), faces, roles, -1.0)


@pytest.mark.parametrize("turned", [0.0, 0.7])
@pytest.mark.parametrize(("count", "supports", "wrong"), [(2, 4, False), (3, 6, False), (3, 4, True), (4, 8, False), (4, 6, True)])
def test_a_branch_point_is_one_more_than_supports_need(count, supports, wrong, turned):
    """Monkey saddles and finer ones: the index of their principal directions is -(n - 2) / 2, which supports may need."""
    reasons = [reason for reason in verdict(waves(count, supports, turned)).reasons if "branch point" in reason]
    assert bool(reasons) == wrong
    if wrong:
        problem = waves(count, supports, turned)
        vertex = int(re.search(r"vertex (\d+)", reasons[0]).group(1))
        assert np.linalg.norm(problem.vertices[vertex]) < 0.15


@pytest.mark.nightly
def test_a_saddle_without_a_branch_point_is_found():
    """An ellipse on four points with four times the K that a symmetric saddle carries; plates over its supports lead to branch points."""
    t = np.linspace(0, 2 * np.pi, 61)
    mesh = CGCMesh.from_outline(np.column_stack([9 * np.cos(t), 6 * np.sin(t), 0 * t]), 0.55)
    held = mesh.vertices_near([[9, 0], [0, 6], [-9, 0], [0, -6]])
    mesh.set_supports(held)
    for vertex, z in zip(held, (3, 0, 3, 0)):
        mesh.vertex_attribute(vertex, "z", z)
    mesh.set_target(-0.012)
    for method, settings in (("projection", {"retry": False}), ("projection", None), ("auto", None)):
        result = solve(mesh, method=method, settings=settings)
        assert result.converged and result.verdict.fair


def on_corners(n: int = 20) -> CGCProblem:
    """A square piece of the unit sphere on its corners."""
    problem = cap(n)
    (x, y, _), roles = problem.vertices.T, problem.roles
    corner = (np.abs(x - 0.5) > 0.499) & (np.abs(y - 0.5) > 0.499)
    return replace(problem, roles=np.where(corner, FIXED, np.where(roles == FIXED, FREE, roles)))


def test_a_horn_at_a_support_is_seen_though_averages_hide_it():
    problem = on_corners()
    assert verdict(problem).fair
    # Up to three edges from a corner the surface is drawn down to a support that lies too low.
    away = np.hypot(*problem.vertices[:, :2].T) * 20
    lowered = problem.vertices - np.outer(np.maximum(0.0, 3.0 - away) ** 2 / 9.0 * 0.15, [0.0, 0.0, 1.0])
    found = verdict(replace(problem, vertices=lowered))
    assert not found.fair and any("sharp tip" in reason for reason in found.reasons)
    assert 0 in found.places or np.hypot(*problem.vertices[found.places, :2].T).min() < 0.2


def test_a_valley_between_domes_that_sinks_below_its_supports_is_seen():
    problem = on_corners()
    x, y, z = problem.vertices.T
    ridge = np.abs(x - 0.5) < 1e-9
    edges = np.flatnonzero(ridge)
    edges = edges[np.argsort(y[edges])]
    creased = problem.with_creases(np.column_stack([edges[:-1], edges[1:]]).tolist())
    # Two caps that meet in a valley, once above and once below the level of the corners.
    heights = [np.sqrt(1.0 - (np.abs(x - 0.5) - centre) ** 2 - (y - 0.5) ** 2) for centre in (0.25, 0.45)]
    above, below = (verdict(replace(creased, vertices=np.column_stack([x, y, z]))) for z in heights)
    assert not any("dips" in reason for reason in above.reasons)
    assert any("dips by" in reason and "support it there" in reason for reason in below.reasons)


@pytest.mark.parametrize("height", [0.0, 3.53e6])
def test_heights_are_stated_over_the_supports_wherever_the_drawing_lies(height):
    mesh = CGCMesh.from_meshgrid(dx=8.0, nx=8)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    problem = mesh.to_problem().with_vertices(mesh.to_problem().vertices + [0.0, 0.0, height])
    text, _ = describe(ReadProblem(problem, (), ()))
    assert f"around (4, 4, {height:.0f})" in text
    result = solve(replace(problem, drawing=Drawing(units="Meters")))
    rise = result.vertices[:, 2].max() - height
    assert f"heights from 0 to {rise:.4g} m relative to the lowest support" in result.summary


def test_free_edges_that_sag_between_columns_on_a_line_are_rough_because_k_changes_its_sign_there():
    """A surface of K > 0 over a straight free edge is above the line between its columns, and cannot pass a third one on this line."""
    vertices, faces = shapes.grid(16)
    x, y = vertices[:, :2].T
    on_side = np.flatnonzero((y == 0.0) & np.isin(x, [0.0, 0.5, 1.0]))
    columns = np.concatenate([on_side, np.flatnonzero((y == 1.0) & np.isin(x, [0.25, 0.75]))])
    problem = CGCProblem(vertices, faces).with_supports(columns.tolist()).with_targets(0.4)
    surface = polish(problem)
    found = verdict(problem.with_vertices(surface.vertices), vertices)
    assert surface.status == "converged"
    assert not found.fair and "its K has the wrong sign" in found.reasons[0]
    beside = np.abs(vertices[found.places] - vertices[on_side[1]]).max(axis=1)
    assert beside.min() == 0.0 and (beside < 0.3).any()


@pytest.mark.parametrize("n", [8, 16])
def test_supports_at_which_k_changes_its_sign_are_found_on_coarse_meshes_as_on_fine_ones(n):
    """Two of these six columns pull the free edge between their neighbours down; on both meshes K < 0 at them."""
    vertices, _ = shapes.grid(n)
    # The diagonals alternate, and those at the first and the last corner pass them by.
    row, column = np.divmod(np.arange(n * n), n)
    a = row * (n + 1) + column
    b, c, d = a + n + 1, a + n + 2, a + 1
    one, other = np.column_stack([a, b, c, a, c, d]), np.column_stack([a, b, d, b, c, d])
    faces = np.where(((row + column) % 2 == 1)[:, None], one, other).reshape(-1, 3)
    x, y = vertices[:, :2].T
    columns = [(0.0, 0.0), (0.875, 0.0), (1.0, 0.5), (1.0, 1.0), (0.125, 1.0), (0.0, 0.5)]
    supports = [int(np.argmin(np.hypot(x - a, y - b))) for a, b in columns]
    found = solve(CGCProblem(vertices * [1.1, 1.0, 1.0], faces).with_supports(supports).with_targets(1.2 / 1.1)).verdict
    assert not found.fair and "its K has the wrong sign at the support" in found.reasons[0]


def test_single_readings_that_are_off_near_supports_do_not_make_a_surface_rough():
    """Beside the columns of a disc mid-edge normals are off by 7 %, and cubic fits by more on coarse meshes."""
    for count in (120, 500):
        plan, triangles = shapes.delaunay_disk(count)
        rim = np.flatnonzero(boundary_vertices(plan, triangles))
        rim = rim[np.argsort(np.arctan2(*plan[rim, :2].T))]
        result = solve(CGCProblem(plan, triangles).with_supports(rim[:: len(rim) // 6][:6].tolist()).with_targets(0.5))
        assert result.verdict.fair, str(result.verdict)
