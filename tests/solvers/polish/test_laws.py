"""Laws other than constant K: second order against surfaces in closed form, exact derivatives, laws beside each other, and a new law."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Mirror
from compas_cgc import analyse
from compas_cgc import solve
from compas_cgc.discrete import vertex_normals
from compas_cgc.errors import ProblemError
from compas_cgc.model.laws import Law
from compas_cgc.model.laws import Shape
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.polish.polisher import polish
from compas_cgc.solvers.polish.posed import posed
from compas_cgc.solvers.polish.settings import PolishSettings
from compas_cgc.solvers.polish.starts import starts

from ...support.exact_surfaces import SURFACES
from ...support.exact_surfaces import parallel_of_pseudosphere
from ...support.exact_surfaces import sphere
from ...support.exact_surfaces import strip_of_parallel_pseudosphere


class TotalCurvature(Law):
    """k1² + k2² = c, that is 4 H² - 2 K = c: a law that the package does not know, and that is not linear."""

    def __init__(self, c: float):
        self.c = c

    def residual(self, H, K):
        return 4 * H**2 - 2 * K - self.c

    def first_derivatives(self, H, K):
        return 8 * H, -2.0

    def second_derivatives(self, H, K):
        return 8.0, 0.0, 0.0

    def shape(self):
        return Shape(0.0, np.sqrt(self.c / 2), 0.0)

    def scale(self, area):
        return self.c

    def scaled(self, factor):
        return TotalCurvature(self.c / factor**2)


def _held(surface, n: int, irregular: bool, law=None) -> tuple[CGCProblem, np.ndarray, float]:
    """Return a patch with its boundary held and its inside 5 % of its size off, its parameters, and its size."""
    V, F, uv = surface.patch(n, irregular)
    size = float(np.ptp(V, axis=0).max())
    t = (uv - surface.low) / np.subtract(surface.high, surface.low)
    off = 0.05 * size * 16 * np.prod(t * (1 - t), axis=1) * (1 + np.sin(3 * t[:, 0]))
    problem = CGCProblem(V + off[:, None] * vertex_normals(V, F), F).with_supports("boundary")
    return problem.with_laws({0: law or surface.law}), uv, size


def _error(surface, n: int, irregular: bool, law=None) -> tuple[float, float]:
    """Return the root mean square and the largest distance from the surface, against its size."""
    problem, uv, size = _held(surface, n, irregular, law)
    solution = polish(problem)
    assert solution.status == "converged", solution.message
    distances = surface.distances(solution.vertices, uv)[problem.movable] / size
    return float(np.sqrt((distances**2).mean())), float(distances.max())


@pytest.mark.parametrize("irregular", [False, True], ids=["regular", "irregular"])
@pytest.mark.parametrize("name", ["catenoid", "sphere", "parallel of a spindle"])
def test_the_error_is_of_second_order(name, irregular):
    errors = [_error(SURFACES[name](), n, irregular)[0] for n in (8, 16)]
    assert np.log2(errors[0] / errors[1]) > 1.8


@pytest.mark.nightly
@pytest.mark.parametrize("irregular", [False, True], ids=["regular", "irregular"])
@pytest.mark.parametrize("name", SURFACES)
def test_exact_surfaces_under_refinement(name, irregular):
    errors = [_error(SURFACES[name](), n, irregular) for n in (11, 22, 44)]
    # From the first to the last: irregular meshes of two sizes differ by more than their size.
    assert np.log2(errors[0][0] / errors[-1][0]) / 2 > 1.8
    assert errors[-1][1] < 1e-4  # at 2,025 vertices


@pytest.mark.parametrize("irregular", [False, True], ids=["regular", "irregular"])
def test_a_hyperbolic_law_between_two_characteristic_supports(irregular):
    surface = parallel_of_pseudosphere()
    V, F, uv = surface.patch(16, irregular)
    t = (uv - surface.low) / np.subtract(surface.high, surface.low)
    size = float(np.ptp(V, axis=0).max())
    # Two adjacent asymptotic lines of the pseudosphere determine the surface (Goursat's problem). The order is below 1, as no equation
    # balances the bending moment at these edges: normal moves change a law in second derivatives along them only.
    off = 0.02 * size * 4 * np.prod(t, axis=1) * (1 - 0.5 * t[:, 0])
    problem = CGCProblem(V + off[:, None] * vertex_normals(V, F), F).with_supports(np.flatnonzero((t < 1e-9).any(axis=1)).tolist())
    solution = polish(problem.with_laws({0: surface.law}), settings=PolishSettings(keep="plan", steps=200))
    assert solution.status == "converged", solution.message
    assert surface.distances(solution.vertices, uv).max() < 2e-3 * size


def _clamped_error(n: int, irregular: bool) -> tuple[float, float]:
    """Return the root mean square and the largest distance from a hyperbolic surface that is clamped at one side, held at two others, and
    free at the last, against its size."""
    surface = strip_of_parallel_pseudosphere()
    V, F, uv = surface.patch(n, irregular)
    t, a = ((uv - surface.low) / np.subtract(surface.high, surface.low)).T
    size = float(np.ptp(V, axis=0).max())
    # A strip of supports holds the slope, too: the data of Cauchy's problem.
    held = (t <= 0.25 + 1e-9) | (np.abs(a - 0.5) > 0.5 - 1e-9)
    off = 0.08 * size * ~held * (t - 0.25) * a * (1 - a) * (2 + a)
    problem = CGCProblem(V + off[:, None] * vertex_normals(V, F), F).with_supports(np.flatnonzero(held).tolist())
    solution = polish(problem.with_laws({0: surface.law}))
    assert solution.status == "converged", solution.message
    distances = surface.distances(solution.vertices, uv)[problem.movable] / size
    return float(np.sqrt((distances**2).mean())), float(distances.max())


@pytest.mark.parametrize("irregular", [False, True], ids=["regular", "irregular"])
def test_a_hyperbolic_law_without_characteristic_edges_is_of_second_order(irregular):
    errors = [_clamped_error(n, irregular)[0] for n in (12, 24)]
    assert np.log2(errors[0] / errors[1]) > 1.8


@pytest.mark.parametrize("irregular", [False, pytest.param(True, marks=pytest.mark.nightly)], ids=["regular", "irregular"])
def test_a_hyperbolic_law_under_refinement(irregular):
    # The regular one keeps so many supports that its even triangles are as many as those of a mesh that is laid out anew.
    errors = [_clamped_error(n, irregular) for n in (12, 24, 44)]
    assert np.log(errors[0][0] / errors[-1][0]) / np.log(44 / 12) > 1.8
    assert errors[-1][1] < 1e-3  # at 2,025 vertices


@pytest.mark.parametrize("law", [None, TotalCurvature(2 / 1.3**2)], ids=["linear", "nonlinear"])
def test_derivatives_are_exact(law):
    problem = _held(sphere(), 6, True, law)[0].local()[0]
    lagrangian = posed(problem, 0.1)
    state, rng = next(starts(lagrangian)), np.random.default_rng(0)
    multipliers, step = rng.standard_normal(len(lagrangian.rows)), rng.standard_normal(lagrangian.size)
    there, back = lagrangian.moved(state, 1e-6 * step), lagrangian.moved(state, -1e-6 * step)
    model = lagrangian.model(state, multipliers)
    change = (there.residuals - back.residuals) / 2e-6
    assert np.abs(change - model.jacobian @ step).max() < 1e-6 * np.abs(change).max()

    def force(at):
        own = lagrangian.model(at, multipliers)
        return own.gradient + own.jacobian.T @ multipliers

    matrix = lagrangian.pattern.matrix(model, model.hessian, 0.0, np.zeros(len(multipliers)))
    change = (force(there) - force(back)) / 2e-6
    product = (matrix @ np.concatenate([step, 0 * multipliers]))[: lagrangian.size]
    assert np.abs(change - product).max() < 1e-6 * np.abs(change).max()


def test_a_new_law_needs_no_change_of_the_solver():
    errors = [_error(sphere(), n, False, TotalCurvature(2 / 1.3**2))[0] for n in (8, 16)]
    assert np.log2(errors[0] / errors[1]) > 1.8


def _roof(n: int) -> CGCMesh:
    mesh = CGCMesh.from_meshgrid(dx=15, nx=n)
    mesh.set_supports("corners")
    mesh.set_creases([[(n + 1) * i + k for i in range(n + 1)] for k in (n // 3, 2 * n // 3)])
    mesh.set_target(0.005)
    mesh.set_target(0.0, region=2)
    mesh.set_law("H = 0.05", region=1)
    return mesh


def test_the_verdict_and_the_report_read_the_law():
    flat = _roof(9)
    judged = analyse(flat)
    assert "region 1 deviates from its law H = 0.05 by 100 % (median)" in str(judged.verdict)
    region = analyse(solve(flat)).regions[1]
    assert region.law == "H = 0.05" and region.target is None and region.max_error < 0.3 * 0.05


def test_laws_beside_each_other_make_a_fair_roof():
    result = solve(_roof(15))
    assert result.converged and result.verdict.fair, result.message
    assert "|H - 0.05|" in result.message and result.max_error < 1e-9
    finer = solve(_roof(30))
    assert float(result.vertices[:, 2].max()) == pytest.approx(float(finer.vertices[:, 2].max()), rel=5e-3)


def test_a_cushion_does_not_depend_on_units_place_and_side():
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    mesh.set_supports("boundary")
    mesh.set_law("H = 0.1")
    plain = solve(mesh).vertices[:, 2]
    assert plain.max() > 0
    big = mesh.copy()
    big.scale(1000)
    assert solve(big).vertices[:, 2] / 1000 == pytest.approx(plain, abs=1e-8)
    mesh.flip()
    assert solve(mesh).vertices[:, 2] == pytest.approx(-plain, abs=1e-8)


def test_a_law_given_to_solve_is_that_of_the_result():
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    mesh.set_supports("boundary")
    result = solve(mesh, laws="H = 0.1")
    assert str(result.mesh.region_law(0)) == str(result.problem.laws[0]) == "H = 0.1"
    assert mesh.region_law(0) is None
    with pytest.raises(ValueError, match="only the method 'bending' accepts laws"):
        solve(mesh, laws="H = 0.1", method="newton")
    with pytest.raises(ValueError, match="the measure 'exact' supports constant K only"):
        solve(mesh, laws="H = 0.1", settings={"measure": "exact"})


def test_a_slider_of_a_law_goes_on_from_the_surface_before():
    first = solve(_roof(9))
    on = solve(first.mesh, laws={1: "H = 0.055"})
    cold = solve(_roof(9), laws={1: "H = 0.055"})
    assert "starting from the previous surface" in on.message
    assert np.abs(on.vertices - cold.vertices).max() < 1e-6


def test_goals_that_moves_along_fixed_directions_cannot_meet_are_refused_with_a_remedy():
    mesh, mirror = CGCMesh.from_meshgrid(dx=10, nx=6), Mirror((5, 5, 0), (1, 0, 0))
    mesh.set_supports("corners")
    mesh.set_target(0.01)
    with pytest.raises(ProblemError, match="use the method projection, or auto"):
        polish(mesh.to_problem().with_goals([mirror]))
    mesh.set_law("H = 0.05")
    with pytest.raises(ProblemError, match="remove goals for edges in plan and mirrors"):
        solve(mesh, goals=[mirror])
