"""Goals with regions of different laws: unknown constants, their derivatives, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Height
from compas_cgc import LinearWeingarten
from compas_cgc import ProblemError
from compas_cgc import Rise
from compas_cgc import Volume
from compas_cgc import check
from compas_cgc import sensitivity
from compas_cgc import solve
from compas_cgc.model.law_errors import law_errors

N = 12


def _roof(law: object = "H = 0.05") -> CGCMesh:
    """Return a plan of three strips on its corners: K > 0, another law, and K = 0."""
    mesh = CGCMesh.from_meshgrid(dx=15, nx=N)
    mesh.set_supports("corners")
    mesh.set_creases([[(N + 1) * i + k for i in range(N + 1)] for k in (N // 3, 2 * N // 3)])
    mesh.set_target(0.005)
    mesh.set_target(0.0, region=2)
    mesh.set_law(law, region=1)
    return mesh


def _constant(result, region: int = 1) -> float:
    return result.problem.laws[region].constant


@pytest.fixture(scope="module")
def roof():
    return solve(_roof())


def _is_met(result) -> bool:
    # Residuals of the solver are relative to unit size.
    return result.converged and result.verdict.fair and result.max_error < 1e-9


@pytest.mark.parametrize("unknown", [[1], [0], [0, 1]])
def test_a_rise_is_met_by_unknown_constants(roof, unknown):
    rise = 1.1 * roof.vertices[:, 2].max()
    result = solve(_roof(), goals=[Rise(rise)], unknown=unknown)
    assert _is_met(result), result.message
    assert result.vertices[:, 2].max() == pytest.approx(rise, abs=1e-9)
    assert (_constant(result) > 0.051) == (1 in unknown)
    assert (result.problem.region_targets()[0] > 0.0051) == (0 in unknown)
    # The mesh of the result carries what was found, and leads to the same surface without goals.
    mesh = _roof(result.mesh.region_law(1))
    mesh.set_target(result.mesh.region_target(0), region=0)
    assert np.abs(solve(mesh).vertices - result.vertices).max() < 1e-6


def test_two_goals_are_met_by_two_laws(roof):
    rise = 1.05 * roof.vertices[:, 2].max()
    result = solve(_roof(), goals=[Rise(rise), Volume(390)], unknown=[0, 1])
    assert _is_met(result), result.message
    assert result.vertices[:, 2].max() == pytest.approx(rise, abs=1e-9)
    assert "K = " in result.ending and "H = " in result.ending


def test_the_height_of_a_vertex_is_met():
    vertex = (N + 1) * (N // 2) + N // 2
    result = solve(_roof(), goals=[Height([vertex], 3.0)], unknown=[1])
    assert _is_met(result), result.message
    assert result.vertices[vertex, 2] == pytest.approx(3.0, abs=1e-9)


def test_the_constant_of_a_linear_law_is_found(roof):
    rise = float(solve(_roof(LinearWeingarten(1.0, 3.0, 0.06))).vertices[:, 2].max())
    result = solve(_roof(LinearWeingarten(1.0, 3.0, 0.05)), goals=[Rise(rise)], unknown=[1])
    assert _is_met(result) and _constant(result) == pytest.approx(0.06, rel=1e-6)


def test_a_constant_keeps_its_sign_and_its_side():
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    mesh.set_supports("boundary")
    mesh.set_law("H = -0.05")
    result = solve(mesh, goals=[Rise(-0.8)], unknown="all")
    assert _is_met(result) and _constant(result, 0) < 0 and result.vertices[:, 2].min() == pytest.approx(-0.8, abs=1e-9)
    assert f"H = {_constant(result, 0):.6g} was found" in result.message
    (errors,) = law_errors(result.problem)
    assert np.median(errors.relative) < 1e-2  # H of the surface itself has this sign
    risen = solve(mesh, goals=[Rise(0.8)], unknown="all")
    assert risen.status == "infeasible" and "draw H with the other sign" in risen.message


def test_goals_with_known_laws_name_the_remedy():
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    mesh.set_supports("boundary")
    mesh.set_law("H = 0.05")
    with pytest.raises(ProblemError, match=r"unknown=\[region\]"):
        solve(mesh, goals=[Rise(0.8)])
    mesh.set_law("minimal")
    assert "must not be 0" in check(mesh.to_problem().with_goals([Rise(0.8), {"kind": "unknown", "regions": [0]}]))[0]


def test_derivatives_by_constants_are_exact(roof):
    found = sensitivity(roof)
    assert found.targets.tolist() == [0.005, 0.05, 0.0]
    assert "1 % more H in region 1 lifts the crown by" in str(found)
    for region, laws in ((0, ("K = 0.005001", "K = 0.004999")), (1, ("H = 0.050001", "H = 0.049999"))):
        ahead, behind = (solve(_roof(), laws={region: law}).vertices for law in laws)
        slope = (ahead - behind) / 2e-6
        assert np.abs(slope - found.moves[region]).max() < 1e-6 * np.abs(slope).max()
