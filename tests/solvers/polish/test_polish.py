"""Least bending and folding by mid-edge normals: exact derivatives, order of convergence, invariance, every door's method."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.spatial import Delaunay

from compas_cgc import CGCMesh
from compas_cgc import sensitivity
from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import vertex_areas
from compas_cgc.discrete.measured_curvature import measured_curvature
from compas_cgc.model.constraints import Height
from compas_cgc.model.goals.inequalities import Below
from compas_cgc.model.goals.places import Level
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.polish.polisher import polish
from compas_cgc.solvers.polish.posed import posed
from compas_cgc.solvers.polish.saddle import Saddle
from compas_cgc.solvers.polish.settings import PolishSettings
from compas_cgc.solvers.polish.starts import starts

from ...system.fairness_study import mesh
from ...system.fairness_study import outline


def _square(n: int, jitter: float = 0.0, lines=(), along=(0, 1)):
    """Return a unit square with creases along lines of constant x (0) and y (1)."""
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    xy = np.column_stack([i, j]) / n
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    F = np.vstack([np.column_stack([a, a + n + 1, a + n + 2]), np.column_stack([a, a + n + 2, a + 1])])
    if jitter:
        inside = (np.abs(xy - 0.5).max(axis=1) < 0.5) & ~np.isclose(xy[:, :, None], np.asarray(lines)).any(axis=(1, 2))
        xy[inside] += jitter / n * np.random.default_rng(n).uniform(-1, 1, (inside.sum(), 2))
        F = Delaunay(xy).simplices.astype(np.int64)
        d, e = xy[F[:, 1]] - xy[F[:, 0]], xy[F[:, 2]] - xy[F[:, 0]]
        area = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
        F[area < 0] = F[area < 0][:, ::-1]
        F = F[np.abs(area) > 1e-9 / n**2]
    V = np.column_stack([xy, 0 * xy[:, 0]])
    edges = np.unique(np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1), axis=0)
    creased = np.zeros(len(edges), bool)
    for line in lines:
        creased |= np.isclose(xy[edges][:, :, list(along)], line).all(axis=1).any(axis=1)
    return V, F, edges[creased]


def _on_corners(n: int, K: float, lift: float = 0.0, **how) -> CGCProblem:
    V, F, creases = _square(n, **how)
    x, y = V[:, 0], V[:, 1]
    V[:, 2] = lift * (x + y - 2 * x * y)
    return CGCProblem(V, F, creases=creases).with_supports("corners").with_targets(K)


def _on_a_wall(n: int, K: float, jitter: float = 0.0) -> CGCProblem:
    V, F, _ = _square(n, jitter)
    return CGCProblem(V, F).with_supports(np.flatnonzero(V[:, 0] < 1e-9).tolist()).with_targets(K)


def _middle(vertices) -> float:
    return float(vertices[np.argmin(np.hypot(*(vertices[:, :2] - 0.5).T)), 2])


def _order(problems, **settings):
    heights = []
    for problem in problems:
        solution = polish(problem, settings=PolishSettings(**settings))
        assert solution.status == "converged"
        heights.append(_middle(solution.vertices))
    return np.log2((heights[1] - heights[0]) / (heights[2] - heights[1])), heights


GOALS = [Height([10], 0.2), Level([3, 5, 6]), Volume(0.2), Below(0.3)]


@pytest.mark.parametrize("evenness, goals, near", [(0.0, [], False), (0.5, [], False), (0.0, GOALS, False), (0.0, [], True)])
def test_derivatives_are_exact(evenness, goals, near):
    local = _on_corners(6, 1.0, lines=(1 / 3, 2 / 3), jitter=0.3).with_goals(goals).local()[0]
    lagrangian = posed(local, 0.1).evener(evenness)
    state, rng = next(starts(lagrangian)), np.random.default_rng(0)
    if near:
        lagrangian = lagrangian.over(lagrangian.vertices(state.unknowns), 1.0).near(0.3, rng.uniform(0.5, 2.0, len(local.vertices)))
        state = lagrangian.moved(lagrangian.at(np.zeros(lagrangian.mesh.unknowns)), 0.01 * rng.standard_normal(lagrangian.size))
    multipliers, step = rng.standard_normal(lagrangian.count), rng.standard_normal(lagrangian.size)
    forces = rng.standard_normal(len(state.met.values))
    h = 1e-6
    there, back = lagrangian.moved(state, h * step), lagrangian.moved(state, -h * step)
    model = lagrangian.model(state, multipliers)
    assert (there.energy - back.energy) / (2 * h) == pytest.approx(float(model.gradient @ step), rel=1e-6)
    change = (there.equations - back.equations) / (2 * h)
    assert np.abs(change - model.jacobian @ step).max() < 1e-6 * np.abs(change).max()
    change = (there.met.values - back.met.values) / (2 * h)
    assert np.abs(change - state.met.slopes @ lagrangian.moves_of(step)).max(initial=0.0) < 1e-6

    def force(at):
        own = lagrangian.model(at, multipliers)
        pushed = (at.met.slopes.T @ forces)[lagrangian.free[: lagrangian.moves]]
        return own.gradient + own.jacobian.T @ multipliers + np.pad(pushed, (0, lagrangian.size - lagrangian.moves))

    assert np.abs(lagrangian.gradient(state, multipliers, forces) - force(state)).max() < 1e-12 * np.abs(force(state)).max()
    matrix = lagrangian.pattern.matrix(model, model.hessian, 0.0, np.zeros(len(multipliers)))
    change = (force(there) - force(back)) / (2 * h)
    product = (matrix @ np.concatenate([step, 0 * multipliers]))[: lagrangian.size]
    assert np.abs(change - product).max() < 1e-6 * np.abs(change).max()


def test_the_crown_on_corners_is_of_second_order():
    order, heights = _order([_on_corners(n, 1.0) for n in (8, 16, 32)])
    assert order > 1.8
    assert heights[2] + (heights[2] - heights[1]) / 3 == pytest.approx(0.2909, abs=2e-4)


def test_irregular_meshes_give_the_same_surface():
    plain, irregular = (_middle(polish(_on_corners(16, 1.0, jitter=jitter)).vertices) for jitter in (0.0, 0.3))
    assert irregular == pytest.approx(plain, abs=2e-4)


def test_a_crease_is_of_second_order():
    order, _ = _order([_on_corners(n, 1.0, lines=(0.5,), along=(0,)) for n in (8, 16, 32)])
    assert order > 1.8


def test_nine_regions_are_of_second_order():
    order, heights = _order([_on_corners(n, 1.0, lines=(1 / 3, 2 / 3)) for n in (6, 12, 24)])
    assert order > 1.8
    assert heights[1] == pytest.approx(heights[2], rel=5e-3)


def test_a_canopy_on_a_wall_is_as_high_on_random_triangles():
    """The bending energy hardly depends on how far the roof is turned about the wall."""
    plain, irregular = (_middle(polish(_on_a_wall(16, 0.5, jitter=jitter)).vertices) for jitter in (0.0, 0.3))
    assert irregular == pytest.approx(plain, rel=0.02)


@pytest.mark.parametrize("K", [1e-6, 0.05])
def test_a_canopy_of_little_curvature_is_near_the_drawing_and_not_turned_against_it(K):
    drawing = _on_a_wall(12, K)
    V = polish(drawing).vertices
    assert np.abs(V[:, 2]).max() < 0.25 * np.sqrt(K)
    areas, x = vertex_areas(drawing.vertices, drawing.faces, "barycentric"), drawing.vertices[:, 0]
    assert abs(areas * V[:, 2] @ (x - 0.5)) < 1e-12
    raised = drawing.vertices + np.outer(0.5 * x, [0, 0, 1])
    assert polish(drawing.with_vertices(raised)).vertices[:, 2] @ areas > 0.2


def test_solutions_of_bordered_matrices_and_their_inertia():
    rng = np.random.default_rng(3)
    points = rng.uniform(0, 1, (60, 2))
    near = np.hypot(*(points[:, None] - points).T) < 0.3
    A = near * rng.standard_normal((60, 60))
    A, B, right = A + A.T, rng.standard_normal((60, 2)), rng.standard_normal(60)
    saddle = Saddle(points)
    # The third column of the border says the same as the first.
    assert saddle.factorise(sparse.csr_matrix(A), np.column_stack([B, 2 * B[:, 0]])) == saddle.factorise(sparse.csr_matrix(A), B)
    negative = saddle.factorise(sparse.csr_matrix(A), B)
    whole = np.block([[A, B], [B.T, np.zeros((2, 2))]])
    assert negative == (np.linalg.eigvalsh(whole) < 0).sum() - 2
    expected = np.linalg.solve(whole, np.append(right, [0.5, -2.0]))
    solution, forces = saddle.solve(right, np.array([0.5, -2.0]))
    assert np.abs(np.append(solution, forces) - expected).max() < 1e-9 * np.abs(expected).max()


def test_saddles_over_lifted_corners_do_not_depend_on_the_triangles():
    solutions = [polish(_on_corners(16, -1.2, lift=0.6, jitter=jitter)) for jitter in (0.0, 0.3)]
    assert {own.status for own in solutions} == {"converged"}
    # One of two mirror twins: the middle of the free edges is above or below the straight line between supports by .081.
    for own in solutions:
        V = own.vertices
        middle = V[np.argmin(np.hypot(V[:, 0] - 0.5, V[:, 1])), 2] - 0.3
        assert abs(middle) == pytest.approx(0.081, abs=2e-3)


@pytest.mark.parametrize("K", [1.0, -1.0])
def test_place_size_and_numbering_do_not_matter(K):
    problem = _on_corners(8, K, jitter=0.3)
    plain = polish(problem)
    rng = np.random.default_rng(4)
    turn, order = np.linalg.qr(rng.standard_normal((3, 3)))[0], rng.permutation(len(problem.vertices))
    turn *= np.sign(np.linalg.det(turn))
    V = np.empty_like(problem.vertices)
    V[order] = 1000 * problem.vertices @ turn + [1, 1, 1]
    faces = order[problem.faces][rng.permutation(len(problem.faces))]
    found = polish(CGCProblem(V, faces).with_supports(order[problem.supports].tolist()).with_targets(1e-6 * K))
    assert found.status == plain.status == "converged"
    back = (found.vertices[order] - [1, 1, 1]) @ turn.T / 1000
    twin = np.abs(back * [1, 1, -1] - plain.vertices).max() if K < 0 else np.inf
    assert min(np.abs(back - plain.vertices).max(), twin) < 1e-6


def test_a_longer_fold_length_folds_the_creases_more():
    problem = _on_corners(12, 1.0, lines=(1 / 3, 2 / 3))
    crowns = [_middle(polish(problem, settings=PolishSettings(fold_length=length)).vertices) for length in (0.01, 0.1, 0.3)]
    assert crowns[0] > crowns[1] > crowns[2]


def test_it_is_a_method_of_every_door():
    mesh = CGCMesh.from_meshgrid(dx=15, nx=15)
    mesh.set_supports("corners")
    mesh.set_creases([[16 * i + k for i in range(16)] for k in (5, 10)])
    mesh.set_target(0.005)
    result = solve(mesh, method="bending")
    assert (result.status, result.method, result.measure) == ("converged", "bending", "mid-edge")
    assert result.verdict.fair
    # The measure of the mesh alone agrees with that of the solve.
    read = np.isfinite(result.curvature)
    assert read.sum() > 0.8 * result.problem.asked.sum() and np.abs(result.curvature[read] / 0.005 - 1.0).max() < 0.01


def test_cancelling_returns_the_surface_so_far():
    solution = polish(_on_corners(8, 1.0), callback=lambda state: state.step == 2)
    assert (solution.status, solution.iterations) == ("cancelled", 2)


@pytest.mark.parametrize("K, lines", [(1.0, ()), (1.0, (1 / 3, 2 / 3)), (-1.0, ())])
def test_derivatives_by_curvature_are_those_of_neighbouring_surfaces(K, lines):
    result, h = solve(_on_corners(8, K, lines=lines)), 1e-4
    assert result.method == "bending"
    found = sensitivity(result)
    ahead, behind = (solve(result, targets=K + sign * h).vertices for sign in (1, -1))
    difference = (ahead - behind) / (2 * h)
    assert np.abs(found.moves.sum(axis=0) - difference).max() < 1e-4 * np.abs(difference).max()


def _on_five_points(seed: int):
    """Return an irregular square with K = -1 over five points of its rim at random heights."""
    V, F, _ = _square(12, 0.3)
    rim = np.flatnonzero(np.abs(V[:, :2] - 0.5).max(axis=1) > 0.499)
    turns = 2 * np.pi * np.arange(5) / 5
    places = np.column_stack([np.cos(turns), np.sin(turns)])
    places = 0.5 + 0.5 * places / np.abs(places).max(axis=1)[:, None]
    at = rim[np.linalg.norm(V[rim, None, :2] - places, axis=2).argmin(axis=0)]
    V[at, 2] = np.random.default_rng(seed).uniform(0, 0.3, 5)
    return CGCProblem(V, F).with_supports(at.tolist()).with_targets(-1.0)


@pytest.mark.parametrize("seed", [0, pytest.param(2, marks=pytest.mark.nightly), pytest.param(4, marks=pytest.mark.nightly)])
def test_even_curvature_has_no_branch_points_where_least_bending_has_some(seed):
    problem = _on_five_points(seed)
    least, even = polish(problem, settings=PolishSettings(evenness=0.0)), solve(problem)
    assert least.status == "converged" and "branch point" in str(least.verdict)
    assert even.converged and even.verdict.fair and "evenness = " in even.message
    none = np.zeros(len(problem.faces), np.int64)
    bending = [measured_curvature(own.vertices, problem.faces, problem.creases, none).bending.sum() for own in (least, even)]
    assert bending[0] < bending[1]


def test_a_slider_follows_its_branch_and_ends_where_a_cold_solve_does():
    """Up from next to nothing to K = 2.6 and down: heights grow with the root of K."""
    problem, values = _on_corners(16, 1.0), np.linspace(0.2, 1.6, 5) ** 2
    cold = [solve(problem.with_targets(K)) for K in values]
    assert all(one.converged and one.verdict.fair for one in cold)
    last, up = cold[0], []
    for K in values:
        last = solve(last, targets=K)
        up.append(last)
    for K in values[::-1]:
        last = solve(last, targets=K)
    apart = max(np.abs(one.vertices - other.vertices).max() for one, other in zip(cold, up))
    assert apart < 1e-6 and np.abs(last.vertices - up[0].vertices).max() < 1e-6


def test_branches_are_listed_with_their_twins():
    result = solve(_on_corners(16, -1.2, lift=0.6))
    first, second = result.branches
    assert first.fair and second.fair and second.twin_of == 0 and first.energy == pytest.approx(second.energy, rel=1e-6)
    assert np.abs(first.vertices - result.vertices).max() == 0.0
    assert np.abs(first.vertices - second.vertices).max() > 0.1


def test_a_large_mesh_takes_its_branch_from_even_triangles():
    seen = []
    large = solve(_on_corners(40, 1.0, jitter=0.3), callback=lambda state: seen.append(len(state.vertices)))
    assert large.verdict.fair and large.iterations <= 3 < len(seen) and set(seen) == {41**2}
    assert _middle(large.vertices) == pytest.approx(0.2907, abs=2e-4)


def test_heights_of_a_plan_say_nothing_but_the_side_of_a_dome():
    problem = _on_corners(12, 1.0)
    x, y, _ = problem.vertices.T
    bump = np.column_stack([0 * x, 0 * x, np.sin(np.pi * x) * np.sin(np.pi * y)])
    flat, low, high, below = (solve(problem.with_vertices(problem.vertices + a * bump)) for a in (0.0, 0.1, 0.2, -0.1))
    assert np.abs(low.vertices - flat.vertices).max() < 1e-6 and np.abs(high.vertices - flat.vertices).max() < 1e-6
    assert np.abs(below.vertices - flat.vertices * [1, 1, -1]).max() < 1e-6


def test_supports_are_lowered_from_a_saddle_where_plates_lead_to_branch_points():
    rng = np.random.default_rng(3)
    count = int(rng.integers(130, 260))
    vertices, faces = mesh(outline("disc", rng), "delaunay", count, rng)
    rim = np.flatnonzero(boundary_vertices(vertices, faces))
    rim = rim[np.argsort(np.arctan2(vertices[rim, 1], vertices[rim, 0]))]
    supports = rim[np.arange(6) * len(rim) // 6]
    vertices[supports, 2] = [0.44, 0.19, 0.21, 0.21, 0.0, 0.15]
    problem = CGCProblem(vertices, faces).with_supports(supports.tolist()).with_targets(-0.6)
    result = solve(problem, method="bending")
    assert result.verdict.fair, result.message
    np.testing.assert_array_equal(result.vertices[supports], vertices[supports])
    least = solve(problem, method="bending", settings={"evenness": 0.0})
    assert "branch point" in least.message


@pytest.mark.nightly
def test_of_saddles_that_miss_level_supports_by_as_much_all_are_found_anywhere():
    """Which of them comes first depends on rounding."""
    random = np.random.default_rng(900)
    vertices, faces = mesh(outline("ellipse", random), "irregular", 220, random)
    rim = np.flatnonzero(boundary_vertices(vertices, faces))
    rim = rim[np.argsort(np.arctan2(vertices[rim, 0], vertices[rim, 1]))]
    problem = CGCProblem(vertices, faces).with_supports(rim[np.arange(6) * len(rim) // 6].tolist()).with_targets(-1.0)
    here, there = (solve(problem.with_vertices(vertices + move), method="bending") for move in (0.0, 1.0))
    assert here.verdict.fair and len(here.branches) == len(there.branches) == 2
    for own in here.branches:
        assert min(np.abs(own.vertices + 1.0 - other.vertices).max() for other in there.branches) < 1e-6
