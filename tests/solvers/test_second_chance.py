"""A rough surface gets a second chance; what is fair is returned."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete.smooth_measure import is_irregular
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.result import Solution
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers import selection
from compas_cgc.solvers.anew import solved_anew
from compas_cgc.solvers.projection import coarse_to_fine

from ..support import shapes
from ..system.fairness_study import case


def bent_sheet(n: int = 20) -> CGCProblem:
    """A piece of a cylinder with K = 0, held along one straight edge and half of an arc, from a start with a wave in it."""
    vertices, faces = shapes.grid(n)
    x, y = vertices[:, :2].T
    turn = x - 0.5
    vertices = np.column_stack([np.sin(turn), y, np.cos(turn)])
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[(x < 1e-9) | ((y < 1e-9) & (x < 0.5))] = FIXED
    wave = 0.05 * np.sin(7 * x) * np.cos(5 * y)
    wave[roles == FIXED] = 0.0
    return CGCProblem(vertices + wave[:, None] * np.column_stack([np.sin(turn), 0 * y, np.cos(turn)]), faces, roles, 0.0)


def test_a_developable_is_found_from_a_wavy_drawing():
    problem = bent_sheet()
    straight = solve(problem, method="projection")
    found = solve(problem)
    assert straight.converged and not straight.verdict.fair
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "from what was found, smoothed, it is fairer" in found.message


@pytest.mark.parametrize("number", [1121, pytest.param(1082, marks=pytest.mark.nightly)])
def test_waves_that_a_search_has_put_into_a_surface_are_smoothed_out(number):
    """A cone on a regular mesh, and points at heights with K < 0: no search for less bending takes the waves out again."""
    problem = case(number).problem
    assert not solve(problem, method="projection").verdict.fair
    found = solve(problem)
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "smoothed" in found.message


def test_a_drawn_cone_is_found_from_its_drawing_smoothed():
    """From the waves of the first search polynomials lead to others; from the drawing they do not."""
    problem = case(9005).problem
    found = solve(problem)
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "nearer to the drawing it is fairer" in found.message


def test_a_drawn_pseudosphere_that_a_search_has_lost_is_found_smoothed():
    """On an irregular mesh, where the search went on until nearly all the work was used up."""
    found = solve(case(9407).problem)
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "smoothed, it" in found.message and "projection stalled" in found.message


@pytest.mark.nightly
def test_a_large_drawn_pseudosphere_that_a_search_has_lost_is_found_from_its_drawing_smoothed():
    found = solve(case(9385).problem)
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "from its drawing, smoothed, it arrives" in found.message


@pytest.mark.nightly
def test_what_a_long_search_has_left_of_the_work_goes_into_a_smooth_surface(monkeypatch):
    """A saddle of revolution on an irregular mesh, whose angle defects hold it tightly: another mesh would be begun, not finished."""
    problem = case(1023).problem
    assert solve(problem).verdict.fair
    # By way of even triangles it is fair before.
    monkeypatch.setattr(coarse_to_fine, "DETOUR", len(problem.vertices) + 1)
    found = solve(problem)
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "smoothed, it" in found.message


@pytest.mark.nightly
def test_where_a_search_ends_too_early_a_smooth_surface_is_gone_on_from():
    """The same, with fewer steps than the search takes: smoothed, its last shape is nearer than it was itself."""
    found = solve(case(1023).problem, settings={"steps": 60})
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "from where it stalled, smoothed, it arrives" in found.message


def test_a_dome_that_is_fair_at_once_is_solved_once():
    vertices, faces = shapes.grid(12)
    problem = CGCProblem(vertices, faces).with_supports("corners").with_targets(1.0)
    result = solve(problem)
    assert result.verdict.fair and "rough" not in result.message
    assert result.iterations == solve(problem, method="projection").iterations


@pytest.mark.parametrize("status", ["cancelled"])
def test_what_is_cancelled_is_not_tried_again(status):
    steps = []
    result = solve(bent_sheet(10), callback=lambda state: steps.append(state.step) or len(steps) == 2)
    assert result.status == status and len(steps) == 2


def test_a_pseudosphere_on_an_anisotropic_mesh_is_found_on_one_laid_out_anew(monkeypatch):
    problem = case(5).problem
    # With its edges turned it is fair before.
    monkeypatch.setattr(selection, "on_turned_edges", lambda problem, solve, smoothed: None)
    steps = []
    found = solve(problem, callback=lambda state: steps.append(len(state.vertices)))
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "laid out anew" in found.message and set(steps) == {len(problem.vertices)}


@pytest.mark.nightly
def test_a_saddle_over_a_plan_is_found_on_a_mesh_laid_out_anew():
    """On 72 vertices, for which there is time."""
    problem = case(11100).problem
    assert not solve(problem, method="projection").verdict.fair
    found = solve(problem)
    assert found.converged and found.verdict.fair, str(found.verdict)
    assert "laid out anew" in found.message and np.array_equal(found.problem.faces, problem.faces)


@pytest.mark.nightly
def test_a_search_that_is_lost_on_a_fine_mesh_is_gone_on_with_from_a_coarser_one():
    """A part of the rim held and K < 0 over 1,998 vertices of a regular mesh: it stalled after all the work that there is."""
    problem = case(12022).problem
    result = solve(problem)
    assert result.converged and result.verdict.fair and "laid out anew" in result.message, result.message
    assert np.array_equal(result.faces, problem.faces)


@pytest.mark.nightly
def test_what_the_mesh_has_spoilt_is_freed_and_what_is_fair_is_not():
    problem = case(11100).problem
    fair = Solution(solve(problem).vertices, "converged", "", 1, 0.0, 0.0, [])
    asked = []

    def told(name, solution):
        return lambda drawn: asked.append(name) or solution

    lost = fair._replace(vertices=problem.vertices, status="stalled")
    assert solved_anew(problem, told("kept", fair), told("freed", lost)) is fair and asked == ["kept"]
    assert solved_anew(problem, told("kept", lost), told("freed", fair)) is fair and asked == ["kept", "kept", "freed"]
    assert solved_anew(problem, told("kept", lost), told("freed", lost)) is lost


def test_a_cone_on_an_anisotropic_mesh_is_measured_smoothly():
    """With K̄ = 0 the layout of the mesh shows as well, against the square of the bending."""
    found = solve(case(21).problem)
    assert found.verdict.fair and "smooth measure" in found.message
    flat = np.zeros_like(found.vertices)
    flat[:, :2] = case(21).problem.vertices[:, :2]
    assert not is_irregular(flat, found.problem.faces, found.problem.asked, found.problem.targets)


def test_what_the_supports_contradict_is_told_after_the_first_search(monkeypatch):
    used = []

    def run_method(method, *args, **options):
        used.append(method.name)
        return own(method, *args, **options)

    own = selection.run_method
    monkeypatch.setattr(selection, "run_method", run_method)
    result = solve(case(2062).problem)
    assert "the supported boundary has a reentrant corner" in result.message
    assert used and "flow" not in used and used.count("projection") == 1, used
