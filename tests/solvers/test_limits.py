"""What supports can carry."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from compas_cgc.cli.main import main
from compas_cgc.datastructures import CGCMesh
from compas_cgc.discrete import boundary_vertices
from compas_cgc.errors import ProblemError
from compas_cgc.errors import use_method
from compas_cgc.linalg.work import Work
from compas_cgc.linalg.work import rights
from compas_cgc.model.goals.inequalities import NearPlane
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.model.verdict import verdict
from compas_cgc.solvers.allowance import Allowance
from compas_cgc.solvers.branch_ends import ENDS
from compas_cgc.solvers.branch_ends import folds_back
from compas_cgc.solvers.branch_ends import rates
from compas_cgc.solvers.limits import largest_target
from compas_cgc.solvers.polish.polisher import polish
from compas_cgc.solvers.projection import project
from compas_cgc.solvers.run import solve

from ..support import shapes
from ..system.fairness_study import case


def roof(target: float, n: int = 10, width: float = 1.0) -> CGCProblem:
    """A square on its four corners."""
    vertices, faces = shapes.grid(n, width)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[[0, n, (n + 1) ** 2 - 1, n * (n + 1)]] = FIXED
    return CGCProblem(vertices, faces, roles, target)


def test_below_a_fixed_square_the_limit_is_under_what_the_gauss_map_allows():
    vertices, faces = shapes.grid(14)
    limit = largest_target(CGCProblem(vertices, faces, targets=1.0).with_supports("boundary"))
    assert limit.status == "found" and limit.verdict.fair
    assert 0.75 * math.pi < limit.target < limit.beyond <= 1.03 * limit.target < 1.03 * math.pi


@pytest.mark.parametrize("sign", [1.0, pytest.param(-1.0, marks=pytest.mark.nightly)])
def test_at_the_limit_there_is_a_fair_surface_and_the_limit_goes_with_the_square_of_the_size(sign):
    limit = largest_target(roof(sign))
    assert limit.status == "found" and limit.carries_what_is_asked and np.sign(limit.target) == sign
    large = largest_target(roof(0.001 * sign, width=10.0))
    assert 100 * large.target == pytest.approx(limit.target, rel=0.05)
    problem = roof(0.5 * limit.target)
    solution = project(problem)
    assert solution.status == "converged"
    assert verdict(replace(problem, vertices=solution.vertices), problem.vertices).fair


@pytest.mark.nightly
def test_what_a_coarser_mesh_carries_is_looked_for_on_the_mesh_itself():
    problem = roof(1.0, 16)
    limit = largest_target(problem, tolerance=0.1, vertices=120)
    assert limit.status == "found" and not limit.coarser and limit.beyond <= 1.15 * limit.target
    result = solve(problem.with_targets(0.95 * limit.target))
    assert result.converged and result.verdict.fair


def panels(target: float, nx: int = 4, ny: int = 2, per: int = 3) -> CGCProblem:
    """Panels of 1 m on four corners, with K of either sign in turn."""
    i, j = np.divmod(np.arange((nx * per + 1) * (ny * per + 1)), ny * per + 1)
    vertices = np.column_stack([i / per, j / per, 0.0 * i])
    a, step = (np.arange(nx * per)[:, None] * (ny * per + 1) + np.arange(ny * per)).ravel(), ny * per + 1
    faces = np.column_stack([a, a + step, a + step + 1, a, a + step + 1, a + 1]).reshape(-1, 3)
    paths = [np.flatnonzero(k == at * per).tolist() for k, most in ((i, nx), (j, ny)) for at in range(1, most)]
    problem = CGCProblem(vertices, faces, creases=paths).with_supports("corners")
    middle = [vertices[faces[problem.regions() == region]].mean(axis=(0, 1)) for region in range(nx * ny)]
    for region, (x, y, _) in enumerate(middle):
        problem = problem.with_targets(target if (int(x) + int(y)) % 2 else -target, region=region)
    return problem


@pytest.mark.nightly
def test_the_number_that_is_said_of_panels_with_a_goal_is_true():
    slab = [NearPlane((0, 0, 0), (0, 0, 1), 0.4)]
    said = solve(panels(4.0), goals=slab).message  # for K = 3 the message recommends a finer mesh instead
    most = float(re.search(r"\|K̄\| up to ([\d.]+)", said).group(1))
    assert most > 0.5 and "or more" not in said
    fair, rough = (solve(panels(part * most), goals=slab) for part in (0.95, 1.15))
    assert fair.converged and fair.verdict.fair
    assert not (rough.converged and rough.verdict.fair)


@pytest.mark.nightly
def test_a_deep_saddle_is_found_at_once_where_free_edges_may_leave_their_lines():
    over_its_lines = solve(roof(-9.0))
    assert not over_its_lines.verdict.fair and use_method("projection") in over_its_lines.ending.remedies
    result = solve(roof(-9.0), method="projection")
    assert result.converged and result.verdict.fair and result.max_error < 1e-10
    assert np.ptp(result.vertices[:, 2]) == pytest.approx(2 * result.vertices[:, 2].max(), rel=1e-6), "as much up as down"


@pytest.mark.nightly
def test_a_saddle_over_six_supports_varies_evenly_where_least_bending_has_branch_points():
    result = solve(case(30176).problem)
    assert result.converged and result.verdict.fair, result.message
    assert "least bending has branch points" in result.message


def test_regions_keep_their_ratio():
    problem = roof(1.0)
    targets = np.where(problem.vertices[:, 0] < 0.5, 1.0, 2.0)
    limit = largest_target(replace(problem, targets=targets))
    assert limit.target == pytest.approx(2.0 * limit.factor) and "times the targets" in limit.message


def test_without_targets_there_is_nothing_to_look_for():
    with pytest.raises(ProblemError, match="a target other than zero"):
        largest_target(roof(0.0))


def test_a_solve_that_stalls_says_how_much_could_be_had():
    result = solve(roof(9.0))
    assert not result.verdict.fair
    assert "over these supports, fair surfaces were found for K̄ up to" in result.message and "the target is 9" in result.message


def test_a_solve_says_how_much_could_be_had_where_its_steps_do_not_suffice_unless_they_were_limited():
    mesh = CGCMesh.from_meshgrid(dx=10, nx=14)
    mesh.set_supports("corners")
    mesh.set_target(-0.3)
    result = solve(mesh)
    assert result.status == "step_limit" and result.message.startswith("over these supports, fair surfaces were found for K̄ down to -0.03")
    assert "more steps" not in result.message and all(own.field != "settings" for own in result.ending.remedies)
    assert solve(mesh, settings={"steps": 3}).message.startswith("not converged in 3 steps")


def test_the_limit_is_the_same_number_whatever_is_asked():
    problem = roof(1.0)
    largest = [largest_target(problem.with_targets(target)).target for target in (0.4, 7.0)]
    assert largest[0] == pytest.approx(largest[1], rel=1e-9)
    messages = [solve(problem.with_targets(target)).message for target in (6.0, 7.3, 9.0, 14.0)]
    stated = {re.search(r"fair surfaces were found for K̄ up to ([\d.]+) \(", message).group(1) for message in messages}
    assert len(stated) == 1 and float(stated.pop()) == pytest.approx(largest[0], rel=1e-3)


def arch(factor: float, fold: bool) -> np.ndarray:
    """Points on a branch that ends at the factor 1, at a fold or at its full pace."""
    height = 2.0 - np.sqrt(1.0 - factor) if fold else factor
    return np.array([[0.0, 0.0, 0.0], [1.0, 0.0, height]])


@pytest.mark.parametrize("fold", [True, False])
def test_beside_a_fold_a_branch_moves_by_the_root_of_what_is_left(fold):
    factors = [1.0 - 0.5**k for k in range(1, 8)]
    assert folds_back(factors, [arch(own, fold) for own in factors], 1.0) == fold
    pace = rates(factors, [arch(own, fold) for own in factors])
    growth = pace[1:] / pace[:-1]
    assert growth[-1] == pytest.approx(math.sqrt(2.0) if fold else 1.0, rel=0.02)


def test_below_a_dome_within_a_rim_the_branch_folds_back():
    vertices, faces = shapes.grid(14)
    limit = largest_target(CGCProblem(vertices, faces, targets=1.0).with_supports("boundary"))
    assert limit.end == "fold" and "folds back" in limit.message


@pytest.mark.parametrize("n", [8, 14, pytest.param(20, marks=pytest.mark.nightly)])
def test_a_dome_on_corners_grows_in_small_steps_up_to_the_bound_of_its_plan_on_any_mesh(n):
    limit = largest_target(roof(1.0, n))
    assert limit.end == "plan" and ENDS[limit.end] in limit.message
    assert limit.target < math.pi < 1.02 * limit.target
    here = polish(roof(0.6 * limit.target, n))
    for part in np.linspace(0.6, 1.0, 13)[1:]:
        before, here = here, polish(roof(part * limit.target, n), start=here.vertices)
        assert here.is_fair and np.abs(here.vertices - before.vertices).max() < 0.1
        assert np.abs(here.vertices[:, 2] - here.vertices[::-1, 2]).max() < 1e-5, "as symmetric as the drawing"


def test_a_limit_is_that_of_a_branch_and_not_of_fair_surfaces_that_it_snaps_to():
    limit = largest_target(roof(-1.0, 8))
    here = polish(roof(0.7 * limit.target, 8))
    for part in np.linspace(0.7, 1.0, 16)[1:]:
        before, here = here, polish(roof(part * limit.target, 8), start=here.vertices)
        assert here.is_fair and np.abs(here.vertices - before.vertices).max() < 0.1


def test_the_command_says_it(tmp_path, capsys):
    problem = roof(1.0, 6)
    mesh = tmp_path / "roof.obj"
    lines = ["v {} {} {}".format(*point) for point in problem.vertices] + ["f {} {} {}".format(*(face + 1)) for face in problem.faces]
    mesh.write_text("\n".join(lines) + "\n")
    assert main(["limits", str(mesh), "--supports", "corners", "--target", "1"]) == 0
    assert "over these supports, fair surfaces were found for K̄ up to" in capsys.readouterr().out
    assert main(["limits", str(mesh), "--supports", "corners", "--target", "-1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["status"] == "found" and told["target"] < -1.0 and told["verdict"]["fair"]
    assert main(["limits", str(mesh), "--supports", "corners", "--target", "1", "--tolerance", "2"]) == 2


@pytest.mark.nightly
def test_a_solve_is_given_up_after_a_count_of_work_and_ends_at_the_same_place_each_time(monkeypatch):
    problem = roof(-30.0)
    whole = solve(problem)
    monkeypatch.setattr("compas_cgc.solvers.allowance.EACH", 200)
    first, again = solve(problem), solve(problem)
    assert first.status == again.status == "stalled" and first.iterations == again.iterations < whole.iterations
    assert "reached the limit on computation" in first.message and "limit on computation" not in whole.message
    np.testing.assert_array_equal(first.vertices, again.vertices)


@pytest.mark.parametrize("goals", [[], [{"kind": "rise", "rise": 3.0}]])
def test_a_failure_takes_no_more_work_than_there_is_with_what_is_said_of_it(monkeypatch, goals):
    most, work, problem = 400.0, Work(1e9), roof(-30.0)
    monkeypatch.setattr("compas_cgc.solvers.allowance.SMALL", 0)
    monkeypatch.setattr("compas_cgc.solvers.allowance.ALL", 300)
    monkeypatch.setattr("compas_cgc.solvers.allowance.REASONS", 100)
    with work.counted():
        result = solve(problem, goals=goals)
    assert not (result.converged and result.verdict.fair)
    assert 0.0 < 1e9 - work.left <= 1.1 * rights(most, 3 * len(problem.vertices))


def test_a_small_mesh_may_take_the_work_of_four_hundred_vertices_and_a_larger_one_that_of_its_own():
    small, large = Allowance(roof(1.0), None), Allowance(CGCMesh.from_meshgrid(dx=1.0, nx=24).to_problem(), None)
    assert small.for_reasons().left == rights(22_500, 3 * 400)
    assert large.for_reasons().left == rights(22_500, 3 * 625)


def test_a_limit_is_looked_for_with_so_much_work_and_no_more():
    work = Work(1e6)
    short, long = largest_target(roof(1.0), work=work), largest_target(roof(1.0))
    assert work.spent and short.solves < long.solves and 0.0 < short.target <= long.target


def test_a_developable_that_cannot_be_is_told_how_far_its_supports_are_from_one():
    vertices, faces = shapes.grid(20)
    rim = boundary_vertices(vertices, faces)
    x, y = 2 * vertices[:, :2].T - 1
    vertices[:, 2] = np.where(rim, 0.3 * (x**3 * y + y**2), 0.0)
    result = solve(CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), 0.0))
    assert not (result.converged and result.verdict.fair)
    assert "the surface that bends least over these supports has K from -" in result.message
